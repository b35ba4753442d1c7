// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/bundle.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pliant/base/files.h"
#include "pliant/base/version.h"
#include "support/test_folder.h"
#include "viewer/small_sequence.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

TEST(WithoutPaths, LeavesOutFoldersAndNamesAndNothingElse) {
  EXPECT_EQ(WithoutPaths("cannot read '/home/smith/case 7.mp4'"), "cannot read '<path>.mp4'");
  EXPECT_EQ(WithoutPaths("cannot read images/smith_12.png; give another"), "cannot read <path>.png; give another");
  EXPECT_EQ(WithoutPaths("--camera=/data/smith/camera.yaml"), "--camera=<path>.yaml");
  EXPECT_EQ(WithoutPaths("/a/b and (/c/d.png)"), "<path> and (<path>.png)");
  for (const char* kept : {"30 frames/s, 1/32 of the width", "a / b", "no path", ""})
    EXPECT_EQ(WithoutPaths(kept), kept);
}

TEST(WithoutPaths, LeavesOutWhatIsTooLongToBeRead) {
  EXPECT_EQ(WithoutPaths("a\n# " + std::string(1000000, '/') + "\nb /home/smith\n"), "a\n<long line>\nb <path>\n");
  EXPECT_EQ(WithoutPaths(std::string(1000000, 'x')), "<long line>");
}

// The run of small_run.h, whose images are those of small_sequence.h.
class BundleTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(run_);
    WriteSmallSequence(sequence_, Truth::kNone);
    RunSummary summary;
    summary.description.program_version = "0.0.7";
    summary.description.input = sequence_;
    summary.description.camera = sequence_ + "/camera.yaml";
    summary.description.command_line = {"pliant",
                                        "track",
                                        "smith/seq",
                                        "-o",
                                        "run of smith",
                                        "--Corners.quality=0.01",
                                        "--Init.method",
                                        "window",
                                        "--config=smith",
                                        "--mask_path=smith.png",
                                        "--config",
                                        "smith",
                                        "--camera",
                                        "of smith/camera",
                                        "http://cam/v.cgi?user=a&pwd=smith",
                                        "--image_path=rtsp://a:pa.smith@cam"};
    summary.description.joined_from = {""};
    summary.note = "image " + sequence_ +
                   "/images/5.png cannot be read; stopped after frame smith_12.PNG; "
                   "so were smith/seq/images/7 of smith.png and 7 of smith.png";
    fs::create_directories(sequence_);
    std::ofstream(sequence_ + "/7 of smith.png") << "no image";
    ASSERT_TRUE(WriteRunSummary(run_ + "/run.json", summary).ok());
    std::ofstream(run_ + "/config.yaml")
        << "TrackFile:\n  path: /data/smith/tracks.npz  # [path] tracks\n  other: 5  # [-] -\n"
           "Init:\n  depth_cloud: smith.ply  # [FILE] cloud\n";
    std::ofstream(run_ + "/frames.csv") << "frame,state\n0,tracking\n";
  }

  std::string TextsOf(const BundleSummary& bundle) const {
    std::string texts;
    for (const std::string& name : bundle.files) texts += *ReadFile(bundle_ + "/" + name);
    return texts;
  }

  TestFolder folder_;
  std::string run_ = folder_.Path("smith/run of smith");
  std::string sequence_ = folder_.Path("smith/seq");
  std::string bundle_ = folder_.Path("smith/bundle");
};

TEST_F(BundleTest, HoldsWhatExplainsTheRunAndNothingPrivate) {
  const auto bundle = WriteBundle({.run_path = run_, .output_path = bundle_});
  ASSERT_TRUE(bundle.ok()) << bundle.status().message();
  EXPECT_THAT(bundle->files, testing::UnorderedElementsAre("versions.txt", "run.json", "config.yaml", "frames.csv",
                                                           "camera.yaml", "README.txt"));
  EXPECT_THAT(bundle->notes, testing::ElementsAre("the run has no trajectory.txt"));
  const std::string texts = TextsOf(*bundle);
  EXPECT_THAT(texts, Not(HasSubstr("smith")));
  EXPECT_THAT(texts, HasSubstr("image <path>.png cannot be read"));
  EXPECT_THAT(texts, HasSubstr("Corners.quality=0.01"));
  EXPECT_THAT(texts, HasSubstr("--Init.method"));
  EXPECT_THAT(texts, HasSubstr("other: 5"));
  EXPECT_THAT(texts, HasSubstr("0.0.7"));
  EXPECT_THAT(texts, HasSubstr(kVersion));
  EXPECT_THAT(texts, HasSubstr("Ceres "));
  EXPECT_THAT(*ReadFile(bundle_ + "/frames.csv"), HasSubstr("0,tracking"));
  EXPECT_FALSE(fs::exists(bundle_ + "/images"));
  EXPECT_FALSE(fs::exists(bundle_ + "/.unfinished"));
}

TEST_F(BundleTest, BeginsItsVersionsAsTheProgramSaysItsOwn) {
  ASSERT_TRUE(WriteBundle({.run_path = run_, .output_path = bundle_, .program_version = "1.2 (commit 1a2b)"}).ok());
  EXPECT_THAT(*ReadFile(bundle_ + "/versions.txt"), testing::StartsWith("pliant 1.2 (commit 1a2b)\nbuilt by "));
}

TEST_F(BundleTest, ReplacesABundleOnRequestAndNothingElse) {
  BundleRequest request{.run_path = run_, .output_path = bundle_, .images = BundledImages::kSome};
  ASSERT_TRUE(WriteBundle(request).ok());
  std::ofstream(bundle_ + "/notes.txt") << "mine";
  request.images = BundledImages::kNone;
  const Status kept = WriteBundle(request).status();
  EXPECT_EQ(kept.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(kept.message(),
            "'" + bundle_ + "' holds a bundle already; give another --output_path, or --overwrite to replace it");
  request.replaces_bundle = true;
  ASSERT_TRUE(WriteBundle(request).ok());
  EXPECT_FALSE(fs::exists(bundle_ + "/images")) << "of the former one";
  EXPECT_EQ(*ReadFile(bundle_ + "/notes.txt"), "mine");
  request.output_path = run_;
  EXPECT_EQ(WriteBundle(request).status().code(), ErrorCode::kInvalidArgument) << "a run is no bundle";
  EXPECT_THAT(*ReadFile(run_ + "/run.json"), HasSubstr("smith"));
}

TEST_F(BundleTest, OfATextWithoutAnEndIsSmall) {
  auto summary = *ReadRunSummary(run_ + "/run.json");
  summary.note = std::string(300000, 'a') + "/b.png";
  summary.description.command_line.push_back(summary.note);
  ASSERT_TRUE(WriteRunSummary(run_ + "/run.json", summary).ok());
  const auto bundle = WriteBundle({.run_path = run_, .output_path = bundle_});
  ASSERT_TRUE(bundle.ok()) << bundle.status().message();
  EXPECT_LT(bundle->megabytes, 0.1);
}

TEST_F(BundleTest, HoldsTenImagesWhereTheyAreAskedFor) {
  const auto bundle = WriteBundle({.run_path = run_, .output_path = bundle_, .images = BundledImages::kSome});
  ASSERT_TRUE(bundle.ok()) << bundle.status().message();
  int images = 0;
  for (const auto& entry : fs::directory_iterator(bundle_ + "/images")) {
    EXPECT_FALSE(cv::imread(entry.path().string()).empty()) << entry.path();
    ++images;
  }
  EXPECT_EQ(images, kMaxBundledImages);
  EXPECT_TRUE(fs::exists(bundle_ + "/images/0.jpg"));
  EXPECT_TRUE(fs::exists(bundle_ + "/images/18.jpg"));
}

TEST_F(BundleTest, StaysSmallWhateverTheRun) {
  std::ofstream frames(run_ + "/frames.csv");
  frames << "frame,state\n";
  for (int i = 0; i < 1000000; ++i) frames << i << ",tracking\n";
  frames.close();
  const auto bundle = WriteBundle({.run_path = run_, .output_path = bundle_, .images = BundledImages::kSome});
  ASSERT_TRUE(bundle.ok()) << bundle.status().message();
  EXPECT_LT(bundle->megabytes, kMaxBundleMegabytes);
  EXPECT_GT(bundle->megabytes, 1);
  EXPECT_THAT(bundle->notes, testing::Contains(HasSubstr("of frames.csv the bundle has one line in ")));
  EXPECT_THAT(*ReadFile(bundle_ + "/frames.csv"), testing::StartsWith("frame,state\n0,tracking\n"));
}

TEST_F(BundleTest, IsMadeOfARunWhoseImagesAreGone) {
  fs::remove_all(sequence_);
  const auto bundle = WriteBundle({.run_path = run_, .output_path = bundle_, .images = BundledImages::kSome});
  ASSERT_TRUE(bundle.ok()) << bundle.status().message();
  EXPECT_THAT(bundle->notes,
              testing::Contains(testing::StartsWith("there is no camera.yaml and there are no images: ")));
  EXPECT_THAT(TextsOf(*bundle), Not(HasSubstr("smith")));
}

TEST_F(BundleTest, StoppedOnRequestItLeavesNothing) {
  BundleRequest request{.run_path = run_, .output_path = bundle_, .images = BundledImages::kSome};
  const auto stop_at = [&](const std::string& last) {
    return WriteBundle(request, [&](std::string_view task, int done, int) { return task != last || done < 2; });
  };
  for (const std::string task : {"bundle", "images"}) {
    EXPECT_EQ(stop_at(task).status().code(), ErrorCode::kInterrupted) << task;
    EXPECT_FALSE(fs::exists(bundle_)) << task;
  }
  ASSERT_TRUE(WriteBundle(request).ok());
  request.replaces_bundle = true;
  EXPECT_EQ(stop_at("images").status().code(), ErrorCode::kInterrupted);
  EXPECT_TRUE(fs::exists(bundle_ + "/images/18.jpg")) << "of the former one";
  EXPECT_FALSE(fs::exists(bundle_ + "/.unfinished"));
}

TEST_F(BundleTest, WhatIsNoRunOrThereAlreadyIsAnError) {
  EXPECT_EQ(WriteBundle({.run_path = sequence_, .output_path = bundle_}).status().code(), ErrorCode::kNotFound);
  EXPECT_FALSE(fs::exists(bundle_));
  ASSERT_TRUE(WriteBundle({.run_path = run_, .output_path = bundle_}).ok());
  EXPECT_EQ(WriteBundle({.run_path = run_, .output_path = bundle_}).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace pliant
