// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The program's usage: its manual, its options, what a call may not say.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/program_outcome.h"
#include "pliant/evaluation/evaluation.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/options.h"
#include "pliant/viewer/figure.h"
#include "pliant/viewer/live_view.h"
#include "pliant/viewer/report.h"

namespace pliant {
namespace {

using namespace program_test;
using testing::HasSubstr;
using testing::Not;

// The fields of every command's options.
template <class Options>
std::vector<OptionField> FieldsOf() {
  static Options options;
  OptionTable table;
  options.List(table);
  return table.fields();
}

TEST(Program, WithoutACommandItShowsTheUsageAndExitsWithTwo) {
  const Outcome outcome = Pliant("");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_EQ(outcome.out, "");
  for (const char* command : {"track", "simulate", "evaluate", "truth", "demo"})
    EXPECT_THAT(outcome.err, HasSubstr(command));
}

TEST(Program, HelpAndVersionSucceed) {
  const Outcome help = Pliant("--help");
  EXPECT_EQ(help.exit, 0);
  EXPECT_THAT(help.out, HasSubstr("--help-all"));
  EXPECT_EQ(Pliant("--help-all").out, help.out);
  EXPECT_EQ(Pliant("dataset --help-all").out, Pliant("dataset --help").out);
  const Outcome version = Pliant("--version");
  EXPECT_EQ(version.exit, 0);
  EXPECT_THAT(version.out, testing::MatchesRegex("pliant [0-9]+\\.[0-9]+\\.[0-9]+( \\(commit "
                                                 "[0-9a-f]+(-dirty)?\\))?\nbuilt by .+\nwith .*Ceres 2\\.[0-9].*\n"));
}

TEST(Program, AnUnknownCommandNamesTheNearestOne) {
  const Outcome outcome = Pliant("trakc");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_EQ(outcome.err, "pliant: there is no command 'trakc'; did you mean 'track'? pliant --help lists them\n");
  EXPECT_EQ(Pliant("zzzzzzzz").err, "pliant: there is no command 'zzzzzzzz'; pliant --help lists them\n");
}

TEST(Program, HelpTakesCommandsOfTwoWords) {
  EXPECT_THAT(Pliant("help dataset info").out, HasSubstr("pliant dataset info - "));
  EXPECT_THAT(Pliant("help track").out, HasSubstr("pliant track - "));
}

TEST(Program, CalibrateRefusesWhatIsNoBoardAndImagesWithoutOne) {
  const std::string output = " -o '" + Temporary("camera.yaml").string() + "'";
  const Outcome no_board = Pliant("calibrate --image_path . --board 9x6" + output);
  EXPECT_EQ(no_board.exit, 2);
  EXPECT_THAT(no_board.err, HasSubstr("chessboard:9x6:2.0"));
  const Outcome ending = Pliant("calibrate --image_path . --board chessboard:9x6:2 --figure a.gif" + output);
  EXPECT_EQ(ending.exit, 2);
  EXPECT_EQ(ending.err, "pliant calibrate: --figure is 'a.gif'; a figure ends with .png or .svg or .pdf\n");
  const Outcome nothing = Pliant("calibrate --image_path none --board chessboard:9x6:2" + output);
  EXPECT_EQ(nothing.exit, 1);
  EXPECT_THAT(nothing.err, HasSubstr("there is nothing at 'none'"));
  EXPECT_FALSE(std::filesystem::exists(Temporary("camera.yaml")));
  std::ofstream(Temporary("camera.yaml")) << "before";
  const Outcome kept = Pliant("calibrate --image_path none --board chessboard:9x6:2" + output);
  EXPECT_EQ(kept.exit, 2);
  EXPECT_THAT(kept.err, HasSubstr("is there already; delete it, or give --overwrite"));
}

TEST(Program, TheShortManualHasTheMainOptionsAndSaysHowToSeeAll) {
  const std::vector<std::pair<std::string, std::vector<OptionField>>> commands = {
      {"track", FieldsOf<TrackOptions>()}, {"simulate", FieldsOf<SimulationOptions>()}};
  for (const auto& [command, fields] : commands) {
    const Outcome outcome = Pliant(command + " -h");
    EXPECT_EQ(outcome.exit, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("--help-all shows all"));
    const auto shown = std::count_if(fields.begin(), fields.end(), [&](const OptionField& field) {
      return outcome.out.find("    --" + field.name + " ") != std::string::npos;
    });
    EXPECT_GE(shown, 11) << command;
    EXPECT_LE(shown, 20) << command;
    EXPECT_EQ(Pliant("help " + command).out, outcome.out);
  }
}

TEST(Program, TheManualOfACommandNamesEveryOptionWithUnitAndReason) {
  const std::vector<std::pair<std::string, std::vector<OptionField>>> commands = {
      {"track", FieldsOf<TrackOptions>()},     {"simulate", FieldsOf<SimulationOptions>()},
      {"demo", FieldsOf<SimulationOptions>()}, {"evaluate", FieldsOf<EvaluationOptions>()},
      {"track", FieldsOf<LiveOptions>()},      {"report", FieldsOf<ReportOptions>()},
      {"report", FieldsOf<FigureOptions>()}};
  for (const auto& [command, fields] : commands) {
    const bool has_more = command == "track" || command == "simulate" || command == "demo";
    const Outcome outcome = Pliant(command + (has_more ? " --help-all" : " --help"));
    EXPECT_EQ(outcome.exit, 0) << command;
    ASSERT_FALSE(fields.empty());
    for (const OptionField& field : fields) {
      EXPECT_THAT(outcome.out, HasSubstr("--" + field.name + " "));
      EXPECT_THAT(outcome.out, HasSubstr("[" + field.unit + "]"));
    }
    for (const char* part : {"DESCRIPTION", "ARGUMENTS", "EXIT CODES", "EXAMPLES", "--config FILE"})
      EXPECT_THAT(outcome.out, HasSubstr(part)) << command;
  }
}

TEST(Program, WhatPrintConfigPrintsReadsBackAsTheConfig) {
  for (const std::string command :
       {"track", "track --preset paper", "simulate", "simulate --realism endoscope", "evaluate", "report"}) {
    const Outcome printed = Pliant(command + " --print_config");
    ASSERT_EQ(printed.exit, 0) << command << ": " << printed.err;
    const std::filesystem::path path = Temporary("config.yaml");
    std::ofstream(path) << printed.out;
    const std::string base = command.substr(0, command.find(' '));
    const Outcome read = Pliant(base + " --print_config --config '" + path.string() + "'");
    EXPECT_EQ(read.exit, 0) << command << ": " << read.err;
    EXPECT_EQ(read.out, printed.out) << command;
  }
}

TEST(Program, ThePaperPresetDiffersFromTheDefault) {
  EXPECT_NE(Pliant("track --print_config").out, Pliant("track --preset paper --print_config").out);
}

TEST(Program, AnOptionThatIsGivenWinsOverThePresetOfRealism) {
  const std::string clean = Pliant("simulate --print_config").out;
  EXPECT_EQ(Pliant("simulate --realism clean --print_config").out, clean);
  const Outcome preset = Pliant("simulate --realism endoscope --print_config");
  EXPECT_NE(preset.out, clean);
  EXPECT_THAT(preset.out, Not(HasSubstr("jpeg_quality: 33")));
  const Outcome given = Pliant("simulate --Recording.jpeg_quality 33 --realism endoscope --print_config");
  EXPECT_THAT(given.out, HasSubstr("jpeg_quality: 33"));
  const std::filesystem::path path = Temporary("clean.yaml");
  std::ofstream(path) << clean;
  EXPECT_EQ(Pliant("simulate --realism endoscope --print_config --config '" + path.string() + "'").out, clean);
}

TEST(Program, AnUnknownOptionNamesItsNeighborAndExitsWithTwo) {
  const Outcome group = Pliant("track --image_path a --output_path b --General.seeed 2");
  EXPECT_EQ(group.exit, 2);
  EXPECT_EQ(group.err, "pliant track: there is no option --General.seeed; did you mean --General.seed?\n");
  const Outcome own = Pliant("track --imagepath a --output_path b");
  EXPECT_EQ(own.exit, 2);
  EXPECT_EQ(own.err, "pliant track: there is no option --imagepath; did you mean --image_path?\n");
}

TEST(Program, AMissingArgumentExitsWithTwo) {
  for (const auto& [arguments, missing] : {std::pair{"refine --run a", "--output_path"},
                                           {"track --output_path b", "--image_path"},
                                           {"simulate", "--output_path"},
                                           {"evaluate --run a", "--sequence"}}) {
    const Outcome outcome = Pliant(arguments);
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_THAT(outcome.err, HasSubstr(std::string(missing) + " "));
    EXPECT_THAT(outcome.err, HasSubstr("is missing"));
  }
}

TEST(Program, TheVersionHasTheNamesThatItHasElsewhere) {
  const std::string version = Pliant("--version").out;
  for (const char* name : {"version", "-V", "-v"}) EXPECT_EQ(Pliant(name).out, version) << name;
}

TEST(Program, HelpIsOfOneCommand) {
  EXPECT_EQ(Pliant("help dataset info").out, Pliant("dataset info --help").out);
  const Outcome outcome = Pliant("help track extra");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("'extra' is more than its name"));
}

TEST(Program, AnEndBeforeTheStartExitsWithTwo) {
  const Outcome outcome = Pliant("track --image_path x --output_path y --start 10 --end 5");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--end is 5 and --start is 10"));
}

TEST(Program, AnArgumentWithoutItsValueOrGivenTwiceIsToldInWords) {
  const std::string base = "track --image_path a --output_path b ";
  for (const auto& [arguments, sentence] :
       {std::pair{"--start", "--start needs a value"},
        {"--start 1 --start 2", "--start is given more than once; leave one"},
        {"--General.seed 1 --General.seed 2", "--General.seed is given more than once; leave one"},
        {"--start 5 --end 3", "--end is 3 and --start is 5; --end is one past the last frame, or -1 for all"}}) {
    const Outcome outcome = Pliant(base + arguments);
    EXPECT_EQ(outcome.exit, 2) << arguments;
    EXPECT_EQ(outcome.err, "pliant track: " + std::string(sentence) + "\n");
  }
}

TEST(Program, AFullStandardOutputIsAFailure) {
  const int status = std::system("'" PLIANT_PROGRAM "' track --help >/dev/full 2>/dev/null");
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

// As of `pliant ... | head`, with SIGPIPE ignored as while a run is made.
TEST(Program, AClosedPipeEndsItWithoutAWord) {
  constexpr int kOutput = 9;  // shells duplicate descriptors of one digit
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(dup2(ends[1], kOutput), kOutput);
  for (const int end : ends) close(end);
  const auto former = std::signal(SIGPIPE, SIG_IGN);
  const std::string err = Temporary("err.txt").string();
  const int status = std::system(("'" PLIANT_PROGRAM "' track --help >&9 2>'" + err + "'").c_str());
  std::signal(SIGPIPE, former);
  close(kOutput);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(ReadText(err), "");
}

}  // namespace
}  // namespace pliant
