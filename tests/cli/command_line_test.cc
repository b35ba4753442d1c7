// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/command_line.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/frame_list.h"
#include "cli/messages.h"
#include "pliant/scene/frame_report.h"

namespace pliant::cli {
enum class Fruit { kApple, kPear };
}
template <>
struct pliant::EnumNames<pliant::cli::Fruit> {
  static constexpr std::array kNames = {std::pair{pliant::cli::Fruit::kApple, std::string_view("apple")},
                                        std::pair{pliant::cli::Fruit::kPear, std::string_view("pear")}};
};

namespace pliant::cli {
namespace {

constexpr std::size_t kManualColumns = 100;

using testing::HasSubstr;
using testing::Not;

const Manual kManual = {"fill", "fill a basket", "First paragraph.\n\nSecond paragraph.", {"pliant fill --to X"}};

struct BasketOptions {
  int count = 3;
  double weight = 0.5;
  bool open = false;
  void List(OptionTable& table) {
    table.BeginGroup("Basket", "what is carried");
    table.Add("count", &count, "-", "how many pieces", 1, 9);
    table.Add("weight", &weight, "kg", "of all pieces", -10, 10);
    table.Add("open", &open, "-", "open at the top");
    table.Renamed("mass", "weight");
  }
};

// What a command line gives: the exit code (-1: the command is to run) and what was said.
struct Outcome {
  int exit = -1;
  std::string out;
  std::string err;
  std::string to = {};
  int pieces = 1;
  Fruit fruit = Fruit::kApple;
  bool ripe = false;
  BasketOptions options = {};
};

Outcome Give(const std::vector<std::string>& args) {
  Outcome outcome;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  CommandLine line(kManual);
  line.Add("to", &outcome.to, "PATH", "where it goes", Need::kRequired);
  line.Add("pieces", &outcome.pieces, "how many", 0, 100);
  line.AddChoice("fruit", &outcome.fruit, "kind");
  line.AddFlag("ripe", &outcome.ripe, "only ripe ones");
  line.AddAlias("kg", "Basket.weight", "KG", "a short name");
  std::optional<int> exit = line.Parse(args);
  OptionTable table;
  outcome.options.List(table);
  if (!exit) exit = line.Resolve(table);
  outcome.exit = exit.value_or(-1);
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

std::filesystem::path WriteTemporary(const std::string& name, const std::string& text) {
  std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path) << text;
  return path;
}

TEST(CommandLine, ArgumentsAndOptionsMayBeMixedInBothSpellings) {
  const Outcome outcome = Give({"--Basket.count", "5", "--to", "X", "--Basket.weight=-2.5", "--ripe", "--fruit=pear",
                                "--pieces", "7", "--Basket.open", "true"});
  EXPECT_EQ(outcome.exit, -1) << outcome.err;
  EXPECT_EQ(outcome.to, "X");
  EXPECT_EQ(outcome.pieces, 7);
  EXPECT_EQ(outcome.fruit, Fruit::kPear);
  EXPECT_TRUE(outcome.ripe);
  EXPECT_EQ(outcome.options.count, 5);
  EXPECT_EQ(outcome.options.weight, -2.5);
  EXPECT_TRUE(outcome.options.open);
}

TEST(CommandLine, ANegativeNumberIsAValueAndNoFlag) {
  EXPECT_EQ(Give({"--to", "X", "--Basket.weight", "-3"}).options.weight, -3);
  EXPECT_EQ(Give({"--to", "X", "--Basket.weight", "-1e-3"}).options.weight, -1e-3);
  EXPECT_THAT(Give({"--to", "X", "--pieces", "-3"}).err, HasSubstr("--pieces is '-3'; give a whole number from 0"));
}

TEST(CommandLine, TheFileComesFirstAndFlagsWinOverIt) {
  const auto path = WriteTemporary("basket.yaml", "Basket:\n  count: 7\n  weight: 1.5\n");
  const Outcome outcome = Give({"--Basket.count", "2", "--to", "X", "--config", path.string()});
  EXPECT_EQ(outcome.exit, -1) << outcome.err;
  EXPECT_EQ(outcome.options.count, 2);
  EXPECT_EQ(outcome.options.weight, 1.5);
}

TEST(CommandLine, AShortNameOfAnOptionWinsOverTheFileToo) {
  const std::string config = WriteTemporary("alias.yaml", "Basket:\n  weight: 4\n").string();
  const Outcome outcome = Give({"--to", "x", "--kg", "-2.5", "--config", config});
  EXPECT_EQ(outcome.exit, -1) << outcome.err;
  EXPECT_EQ(outcome.options.weight, -2.5);
  const Outcome wrong = Give({"--to", "x", "--kg", "much"});
  EXPECT_EQ(wrong.exit, kExitUsage);
  EXPECT_THAT(wrong.err, HasSubstr("Basket.weight is 'much'"));
}

TEST(CommandLine, WhatPrintConfigPrintsReadsBack) {
  const Outcome printed =
      Give({"--Basket.count", "8", "--Basket.weight", "0.1", "--Basket.open", "on", "--print_config"});
  EXPECT_EQ(printed.exit, kExitOk) << "a required argument is not needed to print";
  const auto path = WriteTemporary("printed.yaml", printed.out);
  const Outcome read = Give({"--to", "X", "--config", path.string(), "--print_config"});
  EXPECT_EQ(read.out, printed.out);
  EXPECT_EQ(read.options.count, 8);
  EXPECT_TRUE(read.options.open);
}

TEST(CommandLine, AnUnknownNameNamesItsNeighborAmongArgumentsAndOptions) {
  for (const auto& [flag, neighbor] : {std::pair{"--Basket.cuont", "--Basket.count"},
                                       {"--basket.weight", "--Basket.weight"},
                                       {"--peices", "--pieces"},
                                       {"--count", "--Basket.count"},
                                       {"--wei", "--Basket.weight"},
                                       {"--print-config", "--print_config"}}) {
    const Outcome outcome = Give({"--to", "X", flag, "1"});
    EXPECT_EQ(outcome.exit, kExitUsage) << flag;
    EXPECT_EQ(outcome.err,
              std::string("pliant fill: there is no option ") + flag + "; did you mean " + neighbor + "?\n");
  }
}

TEST(CommandLine, AnUnknownNameThatIsLikeNoneSaysWhereTheyAreListed) {
  const Outcome outcome = Give({"--to", "X", "--stereoscopic", "1"});
  EXPECT_EQ(outcome.exit, kExitUsage);
  EXPECT_EQ(outcome.err, "pliant fill: there is no option --stereoscopic; pliant fill --help-all lists them\n");
}

TEST(CommandLine, AnEarlierNameIsRefusedWithTheNameOfToday) {
  const auto file = WriteTemporary("earlier.yaml", "Basket:\n  mass: 7\n");
  const Outcome flag = Give({"--to", "X", "--Basket.mass", "1"});
  EXPECT_EQ(flag.exit, kExitUsage);
  EXPECT_EQ(flag.err, "pliant fill: Basket.mass is now called Basket.weight\n");
  const Outcome config = Give({"--to", "X", "--config", file.string()});
  EXPECT_EQ(config.exit, kExitUsage);
  EXPECT_THAT(config.err, HasSubstr("earlier.yaml:2: Basket.mass is now called Basket.weight\n"));
  EXPECT_THAT(Give({"--help"}).out, Not(HasSubstr("mass")));
  EXPECT_THAT(Give({"--print_config"}).out, Not(HasSubstr("mass")));
}

TEST(CommandLine, WrongUsesAreOneSentenceAndExitCodeTwo) {
  const auto unknown = WriteTemporary("unknown.yaml", "Basket:\n  cuont: 7\n");
  const auto garbled = WriteTemporary("garbled.yaml", "Basket: [1, 2\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "--to PATH is missing"},
      {{"--to"}, "--to"},
      {{"--to", ""}, "--to is ''"},
      {{"--to", "X", "--to", "Y"}, "--to"},
      {{"--to", "X", "stray"}, "'stray'"},
      {{"--to", "X", "--fruit", "plum"}, "--fruit is 'plum'; give one of apple|pear"},
      {{"--to", "X", "--pieces", "2.5"}, "--pieces is '2.5'"},
      {{"--to", "X", "--pieces", "101"}, "from 0 to 100"},
      {{"--to", "X", "--Basket.count", "10"}, "Basket.count is '10'; give a whole number from 1 to 9"},
      {{"--to", "X", "--Basket.weight", "nan"}, "Basket.weight"},
      {{"--to", "X", "--Basket.count"}, "--Basket.count needs a value"},
      {{"--to", "X", "--Basket.count", "--quiet"}, "--Basket.count needs a value"},
      {{"--to", "X", "--config", "/nowhere/options.yaml"}, "/nowhere/options.yaml"},
      {{"--to", "X", "--config", unknown.string()}, "Basket.count"},
      {{"--to", "X", "--config", garbled.string()}, "garbled.yaml"},
  };
  for (const auto& [args, sentence] : cases) {
    const Outcome outcome = Give(args);
    EXPECT_EQ(outcome.exit, kExitUsage) << sentence;
    EXPECT_THAT(outcome.err, HasSubstr(sentence));
    EXPECT_THAT(outcome.err, testing::StartsWith("pliant fill: "));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(CommandLine, HelpIsAManualOfEveryArgumentAndOption) {
  const Outcome outcome = Give({"--help"});
  EXPECT_EQ(outcome.exit, kExitOk);
  EXPECT_EQ(outcome.err, "");
  for (const char* part : {"pliant fill - fill a basket",
                           "USAGE",
                           "First paragraph.",
                           "Second paragraph.",
                           "--to PATH",
                           "(required)",
                           "--pieces N",
                           "(default: 1)",
                           "--fruit apple|pear",
                           "(default: apple)",
                           "--quiet",
                           "--config FILE",
                           "--print_config",
                           "--help",
                           "Basket: what is carried",
                           "--Basket.count 3  [-]",
                           "how many pieces",
                           "--Basket.weight 0.5  [kg]",
                           "EXIT CODES",
                           "pliant fill --to X"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), kManualColumns) << line;
}

TEST(CommandLine, TheValueOfAnOptionIsNoArgumentWithoutAName) {
  std::string path;
  BasketOptions options;
  OptionTable table;
  options.List(table);
  CommandLine line(kManual);
  line.Add("to", &path, "PATH", "where it goes", Need::kRequired, Positional::kYes);
  const std::vector<std::string> args = {"--Basket.count", "7", "here"};
  ASSERT_FALSE(line.Parse(args).has_value());
  ASSERT_FALSE(line.Resolve(table).has_value());
  EXPECT_EQ(path, "here");
  EXPECT_EQ(options.count, 7);
}

TEST(CommandLine, AMessageThatQuotesALongInputIsShortened) {
  const Outcome outcome = Give({"--to", "X", "--pieces", std::string(3000, 'x')});
  EXPECT_EQ(outcome.exit, kExitUsage);
  EXPECT_LE(outcome.err.size(), std::string("pliant fill: ").size() + 400 + 1);
  EXPECT_THAT(outcome.err, HasSubstr("--pieces is 'xxx"));
  EXPECT_THAT(outcome.err, HasSubstr(" ... "));
  EXPECT_THAT(outcome.err, HasSubstr("give a whole number from"));
}

TEST(CommandLine, AMessageThatIsTooLongIsCutBetweenWordsAndKeepsItsAdvice) {
  std::string words;
  for (int i = 0; i < 60; ++i) words += " because";
  std::string advice = "; calibrate";
  for (int i = 0; i < 20; ++i) advice += " the camera";
  testing::internal::CaptureStderr();
  SayError("there is no map" + words + advice);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_LE(said.size(), 401U);
  EXPECT_THAT(said, HasSubstr(" because ... calibrate the camera"));
  EXPECT_THAT(said, testing::EndsWith(advice.substr(2) + "\n"));

  testing::internal::CaptureStderr();
  SayError("there is no map" + words);  // one clause
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr(" because ... because "));
}

TEST(CommandLine, WhatToDoIsKeptOfALongReasonWhyThereIsNoMap) {
  const std::string advice = AdviceOnUncertainDepth(26.3, CameraOrigin::kAssumed) +
                             "; give more frames; --Init.method gated would have made a map by frame 10044, right only "
                             "if the camera moves and the scene hardly deforms";
  testing::internal::CaptureStderr();
  SayError(
      "the sequence ended without a first map: the depth of 71 of 254 points is known to 2.0 % of the median depth, at "
      "least 40 and 65 % must be; the median parallax is 26.3 deg; given up after 44 frames from one reference; " +
      advice);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_LE(said.size(), 401U);
  EXPECT_THAT(said, HasSubstr(": the sequence ended without a first map: "));
  EXPECT_THAT(said, testing::EndsWith(" ... " + advice + "\n"));
}

TEST(CommandLine, ControlCharactersOfFilesDoNotReachTheTerminal) {
  const std::string name =
      "a\x1b[2J\nb\r\tc\x7f\xc2\x9b"
      "3m \xc3\xa9 \xc2\xb5 \xc2";
  const std::string shown = "a?[2J?b??c??3m \xc3\xa9 \xc2\xb5 \xc2";
  EXPECT_EQ(Printable(name), shown);
  TheLogging() = {};
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  SayError(name);
  SayWarning(name);
  SayNote(name);
  SayResult("first\nsec\x1bond\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "note: " + shown + "\nfirst\nsec?ond\n");
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr(": " + shown + "\n"));
  EXPECT_THAT(said, HasSubstr(": warning: " + shown + "\n"));
}

TEST(CommandLine, AProgramThatDoesOneThingSpeaksUnderItsOwnName) {
  CommandLine line({.command = "", .summary = "peel", .text = "Peels.", .examples = {}, .program = "peeler"});
  const OptionTable none;
  EXPECT_THAT(line.ManualText(none, CommandLine::Detail::kAll),
              testing::StartsWith("peeler - peel\n\nUSAGE\n  peeler [ARGUMENTS]"));
  testing::internal::CaptureStderr();
  EXPECT_EQ(line.UsageError("no fruit"), kExitUsage);
  EXPECT_EQ(line.Failure("no knife"), kExitFailed);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "peeler: no fruit\npeeler: no knife\n");
}

TEST(FrameList, HasNumbersAndRanges) {
  using testing::ElementsAre;
  EXPECT_THAT(*ParseFrameList("--frames", "10,3,20-23"), ElementsAre(10, 3, 20, 21, 22, 23));
  EXPECT_TRUE(ParseFrameList("--frames", "")->empty());
  for (const std::string wrong : {"a", "1,,2", "-1", "1-2-3", "1.5", "1-", "0-99999999", "99999999-0"})
    EXPECT_EQ(
        ParseFrameList("--frames", wrong).status().message(),
        "--frames is '" + wrong + "'; give frame numbers with commas between them, or 10-20 for all from 10 to 20");
  EXPECT_EQ(ParseFrameList("--figure", "1,10-5").status().message(),
            "--figure is '1,10-5'; a range begins with the smaller number: give 5-10");
}

}  // namespace
}  // namespace pliant::cli
