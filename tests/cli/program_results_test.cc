// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Commands that evaluate, compare, convert and show what there is.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program_outcome.h"

namespace pliant {
namespace {

using namespace program_test;
using testing::HasSubstr;
using testing::StartsWith;

// As on a full disk: a file can have 2 kB, no more.
TEST(Program, WhatDoesNotFitIsOneSentenceAndNoFile) {
  const std::string limit = "ulimit -f 4";
  const std::string sequence = Temporary("seq").string();
  const std::string simulate = "simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '";
  ASSERT_EQ(Pliant(simulate + sequence + "'").exit, 0);
  const std::string run = ForeignResult("run", 4);
  for (const std::string ending : {"pdf", "svg", "png"}) {
    const std::string path = Temporary("figure." + ending).string();
    const Outcome figure =
        Pliant("report --run '" + run + "' --sequence '" + sequence + "' --figure 1,2 -o '" + path + "'", limit);
    EXPECT_EQ(figure.exit, 1) << ending << figure.err;
    EXPECT_THAT(figure.err, HasSubstr(path));
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  const Outcome simulated = Pliant(simulate + Temporary("other").string() + "'", limit);
  EXPECT_EQ(simulated.exit, 1);
  EXPECT_EQ(std::ranges::count(simulated.err, '\n'), 1) << simulated.err;
}

TEST(Program, CompareSetsRunsOfOtherSystemsSideBySide) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string a = ForeignResult("a", 4);
  const std::string b = ForeignResult("b", 3);
  const std::string out = Temporary("out").string();
  const std::string figure = Temporary("figure.pdf").string();
  const Outcome both = Pliant("compare --run '" + a + "' --run '" + b + "' --sequence '" + sequence +
                              "' --protocol all --output_path '" + out + "' --figure '" + figure + "'");
  ASSERT_EQ(both.exit, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr(a));
  EXPECT_THAT(both.out, HasSubstr("3/3"));
  EXPECT_THAT(both.out, HasSubstr("lmeds, RMSE mm (null)"));
  EXPECT_THAT(ReadText(out + "/comparison.csv"), HasSubstr("surface_lmeds_mean_rmse_mm"));
  EXPECT_THAT(ReadText(out + "/comparison.json"), HasSubstr("\"material\": {"));
  EXPECT_THAT(ReadText(out + "/1/evaluation.csv"), StartsWith("frame,tracked,points,"));
  EXPECT_THAT(ReadText(figure), StartsWith("%PDF"));

  // What a command is about needs no name, however many there are.
  const Outcome unnamed = Pliant("compare '" + a + "' '" + b + "' --sequence '" + sequence + "' --protocol all");
  EXPECT_EQ(unnamed.exit, 0) << unnamed.err;
  EXPECT_EQ(unnamed.out, both.out.substr(0, unnamed.out.size()));
  EXPECT_EQ(Pliant("evaluate '" + a + "' --sequence '" + sequence + "' --parts material").out,
            Pliant("evaluate --run '" + a + "' --sequence '" + sequence + "' --parts material").out);
  EXPECT_THAT(Pliant("evaluate '" + a + "' '" + b + "' --sequence '" + sequence + "'").err,
              HasSubstr("does not know what to do with '" + b + "'"));

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

  const Outcome ending = Pliant("compare --run a --run b --sequence c --figure d.gif");
  EXPECT_EQ(ending.exit, 2);
  EXPECT_EQ(ending.err, "pliant compare: --figure is 'd.gif'; a figure ends with .png or .svg or .pdf\n");

  const Outcome pairs = Pliant("compare --run a --run b --run c --sequence d --sequence e");
  EXPECT_EQ(pairs.exit, 2);
  EXPECT_EQ(pairs.err,
            "pliant compare: the number of sequences is 2 for 3 runs; give one for all of them, or one for each\n");
}

TEST(Program, EvaluateScoresPointsAsTheStirChallengeDoes) {
  const std::string start = Temporary("start.json").string();
  const std::string tracked = Temporary("tracked.json").string();
  std::ofstream(start) << R"({"0/left/seq00": [[10, 20], [30, 40]]})";
  std::ofstream(tracked) << R"({"0/left/seq00": [[15, 20], [30, 46]]})";
  const std::string out = Temporary("out").string();
  const std::string files = " --stir_start '" + start + "' --stir_end '" + start + "'";
  const Outcome scored = Pliant("evaluate --stir '" + tracked + "'" + files + " --output_path '" + out + "'");
  ASSERT_EQ(scored.exit, 0) << scored.err;
  EXPECT_THAT(scored.out, HasSubstr("estimate       0.0   100.0   100.0   100.0   100.0    80.0            5.50"));
  EXPECT_THAT(ReadText(out + "/stir.json"), HasSubstr("\"average_within\": 0.8"));

  EXPECT_EQ(Pliant("evaluate --stir '" + tracked + "'").err,
            "pliant evaluate: --stir, --stir_start and --stir_end belong together; give all three\n");
  const Outcome both = Pliant("evaluate --run run --stir '" + tracked + "'" + files);
  EXPECT_EQ(both.exit, 2);
  EXPECT_THAT(both.err, HasSubstr("leave --run, --tracks and --sequence out"));
  const Outcome none = Pliant("evaluate --stir '" + tracked + "x'" + files);
  EXPECT_EQ(none.exit, 1);
  EXPECT_THAT(none.err, HasSubstr("tracked.jsonx"));
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

  // A sequence is not written into a run.
  for (const char* command : {"simulate --Trajectory.frames 4 --overwrite", "demo"}) {
    const Outcome mixed = Pliant(command + (" --output_path '" + out + "'"));
    EXPECT_EQ(mixed.exit, 2);
    EXPECT_THAT(mixed.err, HasSubstr("holds a run; give another --output_path"));
  }
  const Outcome left_out =
      Pliant("evaluate --parts surface --tracks '" + sequence + "/times.txt' --sequence '" + sequence + "'");
  EXPECT_EQ(left_out.exit, 1);

  const Outcome none = Pliant(import + "--overwrite --input_path '" + sequence + "/nowhere'");
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

TEST(Program, EvaluateComparesRunsWithoutASequenceAndWithPointsOfStructureFromMotion) {
  const std::string sequence = Temporary("seq").string();
  const std::string run = Temporary("run").string();
  const std::string later = Temporary("later").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  const std::string track = "track --quiet --Init.method depth --image_path '" + sequence + "' --output_path '";
  ASSERT_EQ(Pliant(track + run + "'").exit, 0);
  ASSERT_EQ(Pliant(track + later + "' --start 1").exit, 0);
  const std::string evaluate = "evaluate --run '" + run + "' ";
  const Outcome alone = Pliant(evaluate + "--other_run '" + later + "'");
  EXPECT_EQ(alone.exit, 0) << alone.err;
  EXPECT_THAT(alone.out, HasSubstr("against another run"));
  EXPECT_THAT(alone.out, HasSubstr(" points in 3 frames, one scale a frame"));

  std::ofstream(sequence + "/sfm_points.csv") << "frame,u_px,v_px,depth\n0,10,10,3\n";
  const Outcome too_few = Pliant(evaluate + "--sequence '" + sequence + "'");
  EXPECT_EQ(too_few.exit, 0) << too_few.err;
  EXPECT_THAT(too_few.out, HasSubstr("note: of the 1 tracked frames with points of structure from motion none"));
  const Outcome given = Pliant(evaluate + "--sfm_path '" + sequence + "/sfm_points.csv'");
  EXPECT_EQ(given.exit, 1);
  EXPECT_THAT(given.err, StartsWith("pliant evaluate: of the 1 tracked frames"));
  EXPECT_THAT(Pliant(evaluate + "--sfm_path '" + sequence + "'").err, HasSubstr("give --sequence"));
  EXPECT_THAT(Pliant(evaluate + "--other_run '" + ForeignResult("a", 4) + "'").err, HasSubstr("is another system's"));
}

TEST(Program, DatasetInfoAndTrackSayThatImagesAreRepeated) {
  const std::string sequence = Temporary("seq").string();
  const std::string twice = Temporary("twice").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 8" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  std::filesystem::create_directories(twice + "/images");
  std::filesystem::copy_file(sequence + "/camera.yaml", twice + "/camera.yaml");
  for (int k = 0; k < 16; ++k) {
    const std::string image = "/images/0000" + std::to_string(10 + k) + ".png";
    std::filesystem::copy_file(sequence + "/images/00000" + std::to_string(k / 2) + ".png", twice + image);
  }
  const Outcome info = Pliant("dataset info '" + twice + "'");
  EXPECT_EQ(info.exit, 1);
  EXPECT_THAT(info.out, HasSubstr("wrong     8 of 16 images (50 %) repeat the one before"));
  EXPECT_THAT(info.out, HasSubstr("give --stride 2"));
  const Outcome strided = Pliant("dataset info '" + twice + "' --stride 2");
  EXPECT_EQ(strided.exit, 0) << strided.out;
  EXPECT_THAT(strided.out, HasSubstr("nothing is wrong with the images"));
  const std::string track = "track --image_path '" + twice + "' --output_path '" + Temporary("run").string() + "'";
  EXPECT_THAT(Pliant(track).err, HasSubstr("pliant track: warning: 8 of 16 images"));
  EXPECT_THAT(Pliant(track + " --quiet").err, Not(HasSubstr("warning")));
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
  // Its model has the camera as well.
  std::filesystem::remove(camera);
  const std::string again = "report --run '" + run + "' --figure 2 -o '" + Temporary("figure.png").string() + "'";
  const Outcome by_model = Pliant(again);
  EXPECT_EQ(by_model.exit, 0) << by_model.err;
  EXPECT_THAT(by_model.out, Not(HasSubstr("note:")));
  std::filesystem::rename(sequence, sequence + "_moved");
  EXPECT_THAT(Pliant(again + " --sequence '" + sequence + "_moved'").out, Not(HasSubstr("note:")));
  std::filesystem::remove_all(run + "/sparse");
  EXPECT_THAT(Pliant(again).out, HasSubstr("note: the images cannot be shown"));
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
  EXPECT_EQ(Pliant("model check --input_path '" + binary + "'").out, good.out);
  const Outcome beside =
      Pliant("model convert --format text --input_path '" + folder.string() + "' --output_path '" + binary + "'");
  EXPECT_EQ(beside.exit, 1);
  EXPECT_THAT(beside.err, HasSubstr("cameras.bin"));

  const std::string text = Temporary("text").string();
  const std::string to_text = "model convert --format text --input_path '" + folder.string() + "' --output_path '";
  EXPECT_EQ(Pliant(to_text + text + "'").err, "");

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
  const Outcome former = Pliant("model check --path '" + folder.string() + "'");
  EXPECT_EQ(former.exit, 2);
  EXPECT_EQ(former.err, "pliant model check: --path is now called --input_path\n");
  EXPECT_EQ(Pliant("dataset info --path x").err, "pliant dataset info: --path is now called --image_path\n");
}

TEST(Program, ModelConvertSaysWhichNamesColmapDoesNotReadFromText) {
  const std::filesystem::path folder = Temporary("model");
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "cameras.txt") << "1 SIMPLE_PINHOLE 640 480 500 320 240\n";
  std::ofstream(folder / "images.txt") << "1 1 0 0 0 0 0 0 1 left eye 1.png\n320 240 -1\n";
  std::ofstream(folder / "points3D.txt") << "# none\n";
  const auto convert = [&](const std::string& format) {
    return Pliant("model convert --format " + format + " --input_path '" + folder.string() + "' --output_path '" +
                  Temporary(format).string() + "'");
  };
  const Outcome text = convert("text");
  EXPECT_EQ(text.exit, 0);
  EXPECT_THAT(text.err, HasSubstr("will not find 'left eye 1.png'; use --format binary"));
  EXPECT_EQ(convert("binary").err, "");
}

TEST(Program, ModelConvertStopsOnASignalAndLeavesNothing) {
  const std::filesystem::path model = Temporary("model");
  const std::filesystem::path out = Temporary("out");
  std::filesystem::create_directories(model);
  std::filesystem::create_directories(out);
  std::ofstream(model / "cameras.txt") << "1 PINHOLE 64 48 50 50 32 24\n";
  std::ofstream(model / "images.txt") << "1 1 0 0 0 0 0 0 1 a.png\n\n";
  std::ofstream(model / "points3D.txt") << "";
  // The output cameras.bin is a pipe, at which the program waits for a reader; 0x4000 is SIGTERM among those caught.
  std::ofstream(Temporary("stop.sh")) << R"sh(cd "$(dirname "$0")"
mkfifo out/cameras.bin
"$1" model convert --input_path model --output_path out 2>err.txt & pid=$!
for try in {1..500}; do
  [ $(( 0x$(sed -n "s/^SigCgt:.*\(........\)$/\1/p" /proc/$pid/status) & 0x4000 )) != 0 ] && break; sleep 0.01
done
kill -TERM $pid; cat out/cameras.bin >read; wait $pid
)sh";
  const int status = std::system(("bash '" + Temporary("stop.sh").string() + "' '" PLIANT_PROGRAM "'").c_str());
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 1);
  EXPECT_THAT(ReadText(Temporary("err.txt")), HasSubstr("stopped on request; nothing was written"));
  std::filesystem::remove(out / "cameras.bin");
  EXPECT_TRUE(std::filesystem::is_empty(out));
}

// A figure that takes seconds; 0x4000 is SIGTERM among the signals that are caught.
TEST(Program, AFigureStopsOnASignalAndLeavesTheOldOne) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 5" + kCoarse + "-o '" + sequence + "'").exit, 0);
  ASSERT_EQ(Pliant("import --quiet --format tum --input_path '" + sequence + "/groundtruth.txt' --sequence '" +
                   sequence + "' -o '" + Temporary("run").string() + "'")
                .exit,
            0);
  std::ofstream(Temporary("figure.png")) << "the old one";
  std::ofstream(Temporary("stop.sh")) << R"sh(cd "$(dirname "$0")"
"$1" report run --figure 0-4 --Figure.panel_width_px 1500 -o figure.png 2>err.txt & pid=$!
for try in {1..500}; do
  [ $(( 0x$(sed -n "s/^SigCgt:.*\(........\)$/\1/p" /proc/$pid/status) & 0x4000 )) != 0 ] && break; sleep 0.01
done
kill -TERM $pid; wait $pid
)sh";
  const int status = std::system(("bash '" + Temporary("stop.sh").string() + "' '" PLIANT_PROGRAM "'").c_str());
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 1);
  EXPECT_EQ(ReadText(Temporary("err.txt")), "pliant report: stopped on request; nothing was written\n");
  EXPECT_EQ(ReadText(Temporary("figure.png")), "the old one");
}

TEST(Program, ReportSaysWhatItCannotWrite) {
  const auto error = [](const std::string& arguments, int exit) {
    const Outcome outcome = Pliant("report --run run " + arguments);
    EXPECT_EQ(outcome.exit, exit) << arguments;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(error("-o report.png", 2), HasSubstr("a report ends with .html or .htm"));
  EXPECT_THAT(error("--figure 3 -o figure.html", 2),
              HasSubstr("--output_path is 'figure.html'; a figure ends with .png or .svg or .pdf"));
  EXPECT_THAT(error("--video -o film.avi", 2), HasSubstr("a film ends with .mp4"));
  EXPECT_THAT(error("--video --figure 3 -o film.mp4", 2), HasSubstr("give one of them"));
  EXPECT_THAT(error("--figure 3,x -o figure.png", 2), HasSubstr("give frame numbers"));
  EXPECT_THAT(error("", 2), HasSubstr("--output_path FILE is missing"));
  EXPECT_THAT(error("-o '" + Temporary("report.html").string() + "'", 1), HasSubstr("there is no run folder"));
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
