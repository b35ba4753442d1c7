// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The program itself, started as a user starts it.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "pliant/evaluation/evaluation.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/options.h"
#include "pliant/viewer/figure.h"
#include "pliant/viewer/live_view.h"
#include "pliant/viewer/report.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Outcome {
  int exit = -1;
  std::string out;
  std::string err;
};

std::filesystem::path Temporary(const std::string& name) {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "pliant_program_test" / test->name();
  static std::string started;  // the test whose folder was emptied, of what an earlier run left
  if (started != test->name()) std::filesystem::remove_all(folder);
  started = test->name();
  std::filesystem::create_directories(folder);
  return folder / name;
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A coarse scene, in view for a short way only, so that it is made fast.
const std::string kCoarse =
    " --Scene.view_mm 80 --Scene.mesh_step_mm 2 --Texture.smallest_mm 2 --Texture.texel_mm 0.8 --Camera.width 64"
    " --Camera.height 48 --Sensor.samples 1 ";

// Runs `pliant arguments` through the shell, with standard error in a file (so no terminal).
Outcome Pliant(const std::string& arguments) {
  const std::filesystem::path out = Temporary("out.txt");
  const std::filesystem::path err = Temporary("err.txt");
  const std::string command = "'" PLIANT_PROGRAM "' " + arguments + " >'" + out.string() + "' 2>'" + err.string() + "'";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadText(out), ReadText(err)};
}

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
  EXPECT_EQ(Pliant("--help").exit, 0);
  const Outcome version = Pliant("--version");
  EXPECT_EQ(version.exit, 0);
  EXPECT_THAT(version.out, testing::MatchesRegex("pliant [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(Program, AnUnknownCommandNamesTheNearestOne) {
  const Outcome outcome = Pliant("trakc");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_EQ(outcome.err, "pliant: there is no command 'trakc'; did you mean 'track'? pliant --help lists them\n");
}

TEST(Program, TheManualOfACommandNamesEveryOptionWithUnitAndReason) {
  const std::vector<std::pair<std::string, std::vector<OptionField>>> commands = {
      {"track", FieldsOf<TrackOptions>()},     {"simulate", FieldsOf<SimulationOptions>()},
      {"demo", FieldsOf<SimulationOptions>()}, {"evaluate", FieldsOf<EvaluationOptions>()},
      {"track", FieldsOf<LiveOptions>()},      {"report", FieldsOf<ReportOptions>()},
      {"report", FieldsOf<FigureOptions>()}};
  for (const auto& [command, fields] : commands) {
    const Outcome outcome = Pliant(command + " --help");
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
  for (const std::string command : {"track", "track --preset paper", "simulate", "evaluate", "report"}) {
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

TEST(Program, AnUnknownOptionNamesItsNeighborAndExitsWithTwo) {
  const Outcome group = Pliant("track --image_path a --output_path b --General.seeed 2");
  EXPECT_EQ(group.exit, 2);
  EXPECT_EQ(group.err, "pliant track: there is no option --General.seeed; did you mean --General.seed?\n");
  const Outcome own = Pliant("track --imagepath a --output_path b");
  EXPECT_EQ(own.exit, 2);
  EXPECT_EQ(own.err, "pliant track: there is no option --imagepath; did you mean --image_path?\n");
}

TEST(Program, AMissingArgumentExitsWithTwo) {
  for (const auto& [arguments, missing] : {std::pair{"track --image_path a", "--output_path"},
                                           {"track --output_path b", "--image_path"},
                                           {"simulate", "--output_path"},
                                           {"evaluate --run a", "--sequence"}}) {
    const Outcome outcome = Pliant(arguments);
    EXPECT_EQ(outcome.exit, 2);
    EXPECT_THAT(outcome.err, HasSubstr(std::string(missing) + " "));
    EXPECT_THAT(outcome.err, HasSubstr("is missing"));
  }
}

TEST(Program, AnEndBeforeTheStartExitsWithTwo) {
  const Outcome outcome = Pliant("track --image_path x --output_path y --start 10 --end 5");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--end is 5 and --start is 10"));
}

TEST(Program, AStartFromACloudTakesItsMethodAndSaysWhenTheUnitIsUnlikely) {
  const Outcome usage = Pliant("track --image_path x --output_path y --Init.depth_cloud cloud.txt");
  EXPECT_EQ(usage.exit, 2);
  EXPECT_THAT(usage.err, HasSubstr("give --Init.method depth as well"));
  const std::string sequence = Temporary("seq").string();
  const std::string cloud = Temporary("cloud.txt").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  std::ofstream points(cloud);
  for (int i = 0; i < 4096; ++i) points << 1e-3 * (i % 64 - 32) << " " << 1e-3 * (i / 64 - 32) << " 0.05\n";  // meters
  points.close();
  const std::string track = "track --Init.method depth --image_path '" + sequence + "' --output_path '" +
                            Temporary("run").string() + "' --Init.depth_cloud '" + cloud + "' ";
  EXPECT_THAT(Pliant(track).err, HasSubstr("has a median depth of 0.05 mm; if its unit is the meter"));
  const Outcome in_meters = Pliant(track + "--Init.depth_cloud_unit_mm 1000");
  EXPECT_EQ(in_meters.exit, 0) << in_meters.err;
  EXPECT_THAT(in_meters.out, HasSubstr("2 of 2 frames tracked"));
  EXPECT_THAT(in_meters.err, Not(HasSubstr("median depth")));
}

TEST(Program, AnInputThatIsNotThereIsOneSentenceAndExitCodeOne) {
  const std::string nowhere = Temporary("nowhere").string();
  for (const std::string& arguments :
       {"track --image_path '" + nowhere + "' --output_path '" + Temporary("run").string() + "'",
        "evaluate --run '" + nowhere + "' --sequence '" + nowhere + "'"}) {
    const Outcome outcome = Pliant(arguments);
    EXPECT_EQ(outcome.exit, 1);
    EXPECT_THAT(outcome.err, HasSubstr(nowhere));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(Program, AnOutputThatCannotBeMadeIsExitCodeOne) {
  const std::filesystem::path file = Temporary("file");
  std::ofstream(file) << "in the way";
  const Outcome outcome =
      Pliant("simulate --Trajectory.frames 1" + kCoarse + "--output_path '" + (file / "seq").string() + "'");
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, HasSubstr(file.string()));
}

TEST(Program, QuietSaysNothingAndProgressGoesToStandardError) {
  const std::string small = "--Trajectory.frames 2" + kCoarse;
  const std::string output = "--output_path '" + Temporary("seq").string() + "'";
  const Outcome loud = Pliant("simulate " + small + output);
  ASSERT_EQ(loud.exit, 0) << loud.err;
  EXPECT_THAT(loud.err, HasSubstr("simulate  2/2"));
  EXPECT_THAT(loud.out, StartsWith("2 frames in "));
  const Outcome quiet = Pliant("simulate --quiet " + small + output);
  EXPECT_EQ(quiet.exit, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
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

TEST(Program, WithoutStandardStreamsNoMessageGetsIntoTheFiles) {
  const std::string sequence = Temporary("seq").string();
  const std::string run = Temporary("run").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  std::system(
      ("'" PLIANT_PROGRAM "' track --image_path '" + sequence + "' --output_path '" + run + "' <&- >&- 2>&-").c_str());
  EXPECT_EQ(ReadText(run + "/observations.csv"), "frame,point_id,u_px,v_px,x,y,z,ssim\n");
  EXPECT_EQ(ReadText(run + "/trajectory.txt"), "");
}

TEST(Program, ADamagedVideoIsOneSentenceWithoutTheDecoders) {
  const std::filesystem::path video = Temporary("video.mp4");
  std::ofstream(video, std::ios::binary) << std::string("\0\0\0\x18", 4) << "ftypisom" << std::string(500, 'x');
  const std::filesystem::path camera = Temporary("camera.yaml");
  std::ofstream(camera) << "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 31.5, 23.5]\n";
  const Outcome outcome =
      Pliant("track --image_path '" + video.string() + "' --output_path '" + Temporary("run").string() + "'");
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, StartsWith("pliant track: cannot open "));
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

TEST(Program, OneFrameAndManyThreadsAreOneSentenceEach) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string track =
      "track --quiet --image_path '" + sequence + "' --output_path '" + Temporary("run").string() + "' ";
  EXPECT_THAT(Pliant(track + "--end 1").err, StartsWith("pliant track: one frame carries no map; "));
  const Outcome threads = Pliant(track + "--General.threads 64");
  EXPECT_THAT(threads.err, StartsWith("pliant track: "));
  EXPECT_EQ(std::count(threads.err.begin(), threads.err.end(), '\n'), 1) << threads.err;
}

// A result as another system would leave it, of a camera that moves along x, with one point.
std::string ForeignResult(const std::string& name, int frames) {
  const std::filesystem::path folder = Temporary(name);
  std::filesystem::create_directories(folder);
  std::ofstream trajectory(folder / "trajectory.txt");
  std::ofstream observations(folder / "observations.csv");
  observations << "frame,point_id,u_px,v_px,x,y,z\n";
  for (int i = 0; i < frames; ++i) {
    trajectory << i / 30.0 << " " << i << " 0 0 0 0 0 1\n";
    observations << i << ",1,30,20,0,0,40\n";
  }
  return folder.string();
}

TEST(Program, CompareSetsRunsOfOtherSystemsSideBySide) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string a = ForeignResult("a", 4);
  const std::string b = ForeignResult("b", 3);
  const std::string out = Temporary("out").string();
  const Outcome both = Pliant("compare --run '" + a + "' --run '" + b + "' --sequence '" + sequence +
                              "' --protocol all --output_path '" + out + "'");
  ASSERT_EQ(both.exit, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr(a));
  EXPECT_THAT(both.out, HasSubstr("3/3"));
  EXPECT_THAT(both.out, HasSubstr("lmeds, RMSE mm (null)"));
  EXPECT_THAT(ReadText(out + "/comparison.csv"), HasSubstr("surface_lmeds_mean_rmse_mm"));
  EXPECT_THAT(ReadText(out + "/comparison.json"), HasSubstr("\"material\": {"));
  EXPECT_THAT(ReadText(out + "/1/evaluation.csv"), StartsWith("frame,tracked,points,"));

  const Outcome one = Pliant("evaluate --run '" + a + "' --sequence '" + sequence + "' --parts material");
  EXPECT_EQ(one.exit, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("drift, px"));
  EXPECT_THAT(one.out, testing::Not(HasSubstr("surface error")));

  // One that is not there does not keep the other from its row.
  const Outcome half = Pliant("compare --run '" + a + "' --run '" + b + "x' --sequence '" + sequence + "'");
  EXPECT_EQ(half.exit, 1);
  EXPECT_THAT(half.err, HasSubstr(b + "x"));
  EXPECT_EQ(std::count(half.err.begin(), half.err.end(), '\n'), 1) << half.err;
  EXPECT_THAT(half.out, HasSubstr("4/4"));

  const Outcome pairs = Pliant("compare --run a --run b --run c --sequence d --sequence e");
  EXPECT_EQ(pairs.exit, 2);
  EXPECT_EQ(pairs.err,
            "pliant compare: --sequence is given 2 times for 3 runs; give one for all of them, or one for each\n");
}

TEST(Program, ImportMakesARunOfACameraPathAndSaysWhatItCannotRead) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string out = Temporary("out").string();
  const std::string import = "import --sequence '" + sequence + "' --output_path '" + out + "' ";
  const Outcome tum = Pliant(import + "--format tum --input_path '" + sequence + "/groundtruth.txt'");
  ASSERT_EQ(tum.exit, 0) << tum.err;
  EXPECT_THAT(tum.out, HasSubstr("4 of 4 frames, 0 points"));
  EXPECT_THAT(ReadText(out + "/run.json"), HasSubstr("\"import\""));
  const Outcome path = Pliant("evaluate --parts camera --run '" + out + "' --sequence '" + sequence + "'");
  EXPECT_EQ(path.exit, 0) << path.err;
  EXPECT_THAT(path.out, HasSubstr("ATE RMSE 0.000"));

  const Outcome none = Pliant(import + "--input_path '" + sequence + "/nowhere'");
  EXPECT_EQ(none.exit, 1);
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
  EXPECT_THAT(none.err, StartsWith("pliant import: "));
  EXPECT_EQ(Pliant(import + "--format ply --input_path x").exit, 2);
  EXPECT_EQ(Pliant("import --sequence x --output_path y").exit, 2);
}

TEST(Program, EvaluateSaysInOneSentenceThatThereIsNoTruthForWhatWasAsked) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string evaluate = "evaluate --run '" + ForeignResult("a", 4) + "' --sequence '" + sequence + "' ";
  std::filesystem::remove(sequence + "/simulation.yaml");
  const Outcome material = Pliant(evaluate + "--parts material");
  EXPECT_EQ(material.exit, 1);
  EXPECT_THAT(material.err, StartsWith("pliant evaluate: no material error: "));
  EXPECT_THAT(material.err, HasSubstr("simulation.yaml"));
  EXPECT_EQ(Pliant(evaluate).exit, 0);
  std::filesystem::remove_all(sequence + "/depth");
  const Outcome surface = Pliant(evaluate + "--parts surface");
  EXPECT_EQ(surface.exit, 1);
  EXPECT_EQ(surface.err,
            "pliant evaluate: no surface error: the sequence has no true surface for the tracked frames\n");
  const Outcome protocol = Pliant(evaluate + "--protocol depth_trimmed");
  EXPECT_EQ(protocol.exit, 1);
  EXPECT_THAT(protocol.err, StartsWith("pliant evaluate: the protocol depth_trimmed compares points"));
  std::filesystem::remove(sequence + "/groundtruth.txt");
  const Outcome bare = Pliant(evaluate);
  EXPECT_EQ(bare.exit, 0) << bare.err;
  EXPECT_THAT(bare.out, HasSubstr("tracks\n  frames tracked 4 of 4"));
}

TEST(Program, ARunIsEvaluatedAndShownWithTheCalibrationItWasMadeWith) {
  const std::string sequence = Temporary("seq").string();
  const std::string run = Temporary("run").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  const std::string camera = Temporary("lens.yaml").string();
  std::filesystem::rename(sequence + "/camera.yaml", camera);
  ASSERT_EQ(Pliant("track --quiet --Init.method depth --image_path '" + sequence + "' --camera '" + camera +
                   "' --output_path '" + run + "'")
                .exit,
            0);
  EXPECT_EQ(Pliant("evaluate --run '" + run + "' --sequence '" + sequence + "'").exit, 0);
  const Outcome compared =
      Pliant("compare --run '" + run + "' --run '" + ForeignResult("a", 4) + "' --sequence '" + sequence + "'");
  EXPECT_EQ(compared.exit, 0) << compared.err;
  const Outcome figure = Pliant("report --run '" + run + "' --figure 2 -o '" + Temporary("figure.png").string() + "'");
  EXPECT_EQ(figure.exit, 0) << figure.err;
  EXPECT_THAT(figure.out, Not(HasSubstr("note:")));
  std::filesystem::remove(camera);
  const Outcome without = Pliant("report --run '" + run + "' --figure 2 -o '" + Temporary("figure.png").string() + "'");
  EXPECT_EQ(without.exit, 0) << without.err;
  EXPECT_THAT(without.out, HasSubstr("note: the images cannot be shown"));
}

TEST(Program, ADeviceIsNoCalibration) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 1" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const Outcome outcome = Pliant("track --image_path '" + sequence + "' --camera /dev/zero --output_path '" +
                                 Temporary("run").string() + "'");
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_EQ(outcome.err, "pliant track: '/dev/zero' is a pipe or a device; give a file\n");
}

TEST(Program, TruthFollowsMaterialThroughASequence) {
  const std::string sequence = Temporary("seq").string();
  const std::string paths = Temporary("paths.csv").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 3 --Deformation.amplitude_mm 2" + kCoarse + "--output_path '" +
                   sequence + "'")
                .exit,
            0);
  const std::string truth = "truth --sequence '" + sequence + "' --output_path '" + paths + "' ";
  const Outcome grid = Pliant(truth + "--grid_px 16 --frame 1");
  EXPECT_EQ(grid.exit, 0) << grid.err;
  EXPECT_THAT(grid.out, StartsWith("12 of 12 points in 3 frames"));
  std::ifstream file(paths);
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "point,frame,u_px,v_px,x,y,z,depth_mm,visibility");
  int rows = 0;
  for (; std::getline(file, line); ++rows) {
    // The first point, in the frame that it was taken from.
    if (rows == 1) {
      EXPECT_THAT(line, testing::EndsWith(",visible"));
    }
  }
  EXPECT_EQ(rows, 36);

  const std::string points = Temporary("points.csv").string();
  std::ofstream(points) << "frame,u_px,v_px\n0,10,10\n3,10,10\n";
  const Outcome late = Pliant(truth + "--points '" + points + "'");
  EXPECT_EQ(late.exit, 2);
  EXPECT_EQ(late.err, "pliant truth: point 2 is in frame 3, and the sequence has the frames 0 to 2\n");
  EXPECT_THAT(Pliant(truth).err, HasSubstr("give either --points FILE or --grid_px N"));
  EXPECT_THAT(Pliant(truth + "--grid_px 8 --points '" + points + "'").err, HasSubstr("give either"));
}

TEST(Program, ModelCheckSaysWhatIsWrongAndExitsWithOne) {
  const std::filesystem::path folder = Temporary("model");
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "cameras.txt") << "1 PINHOLE 64 48 50 50 32 24\n";
  std::ofstream(folder / "images.txt") << "1 1 0 0 0 0 0 0 1 a.png\n10 20 7\n2 1 0 0 0 0 0 0 1 b.png\n30 20 7\n";
  std::ofstream(folder / "points3D.txt") << "7 0 0 5 1 2 3 0.5 1 0 2 0\n";
  const Outcome good = Pliant("model check '" + folder.string() + "'");
  EXPECT_EQ(good.exit, 0) << good.err;
  EXPECT_EQ(good.out, "1 cameras, 2 images, 1 points, 2 observations\nnothing is wrong\n");

  const std::string binary = Temporary("binary").string();
  EXPECT_EQ(Pliant("model convert --input_path '" + folder.string() + "' --output_path '" + binary + "'").exit, 0);
  EXPECT_EQ(Pliant("model check --path '" + binary + "'").out, good.out);
  const Outcome beside =
      Pliant("model convert --format text --input_path '" + folder.string() + "' --output_path '" + binary + "'");
  EXPECT_EQ(beside.exit, 1);
  EXPECT_THAT(beside.err, HasSubstr("cameras.bin"));

  std::ofstream(folder / "points3D.txt") << "7 0 0 5 1 2 3 0.5 1 0 3 0\n";
  const Outcome bad = Pliant("model check '" + folder.string() + "'");
  EXPECT_EQ(bad.exit, 1);
  EXPECT_THAT(
      bad.out,
      HasSubstr("error: tracks have an image that is not there: 1, the first: point 7, keypoint 0 of image 3\n"));
  EXPECT_THAT(bad.out, HasSubstr("error: keypoints have a point whose track does not have them: 1"));

  EXPECT_EQ(Pliant("model check").exit, 2);
  EXPECT_EQ(Pliant("model").exit, 2);
  EXPECT_EQ(Pliant("model check /nowhere").exit, 1);
}

TEST(Program, ReportSaysWhatItCannotWrite) {
  const auto error = [](const std::string& arguments, int exit) {
    const Outcome outcome = Pliant("report --run run " + arguments);
    EXPECT_EQ(outcome.exit, exit) << arguments;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(error("-o report.png", 2), HasSubstr("a report ends with .html or .htm"));
  EXPECT_THAT(error("--figure 3 -o figure.html", 2), HasSubstr("a figure ends with .png or .svg or .pdf"));
  EXPECT_THAT(error("--video -o film.avi", 2), HasSubstr("a film ends with .mp4"));
  EXPECT_THAT(error("--video --figure 3 -o film.mp4", 2), HasSubstr("give one of them"));
  EXPECT_THAT(error("--figure 3,x -o figure.png", 2), HasSubstr("give frame numbers"));
  EXPECT_THAT(error("", 2), HasSubstr("--output_path FILE is missing"));
  EXPECT_THAT(error("-o '" + Temporary("report.html").string() + "'", 1), HasSubstr("there is no run folder"));
}

TEST(Program, TrackLiveSaysWhereToLookAndEndsWithTheRun) {
  const std::string sequence = Temporary("sequence").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string run = " --output_path '" + Temporary("run").string() + "' --live --Live.port 0";
  EXPECT_THAT(Pliant("track --image_path '" + sequence + "'" + run).err, HasSubstr("live view: http://127.0.0.1:"));
}

TEST(Program, ExportSaysInOneSentenceWhatIsMissing) {
  const Outcome nothing =
      Pliant("export --run /nowhere --format tum --output_path '" + Temporary("out").string() + "'");
  EXPECT_EQ(nothing.exit, 1);
  EXPECT_EQ(nothing.err, "pliant export: there is no run folder '/nowhere'; check the path\n");
  const Outcome format = Pliant("export --run a --format collada --output_path b");
  EXPECT_EQ(format.exit, 2);
  EXPECT_THAT(format.err, HasSubstr("canonical|spacetime|frames"));
}

}  // namespace
}  // namespace pliant
