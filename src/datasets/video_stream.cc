// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <opencv2/videoio.hpp>

#include "datasets/image_stream.h"
#include "image/image_size.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Containers without an index estimate their number of frames from duration and rate.
constexpr double kCountSlack = 0.01;  // of the count, and at least one frame

class VideoStream final : public ImageStream {
 public:
  explicit VideoStream(fs::path file) : file_(std::move(file)) {}

  Status Open();

  const fs::path& path() const override { return file_; }
  int count() const override { return count_; }
  bool count_is_exact() const override { return false; }
  std::optional<double> fps() const override { return fps_; }
  std::string Title(int idx) const override {
    return "frame " + std::to_string(idx) + " of the video " + file_.string();
  }
  std::optional<cv::Size> SizeAt(int /*idx*/) const override { return size_; }

  std::string Name(int idx) const override {
    char name[32];
    std::snprintf(name, sizeof name, "%06d.png", idx);
    return name;
  }

  Result<std::optional<cv::Mat>> Read(int idx) override;
  std::optional<double> RecordedS() const override { return recorded_s_; }

 private:
  Status BreaksOff() const;

  fs::path file_;
  cv::VideoCapture capture_;
  cv::Size size_;
  std::optional<double> fps_;
  int count_ = 0;
  int read_ = 0;  // frames taken from the decoder
  std::optional<double> recorded_s_;
  bool ended_ = false;
};

Status VideoStream::Open() {
  try {
    capture_.open(file_.string(), cv::CAP_FFMPEG);
  } catch (const cv::Exception&) {
    capture_.release();
  }
  if (!capture_.isOpened())
    return {ErrorCode::kUnreadable, "cannot open " + file_.string() +
                                        " as a video: it is damaged, cut off before its index, or not a video; convert "
                                        "it to a folder of images, or copy it again"};
  const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  count_ = count > 0 && count < 1e9 ? static_cast<int>(std::lround(count)) : 0;
  if (const double fps = capture_.get(cv::CAP_PROP_FPS); std::isfinite(fps) && fps > 0) fps_ = fps;
  size_ = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
           static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
  return CheckPixels(size_, "the video " + file_.string());
}

Status VideoStream::BreaksOff() const {
  return {ErrorCode::kUnreadable, "the video " + file_.string() + " breaks off: frame " + std::to_string(read_) +
                                      " of " + std::to_string(count_) +
                                      " cannot be decoded; copy it again, or set end to " + std::to_string(read_)};
}

Result<std::optional<cv::Mat>> VideoStream::Read(int idx) {
  if (ended_) return std::optional<cv::Mat>();
  while (read_ <= idx) {
    if (!capture_.grab()) {
      ended_ = true;
      const int slack = std::max(1, static_cast<int>(kCountSlack * count_));
      if (count_ - read_ > slack) return BreaksOff();
      return std::optional<cv::Mat>();
    }
    ++read_;
  }
  cv::Mat decoded;
  if (!capture_.retrieve(decoded) || decoded.empty() || decoded.depth() != CV_8U)
    return Status(ErrorCode::kUnreadable, Title(idx) + " cannot be decoded; copy it again");
  const double recorded_ms = capture_.get(cv::CAP_PROP_POS_MSEC);
  const bool is_known = std::isfinite(recorded_ms) && (recorded_ms > 0 || idx == 0);
  recorded_s_ = is_known ? std::optional(1e-3 * recorded_ms) : std::nullopt;
  if (decoded.u == nullptr) decoded = decoded.clone();  // memory that the decoder reuses
  return std::optional<cv::Mat>(std::move(decoded));
}

}  // namespace

Result<std::unique_ptr<ImageStream>> StreamVideo(const fs::path& file) {
  auto stream = std::make_unique<VideoStream>(file);
  if (Status status = stream->Open(); !status.ok()) return status;
  return std::unique_ptr<ImageStream>(std::move(stream));
}

}  // namespace pliant
