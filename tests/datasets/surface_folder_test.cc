// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/surface_folder.h"

#include <filesystem>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr const char* kWindows = R"({"image_width": 320, "side": 21, "smoothing_px": 1.5, "noise_levels": 2})";

class SurfaceFolderFile : public testing::Test {
 protected:
  SurfaceFolderFile() {
    folder_.Write("camera.yaml",
                  "model: PINHOLE\nwidth: 32\nheight: 24\nparams: [30, 30, 15.5, 11.5]\ndepth_scale: 0.01\n");
  }
  // With one frame of this name, and what is said of the windows.
  Result<SurfaceFolder> Read(const std::string& name, const std::string& windows = kWindows) {
    folder_.Write("surface.json", R"({"status": "completed", "frames": [
      {"frame": 3, "name": ")" + name +
                                      R"(", "note": "", "neighbors": [1, 5]},
      {"frame": 4, "name": "4.png", "note": "there is no map"}], "windows": )" +
                                      windows + "}");
    return ReadSurfaceFolder(folder_.Path("."));
  }

  const TestFolder folder_;
};

TEST_F(SurfaceFolderFile, HasTheFramesWithADepth) {
  const auto surface = Read("3.png");
  ASSERT_TRUE(surface.ok()) << surface.status().message();
  ASSERT_EQ(surface->frames.size(), 1U);
  EXPECT_EQ(surface->frames[0].frame_idx, 3);
  EXPECT_EQ(surface->frames[0].file_name, "3.png");
  EXPECT_THAT(surface->frames[0].neighbors, testing::ElementsAre(1, 5));
  EXPECT_EQ(surface->depth_scale, 0.01);
  ASSERT_TRUE(surface->windows.has_value());
  EXPECT_EQ(surface->windows->window_px, 21);
}

TEST_F(SurfaceFolderFile, NamesNoFileElsewhere) {
  for (const std::string name : {"../3.png", "/tmp/3.png", "a/3.png", ""}) {
    const auto surface = Read(name);
    ASSERT_FALSE(surface.ok()) << name;
    EXPECT_EQ(surface.status().code(), ErrorCode::kUnreadable);
    EXPECT_THAT(surface.status().message(), HasSubstr("which is not a file's name")) << name;
  }
}

TEST_F(SurfaceFolderFile, HasAFileOfItsOwnForEveryFrame) {
  folder_.Write("surface.json", R"({"status": "completed", "frames": [
    {"frame": 3, "name": "a.png", "note": ""}, {"frame": 4, "name": "a.png", "note": ""}]})");
  const auto shared = ReadSurfaceFolder(folder_.Path("."));
  EXPECT_EQ(shared.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(shared.status().message(), HasSubstr("gives two frames one file, 'a.png'"));
}

TEST_F(SurfaceFolderFile, ComparedNoWindowsThatCannotBe) {
  for (const char* windows : {R"({"image_width": 0, "side": 21, "smoothing_px": 1, "noise_levels": 2})",
                              R"({"image_width": 320, "side": 0, "smoothing_px": 1, "noise_levels": 2})",
                              R"({"image_width": 320, "side": 100000, "smoothing_px": 1, "noise_levels": 2})",
                              R"({"image_width": 320, "side": 21, "smoothing_px": 1e9, "noise_levels": 2})",
                              R"({"image_width": 320, "side": 21, "smoothing_px": 1, "noise_levels": -2})"}) {
    const auto surface = Read("3.png", windows);
    ASSERT_FALSE(surface.ok()) << windows;
    EXPECT_EQ(surface.status().code(), ErrorCode::kUnreadable);
    EXPECT_THAT(surface.status().message(), HasSubstr("windows that were compared what cannot be")) << windows;
  }
}

TEST_F(SurfaceFolderFile, ItsFramesAreNumbersThatComeOnce) {
  for (const auto& [number, neighbors, what] :
       {std::tuple("4", "1", "has frame 4 more than once"), std::tuple("1e300", "1", "of another kind"),
        std::tuple("3.5", "1", "of another kind"), std::tuple("-3", "1", "of another kind"),
        std::tuple("4294967299", "1", "of another kind"), std::tuple("3", "-5", "of another kind")}) {
    folder_.Write("surface.json", R"({"status": "completed", "frames": [{"frame": )" + std::string(number) +
                                      R"(, "name": "3.png", "note": "", "neighbors": [)" + neighbors +
                                      R"(]}, {"frame": 4, "name": "4.png", "note": "there is no map"}]})");
    const auto surface = ReadSurfaceFolder(folder_.Path("."));
    ASSERT_FALSE(surface.ok()) << number << " " << neighbors;
    EXPECT_EQ(surface.status().code(), ErrorCode::kUnreadable);
    EXPECT_THAT(surface.status().message(), HasSubstr(what));
  }
}

TEST_F(SurfaceFolderFile, KnowsTheRunThatItWasMadeOf) {
  for (const char* run : {"run", "copy", "other"}) {
    std::filesystem::create_directories(folder_.Path(run));
    folder_.Write(std::string(run) + "/trajectory.txt", std::string(run) == "other" ? "987654321" : "123456789");
  }
  const auto read = [&](const std::string& checksum) {
    folder_.Write("surface.json", R"({"status": "completed", "frames": [], "run": ")" + folder_.Path("run") + "\"" +
                                      (checksum.empty() ? "" : R"(, "trajectory_crc32": ")" + checksum + "\"") + "}");
    return *ReadSurfaceFolder(folder_.Path("."));
  };
  const SurfaceFolder surface = read("cbf43926");
  EXPECT_TRUE(CheckSurfaceOfRun(surface, folder_.Path("run")).ok());
  EXPECT_TRUE(CheckSurfaceOfRun(surface, folder_.Path("copy")).ok());
  EXPECT_THAT(CheckSurfaceOfRun(surface, folder_.Path("other")).message(), HasSubstr("was made of the run"));

  const Status replaced = CheckSurfaceOfRun(read("01234567"), folder_.Path("run"));
  EXPECT_EQ(replaced.code(), ErrorCode::kMismatch);
  EXPECT_THAT(replaced.message(), HasSubstr("which was replaced or continued since"));

  // Earlier versions name the run's folder alone.
  const SurfaceFolder earlier = read("");
  EXPECT_TRUE(CheckSurfaceOfRun(earlier, folder_.Path("run")).ok());
  EXPECT_TRUE(CheckSurfaceOfRun(earlier, folder_.Path("copy")).ok());
  EXPECT_EQ(CheckSurfaceOfRun(earlier, folder_.Path("other")).code(), ErrorCode::kMismatch);
}

TEST_F(SurfaceFolderFile, OfAnotherFormIsRefused) {
  for (const std::string text :
       {"", "{", "[]", R"({"status": "completed"})", R"({"status": "completed", "frames": [{"frame": "x"}]})"}) {
    folder_.Write("surface.json", text);
    const auto surface = ReadSurfaceFolder(folder_.Path("."));
    ASSERT_FALSE(surface.ok()) << text;
    EXPECT_EQ(surface.status().code(), ErrorCode::kUnreadable);
    EXPECT_THAT(surface.status().message(), HasSubstr("make the surface again with pliant surface")) << text;
    EXPECT_THAT(surface.status().message(), testing::Not(HasSubstr("json.exception"))) << text;
  }
  folder_.Write("surface.json", R"({"status": "interrupted"})");
  EXPECT_THAT(ReadSurfaceFolder(folder_.Path(".")).status().message(), HasSubstr("never finished"));
}

}  // namespace
}  // namespace pliant
