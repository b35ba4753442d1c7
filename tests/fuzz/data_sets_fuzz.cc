// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The readers of data sets. The input is a folder as text: a line with the path to open, and then the files, each a
// line @PATH before its content. A file that is called as an image or a video is a fixed one of its kind: their
// decoders are not ours.
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "fuzz_input.h"
#include "pliant/datasets/open_sequence.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

namespace fs = std::filesystem;

constexpr int kMaxFiles = 40;
constexpr int kMaxFrames = 10;
constexpr int kWidth = 32;
constexpr int kHeight = 24;

// Of each ending the file that stands for all of them; for depths and points before it what their names say.
std::map<std::string, fs::path> MakeImages() {
  const fs::path folder = fs::path(FuzzFolder()) / "images";
  fs::create_directories(folder);
  const cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar(90, 120, 200));
  const cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(400));
  std::map<std::string, fs::path> files;
  const auto add = [&](const std::string& ending, const cv::Mat& content) {
    const fs::path path = folder / ("file" + ending);
    try {
      if (cv::imwrite(path.string(), content)) files[ending] = path;
    } catch (const cv::Exception&) {
      // A format that this OpenCV has not.
    }
  };
  add(".png", image);
  add(".jpg", image);
  add("depth.png", depth);
  add("aov.png", cv::Mat(kHeight, kWidth, CV_8UC4, cv::Scalar::all(90)));
  add(".tiff", depth);
  add("points.tiff", cv::Mat(2 * kHeight, kWidth, CV_32FC3, cv::Scalar(40, 1, 2)));
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  add(".exr", cv::Mat(kHeight, kWidth, CV_32FC3, cv::Scalar::all(0.5)));
  for (const char* ending : {".mp4", ".mov"}) {
    const fs::path path = folder / (std::string("file") + ending);
    const int height = std::string(ending) == ".mp4" ? 2 * kHeight : kHeight;  // the left image on top of the right
    cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30,
                           {kWidth, height});
    for (int k = 0; k < 3; ++k) writer.write(cv::Mat(height, kWidth, CV_8UC3, cv::Scalar::all(80)));
    writer.release();
    files[ending] = path;
  }
  return files;
}

// Whether it stays in the folder.
bool IsPath(std::string_view path) {
  constexpr std::string_view kCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-. /";
  return !path.empty() && path.size() < 100 && path.find_first_not_of(kCharacters) == std::string_view::npos &&
         path.front() != '/' && path.find("..") == std::string_view::npos;
}

void WriteFile(const fs::path& folder, const std::string& name, std::string_view content) {
  static const std::map<std::string, fs::path> images = MakeImages();
  std::error_code error;
  const fs::path path = folder / name;
  fs::create_directories(path.parent_path(), error);
  if (error) return;
  std::string ending = path.extension().string();
  if (ending == ".png" && name.find("aov") != std::string::npos)
    ending = "aov.png";
  else if (ending == ".png" && name.find("epth") != std::string::npos)
    ending = "depth.png";
  else if (ending == ".tiff" && name.find("points") != std::string::npos)
    ending = "points.tiff";
  if (const auto image = images.find(ending); image != images.end())
    fs::create_hard_link(image->second, path, error);
  else
    std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
}

// Cuts the text up to the first `end` off.
std::string_view Cut(std::string_view* text, std::string_view end) {
  const std::string_view part = text->substr(0, text->find(end));
  text->remove_prefix(std::min(text->size(), part.size() + end.size()));
  return part;
}

void Check(const Status& status) {
  if (!status.ok() && status.message().empty()) std::abort();
}

void ReadSequence(Sequence& sequence) {
  if (sequence.camera().width() <= 0 || sequence.camera().height() <= 0) std::abort();
  Check(sequence.CheckFiles());
  sequence.Photometric();
  for (int k = 0; k < kMaxFrames; ++k) {
    const auto frame = sequence.Next();
    Check(frame.status());
    if (frame.ok() && !frame->has_value()) break;
    if (frame.ok() && (*frame)->image.cols != sequence.camera().width()) std::abort();
    Check(sequence.Right().status());
  }
  for (int frame_idx = -1; frame_idx < kMaxFrames; ++frame_idx) {
    Check(sequence.Depth(frame_idx).status());
    const auto pose = sequence.WorldFromCamera(frame_idx);
    if (pose && !(pose->translation.allFinite() && std::abs(pose->rotation.norm() - 1) < 1e-6)) std::abort();
    sequence.TimestampS(frame_idx);
    sequence.Name(frame_idx);
  }
  for (const std::string& warning : sequence.Warnings())
    if (warning.empty()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::string opened(Cut(&text, "\n@"));
  if (!IsPath(opened)) return 0;
  const fs::path folder = fs::path(FuzzFolder()) / "set";
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (int k = 0; k < kMaxFiles && !text.empty(); ++k) {
    std::string_view file = Cut(&text, "\n@");
    const std::string name(Cut(&file, "\n"));
    if (IsPath(name)) WriteFile(folder, name, file);
  }
  const auto sequence = OpenSequence({.image_path = folder / opened});
  Check(sequence.status());
  if (sequence.ok()) ReadSequence(**sequence);
  return 0;
}
