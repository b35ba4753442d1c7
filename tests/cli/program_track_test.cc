// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Commands that simulate and track.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/program_outcome.h"

namespace pliant {
namespace {

using namespace program_test;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Program, OptionsThatExcludeEachOtherAreWrongUsage) {
  const Outcome scaled = Pliant("track x -o y --Oracle.poses on --Image.working fixed --Image.scale 2");
  EXPECT_EQ(scaled.exit, 2);
  EXPECT_THAT(scaled.err, HasSubstr("leave Image.scale at 1"));
  const Outcome twice = Pliant("track x -o y --tracks tracks.csv --Oracle.tracks on");
  EXPECT_EQ(twice.exit, 2);
  EXPECT_THAT(twice.err, HasSubstr("both say where points are"));
}

TEST(Program, AStartFromACloudTakesItsMethodAndSaysWhenTheUnitIsUnlikely) {
  const Outcome usage = Pliant("track --image_path x --output_path y --Init.depth_cloud cloud.txt");
  EXPECT_EQ(usage.exit, 2);
  EXPECT_THAT(usage.err, HasSubstr("give Init.method depth as well"));
  const std::string sequence = Temporary("seq").string();
  const std::string cloud = Temporary("cloud.txt").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  std::ofstream points(cloud);
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 64; ++column)
      points << 1e-3 * (column - 32) << " " << 1e-3 * (row - 32) << " 0.05\n";  // meters
  points.close();
  const std::string track = "track --Init.method depth --image_path '" + sequence + "' --output_path '" +
                            Temporary("run").string() + "' --Init.depth_cloud '" + cloud + "' ";
  EXPECT_THAT(Pliant(track).err, HasSubstr("has a median depth of 0.05 mm; if its unit is the meter"));
  const Outcome in_meters = Pliant(track + "--overwrite --Init.depth_cloud_unit_mm 1000");
  EXPECT_EQ(in_meters.exit, 0) << in_meters.err;
  EXPECT_THAT(in_meters.out, HasSubstr("2 of 2 frames tracked"));
  EXPECT_THAT(in_meters.err, Not(HasSubstr("median depth")));
  const Outcome in_nothing = Pliant(track + "--overwrite --Init.depth_cloud_unit_mm 1e-9");
  EXPECT_EQ(in_nothing.exit, 1);
  EXPECT_THAT(in_nothing.err, HasSubstr("the files of a run hold 0.001 mm and more"));
}

TEST(Program, AStartFromADepthPriorTakesItsFolder) {
  const Outcome usage = Pliant("track --image_path x --output_path y --Init.method depth_prior");
  EXPECT_EQ(usage.exit, 2);
  EXPECT_THAT(usage.err, HasSubstr("name their folder with --depth_prior"));
  const std::string sequence = Temporary("seq_of_prior").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 3 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  const std::string run = Temporary("run_from_prior").string();
  const std::string track =
      "track --image_path '" + sequence + "' --output_path '" + run + "' --Init.method depth_prior --depth_prior ";
  const Outcome none = Pliant(track + "'" + sequence + "/none'");
  EXPECT_EQ(none.exit, 1);
  EXPECT_THAT(none.err, HasSubstr("there is no folder"));
  const Outcome from_prior = Pliant(track + "'" + sequence + "/depth' --DepthPrior.kind depth");
  EXPECT_EQ(from_prior.exit, 0) << from_prior.err;
  EXPECT_THAT(from_prior.out, HasSubstr("3 of 3 frames tracked"));
  EXPECT_THAT(from_prior.out, HasSubstr("nothing confirmed them"));
  std::ifstream summary(run + "/run.json");
  const std::string text((std::istreambuf_iterator<char>(summary)), {});
  EXPECT_THAT(text, HasSubstr("\"depth_prior\": \"" + sequence + "/depth\""));
  EXPECT_THAT(text, HasSubstr("\"metric\": false"));
  const std::string doubt = "is it of the other DepthPrior.kind?";
  EXPECT_THAT(from_prior.err + from_prior.out, Not(HasSubstr(doubt)));
  const Outcome of_other_kind = Pliant(track + "'" + sequence + "/depth' --overwrite");
  EXPECT_EQ(of_other_kind.exit, 0) << of_other_kind.err;
  EXPECT_THAT(of_other_kind.err, HasSubstr("where by brightness it should grow in 2 of 2 frames: " + doubt));
}

TEST(Program, TracksOfOtherImagesAreOneSentenceAndExitCodeOne) {
  const std::string sequence = Temporary("seq_of_tracks").string();
  const std::string tracks = Temporary("tracks.csv").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  const std::string of = " --tracks '" + tracks + "' ";
  const std::string track =
      "track --image_path '" + sequence + "' --output_path '" + Temporary("run").string() + "'" + of;
  const std::string evaluate = "evaluate --sequence '" + sequence + "'" + of;
  for (const char* rows : {"0,0,700,20\n", "0,0,10,nan\n", "2,0,10,20\n", "0,0,10\n"}) {
    std::ofstream(tracks) << "frame,track_id,u_px,v_px\n" << rows;
    for (const std::string& command : {track, evaluate}) {
      const Outcome outcome = Pliant(command);
      EXPECT_EQ(outcome.exit, 1) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(tracks));
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    }
  }
  std::ofstream(tracks) << "frame,track_id,u_px,v_px\n0,0,100.5,100\n1,0,100.5,100\n";
  const Outcome scored = Pliant(evaluate + "--tracks_pixel_origin corner");
  EXPECT_EQ(scored.exit, 0) << scored.err;
  EXPECT_THAT(scored.out, HasSubstr("tracks against the truth"));
  EXPECT_EQ(Pliant("evaluate --sequence x --run y" + of).exit, 2);
  EXPECT_EQ(Pliant("evaluate" + of).exit, 2);
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

TEST(Program, WhatIsThereIsReplacedOnRequestOnly) {
  const std::string sequence = Temporary("seq").string();
  const std::string simulate = "simulate --quiet --Trajectory.frames 2" + kCoarse + "--output_path '" + sequence + "'";
  ASSERT_EQ(Pliant(simulate).exit, 0);
  const Outcome again = Pliant(simulate);
  EXPECT_EQ(again.exit, 2);
  EXPECT_EQ(again.err, "pliant simulate: '" + sequence +
                           "' holds a sequence already; give another --output_path, or --overwrite to replace it\n");
  EXPECT_EQ(Pliant(simulate + " --overwrite").exit, 0);

  const std::string run = Temporary("run").string();
  const std::string import = "import --quiet --format tum --input_path '" + sequence +
                             "/groundtruth.txt' --sequence '" + sequence + "' --output_path '" + run + "'";
  ASSERT_EQ(Pliant(import).exit, 0);
  const std::string before = ReadText(run + "/run.json");
  for (const std::string& command : {import, "track --quiet --image_path '" + sequence + "' -o '" + run + "'",
                                     "refine --quiet --run x -o '" + run + "'"}) {
    const Outcome outcome = Pliant(command);
    EXPECT_EQ(outcome.exit, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr("holds a run already"));
  }
  EXPECT_EQ(ReadText(run + "/run.json"), before);
  EXPECT_EQ(Pliant(import + " --overwrite").exit, 0);

  const std::string bundle = Temporary("bundle").string();
  const std::string report = "report --quiet '" + run + "' --bundle -o '" + bundle + "'";
  ASSERT_EQ(Pliant(report).exit, 0);
  const std::string version = Pliant("--version").out;
  EXPECT_THAT(ReadText(bundle + "/versions.txt"), StartsWith(version.substr(0, version.find('\n') + 1)));
  const Outcome refused = Pliant(report);
  EXPECT_EQ(refused.exit, 2);
  EXPECT_THAT(refused.err, HasSubstr("'" + bundle + "' holds a bundle already"));
  EXPECT_EQ(Pliant(report + " --overwrite").exit, 0);

  const std::string exported = "export --quiet '" + run + "' --format ply -o '" + Temporary("ply").string() + "'";
  ASSERT_EQ(Pliant(exported).exit, 0);
  EXPECT_EQ(Pliant(exported).exit, 2);
}

TEST(Program, WhatIsMadeOfARunInSecondsIsReplaced) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2" + kCoarse + "-o '" + sequence + "'").exit, 0);
  const std::string run = ForeignResult("run", 2);
  for (const std::string& command :
       {"report '" + run + "' --sequence '" + sequence + "' -o '" + Temporary("report.html").string() + "'",
        "evaluate '" + run + "' --sequence '" + sequence + "' -o '" + Temporary("evaluation").string() + "'"})
    for (int time = 0; time < 2; ++time) EXPECT_EQ(Pliant(command).exit, 0) << command;
}

TEST(Program, ARefinedOrJoinedRunNeedsAFolderOfItsOwn) {
  const std::string run = ForeignResult("run", 3);
  const std::string other = ForeignResult("other", 3);
  std::ofstream(run + "/run.json") << "{}";
  for (const std::string& command : {"refine '" + run + "'", "join '" + other + "' '" + run + "'"})
    for (const std::string ending : {"' --overwrite", "'", "/sub'"}) {
      const Outcome outcome = Pliant(command + " -o '" + run + ending);
      EXPECT_EQ(outcome.exit, 2) << command << ending;
      EXPECT_THAT(outcome.err, HasSubstr("the run '" + run + "'; give another --output_path\n"));
      EXPECT_THAT(outcome.err, Not(HasSubstr("--overwrite")));
    }
}

TEST(Program, ResumeNeedsARunAndAFinishedOneHasNothingToDo) {
  EXPECT_THAT(Pliant("track x --resume").err, HasSubstr("name it with --output_path"));
  const Outcome both = Pliant("track x --output_path y --resume --overwrite");
  EXPECT_EQ(both.exit, 2);
  EXPECT_THAT(both.err, HasSubstr("--resume goes on with a run and --overwrite begins a new one"));
  const std::string recorded = Temporary("live").string();
  std::filesystem::create_directories(recorded + "_recording/images/000000.png");
  const Outcome live = Pliant("track - --live --output_path '" + recorded + "' --resume");
  EXPECT_EQ(live.exit, 2);
  EXPECT_THAT(live.err, HasSubstr("such a run cannot be resumed; track its recording"));
  EXPECT_THAT(live.err + live.out, Not(HasSubstr("live view"))) << "nothing is opened before";
  const std::string sequence = Temporary("seq_to_resume").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 3 --Camera.width 320 --Camera.height 240 --output_path '" +
                   sequence + "'")
                .exit,
            0);
  const std::string track = "track --Init.method depth --image_path '" + sequence + "' --output_path '" +
                            Temporary("run_to_resume").string() + "' --resume";
  EXPECT_THAT(Pliant(track).out, HasSubstr("3 of 3 frames tracked"));
  const Outcome again = Pliant(track);
  EXPECT_EQ(again.exit, 0);
  EXPECT_THAT(again.out, HasSubstr("3 of 3 frames tracked"));
  EXPECT_THAT(again.err, Not(HasSubstr("tracking (first map"))) << "no frame is read";
}

TEST(Program, StandardInputThatIsClosedOrEmptyIsSaid) {
  for (const char* nothing : {" <&-", " </dev/null"}) {
    const Outcome outcome = Pliant("track - -o '" + Temporary("run").string() + "'" + nothing);
    EXPECT_EQ(outcome.exit, 1) << nothing;
    EXPECT_THAT(outcome.err, HasSubstr("standard input is closed or empty")) << nothing;
    EXPECT_FALSE(std::filesystem::exists(Temporary("run"))) << nothing;
  }
}

TEST(Program, AnUnknownCameraIsAssumedAndTheRunSaysSo) {
  const std::string sequence = Temporary("seq").string();
  const std::string run = Temporary("run").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2" + kCoarse + "-o '" + sequence + "'").exit, 0);
  std::filesystem::remove(sequence + "/camera.yaml");
  const std::string track = "track '" + sequence + "/images' -o '" + run + "'";
  EXPECT_THAT(Pliant(track).err, HasSubstr("pliant calibrate"));
  const Outcome outcome = Pliant(track + " --camera unknown --fov_deg 60");
  EXPECT_THAT(outcome.err, HasSubstr("the camera is not calibrated (fov:60 degrees are assumed)"));
  EXPECT_THAT(ReadText(run + "/run.json"), HasSubstr("\"camera\": \"fov:60\""));
  const Outcome wide = Pliant(track + " --camera unknown --fov_deg 170");
  EXPECT_EQ(wide.exit, 2);
  EXPECT_THAT(wide.err, HasSubstr("a whole number from 10 to 150"));
}

TEST(Program, ARunWithoutANameHasTheImagesNameAndTheDate) {
  const std::string sequence = Temporary("clip").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2" + kCoarse + "-o '" + sequence + "'").exit, 0);
  const std::filesystem::path working = Temporary("working");
  std::filesystem::create_directories(working);
  Pliant("track --quiet '" + sequence + "/'", "cd '" + working.string() + "'");
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(working)) names.push_back(entry.path().filename());
  ASSERT_EQ(names.size(), 1u);
  EXPECT_THAT(names.front(), testing::MatchesRegex("clip_[0-9]+_[0-9]+"));
  EXPECT_TRUE(std::filesystem::exists(working / names.front() / "run.json"));
}

TEST(Program, QuietSaysNothingAndProgressGoesToStandardError) {
  const std::string small = "--Trajectory.frames 2" + kCoarse;
  const std::string output = "--output_path '" + Temporary("seq").string() + "'";
  const Outcome loud = Pliant("simulate " + small + output);
  ASSERT_EQ(loud.exit, 0) << loud.err;
  EXPECT_THAT(loud.err, HasSubstr("simulate  2/2"));
  EXPECT_THAT(loud.out, StartsWith("2 frames in "));
  const Outcome quiet = Pliant("simulate --quiet --overwrite " + small + output);
  EXPECT_EQ(quiet.exit, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST(Program, WithoutStandardStreamsNoMessageGetsIntoTheFiles) {
  const std::string sequence = Temporary("seq").string();
  const std::string run = Temporary("run").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 2" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  std::system(
      ("'" PLIANT_PROGRAM "' track --image_path '" + sequence + "' --output_path '" + run + "' <&- >&- 2>&-").c_str());
  EXPECT_EQ(ReadText(run + "/observations.csv"), "frame,point_id,u_px,v_px,x,y,z,ssim,sigma_mm\n");
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
  EXPECT_THAT(Pliant(track + "--end 1").err, StartsWith("pliant track: one frame is not enough for a map; "));
  const Outcome threads = Pliant(track + "--General.threads 64");
  EXPECT_THAT(threads.err, StartsWith("pliant track: "));
  EXPECT_EQ(std::count(threads.err.begin(), threads.err.end(), '\n'), 1) << threads.err;
}

TEST(Program, ADeviceIsNoCalibration) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 1" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const Outcome outcome = Pliant("track --image_path '" + sequence + "' --camera /dev/zero --output_path '" +
                                 Temporary("run").string() + "'");
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_EQ(outcome.err, "pliant track: '/dev/zero' is a pipe or a device; give a file\n");
}

TEST(Program, DatasetStatisticsPrintsWhatASequenceIsLikeForATracker) {
  const std::string sequence = Temporary("seq").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 10" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const Outcome outcome = Pliant("dataset statistics '" + sequence + "' --Image.working fixed --Image.scale 2");
  EXPECT_EQ(outcome.exit, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("image     128x96, scale 2, smoothing 0 px\nframes    10\nnoise     "));
  EXPECT_THAT(outcome.out, HasSubstr(" after 9\ntracks    "));
  const Outcome too_short = Pliant("dataset statistics '" + sequence + "' --end 9");
  EXPECT_EQ(too_short.exit, 1);
  EXPECT_THAT(too_short.err, HasSubstr("the sequence has 9 frames; statistics need 10 that follow each other"));
}

TEST(Program, TrackLiveSaysWhereToLookAndEndsWithTheRun) {
  const std::string sequence = Temporary("sequence").string();
  ASSERT_EQ(Pliant("simulate --quiet --Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'").exit, 0);
  const std::string run = " --output_path '" + Temporary("run").string() + "' --live --Live.port 0";
  EXPECT_THAT(Pliant("track --image_path '" + sequence + "'" + run).out, HasSubstr("live view: http://127.0.0.1:"));
}

TEST(Program, ASurfaceIsReplacedOnRequestOnly) {
  const std::filesystem::path surface = Temporary("surface");
  std::filesystem::create_directories(surface);
  std::ofstream(surface / "surface.json") << "{}";
  const std::string command = "surface --run nothing -o '" + surface.string() + "'";
  const Outcome refused = Pliant(command);
  EXPECT_EQ(refused.exit, 2);
  EXPECT_THAT(refused.err, HasSubstr("holds a surface already; give another --output_path, or --overwrite"));
  EXPECT_EQ(Pliant(command + " --overwrite").exit, 1) << "there is no run";
}

// Every line that a command says is an object, whatever it is about.
TEST(Program, JsonLinesAreReadByPrograms) {
  const std::string sequence = Temporary("sequence").string();
  const std::string json = " --log_format json ";
  const Outcome simulated =
      Pliant("simulate" + json + "--Trajectory.frames 4" + kCoarse + "--output_path '" + sequence + "'");
  ASSERT_EQ(simulated.exit, 0) << simulated.err;
  std::set<std::string> events;
  std::istringstream lines(simulated.out + simulated.err + Pliant("track" + json + "--image_path /nowhere").err +
                           Pliant("track --fruit" + json).err);
  for (std::string line; std::getline(lines, line);) {
    const auto event = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(event.is_object()) << line;
    EXPECT_THAT(event["command"].get<std::string>(), testing::StartsWith("pliant ")) << line;
    events.insert(event["event"].get<std::string>());
    if (event["event"] == "progress") {
      EXPECT_EQ(event["done"], event["total"]) << line;
    }
  }
  EXPECT_THAT(events, testing::UnorderedElementsAre("error", "note", "progress", "result"));
}

TEST(Program, TheLogLevelLeavesOutWhatIsLess) {
  const std::string sequence = Temporary("sequence").string();
  const std::string simulate = "simulate --Trajectory.frames 2" + kCoarse + "--output_path '" + sequence + "'";
  const Outcome info = Pliant(simulate);
  EXPECT_THAT(info.out, HasSubstr("2 frames in "));
  const Outcome warning = Pliant(simulate + " --overwrite --log_level warning");
  EXPECT_EQ(warning.exit, 0);
  EXPECT_EQ(warning.out + warning.err, "");
  EXPECT_THAT(Pliant(simulate + " --log_level loud").err,
              HasSubstr("--log_level is 'loud'; give one of error|warning|info"));
}

}  // namespace
}  // namespace pliant
