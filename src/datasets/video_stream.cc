// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include <opencv2/videoio.hpp>

#include "datasets/image_stream.h"
#include "datasets/video_index.h"
#include "datasets/video_length.h"
#include "image/image_size.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Frames that are decoded and dropped sooner than sought: about as many as lie between two that need no others.
constexpr int kMaxDropped = 250;
constexpr int kSoughtBefore = 4;  // frames: what is sought by its time is met a little early

// Containers without an index estimate their number of frames from duration and rate.
constexpr double kCountSlack = 0.01;  // of the count, and at least one frame
constexpr double kMaxReordered = 16;  // frames: that may be coded after one that is shown later, H.264 and H.265
constexpr double kMaxFps = 1000;      // rates from there on are the unit of the container's times
constexpr int kMaxDamaged = 300;      // packets in a row: a decoder says no more of one than of the video's end

class VideoStream final : public ImageStream {
 public:
  VideoStream(fs::path file, std::shared_ptr<VideoIndex> index) : file_(std::move(file)), index_(std::move(index)) {}

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
  bool IsDamaged(int idx) const override { return idx < read_ - 1; }  // the decoder is beyond it
  std::optional<double> RecordedS() const override { return recorded_s_; }

 private:
  Status BeginAnew();
  Status BreaksOff() const;
  bool EndsEarly() const;
  bool Grab();
  Status Seek(int idx);
  Status ReadWithoutSeeking();
  bool IsTheSame(int idx, const cv::Mat& decoded) const;

  fs::path file_;
  std::shared_ptr<VideoIndex> index_;
  cv::VideoCapture capture_;
  cv::Size size_;
  std::optional<double> fps_;
  int count_ = 0;
  int read_ = 0;  // frames before the one that the decoder gives next
  std::optional<double> recorded_s_;
  double last_ms_ = 0;  // the latest time of a frame that was grabbed
  bool ended_ = false;
  bool has_sought_ = false;  // since the decoder began with frame 0
  bool may_seek_ = true;     // until that gave another frame than the index knows
};

Status VideoStream::BeginAnew() {
  read_ = 0;
  has_sought_ = false;
  try {
    // FFmpeg takes what stands before a colon in a relative name for a protocol.
    capture_.open(fs::absolute(file_).string(), cv::CAP_FFMPEG);
  } catch (const cv::Exception&) {
    capture_.release();
  }
  if (capture_.isOpened()) return Status::Ok();
  return {ErrorCode::kUnreadable, "cannot open " + file_.string() +
                                      " as a video: it is damaged, cut off before its index, or not a video; convert "
                                      "it to a folder of images, or copy it again"};
}

Status VideoStream::Open() {
  if (Status status = BeginAnew(); !status.ok()) return status;
  const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  if (const double fps = capture_.get(cv::CAP_PROP_FPS); std::isfinite(fps) && fps > 0 && fps < kMaxFps) fps_ = fps;
  // Where it has no index the number is that of the rate.
  if (fps_ && count > 0 && count < 1e9) count_ = static_cast<int>(std::lround(count));
  size_ = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
           static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
  return CheckPixels(size_, "the video " + file_.string());
}

Status VideoStream::BreaksOff() const {
  return {ErrorCode::kUnreadable, "the video " + file_.string() + " breaks off: frame " + std::to_string(read_) +
                                      " of " + std::to_string(count_) +
                                      " cannot be decoded; copy it again, or set end to " + std::to_string(read_)};
}

// By the number of frames, and by the time of the last one: at an uneven rate an estimate of the former is off.
// One that begins between two frames that need no others shows nothing up to the second. One that was cut without being
// coded again ends in the order of coding: of the last frames it may lack some that are shown before others.
bool VideoStream::EndsEarly() const {
  const double slack = std::max(CountsFrames(file_) ? 1.0 : kMaxDropped, kCountSlack * count_);
  const double by_time = fps_.value_or(0.0) * last_ms_ / 1e3 + 1.0;
  const double read = std::max(1.0 * read_, by_time);
  if (count_ - read <= slack) return false;
  const auto shown_s = ShownSeconds(file_);
  const double shown = shown_s ? *shown_s * fps_.value_or(0.0) : count_;
  const bool is_cut = shown < count_ - slack;
  return std::min<double>(count_, shown) - read > (is_cut ? std::max(slack, kMaxReordered) : slack);
}

bool VideoStream::Grab() {
  int damaged = 0;
  while (!capture_.grab())
    if (++damaged > kMaxDamaged) return false;
  const double ms = capture_.get(cv::CAP_PROP_POS_MSEC);
  if (ms > last_ms_) last_ms_ = ms;  // the last frames of some videos come without a time
  read_ += damaged;                  // each of a frame of its own
  if (index_ && !has_sought_) index_->Add(read_, ms);
  ++read_;
  return true;
}

// The frame that is grabbed next is `idx` then, or the video is read anew.
Status VideoStream::Seek(int idx) {
  const auto time_before_ms = index_->TimeMs(idx - 1);
  const auto sought_ms = index_->TimeMs(idx - kSoughtBefore);
  if (!time_before_ms || !sought_ms || !index_->Digest(idx)) return Status::Ok();
  double time_ms = -1.0;
  bool goes_on = capture_.set(cv::CAP_PROP_POS_MSEC, *sought_ms);
  while (goes_on && time_ms < *time_before_ms) {
    goes_on = capture_.grab();
    time_ms = capture_.get(cv::CAP_PROP_POS_MSEC);
  }
  has_sought_ = true;
  read_ = idx;
  return time_ms == *time_before_ms ? Status::Ok() : ReadWithoutSeeking();
}

Status VideoStream::ReadWithoutSeeking() {
  may_seek_ = false;
  return BeginAnew();
}

// Whether frame `idx` is what it was when nothing was sought; true where it was not decoded then.
bool VideoStream::IsTheSame(int idx, const cv::Mat& decoded) const {
  const auto digest = index_->Digest(idx);
  return !digest || *digest == DigestOf(decoded);
}

Result<std::optional<cv::Mat>> VideoStream::Read(int idx) {
  if (ended_) return std::optional<cv::Mat>();
  if (index_ && may_seek_ && idx - read_ > kMaxDropped)
    if (Status status = Seek(idx); !status.ok()) return status;
  while (read_ <= idx) {
    if (Grab()) continue;
    if (has_sought_) {
      if (Status status = ReadWithoutSeeking(); !status.ok()) return status;
    } else {
      ended_ = true;
      if (EndsEarly()) return BreaksOff();
      return std::optional<cv::Mat>();
    }
  }
  if (IsDamaged(idx)) return Status(ErrorCode::kUnreadable, Title(idx) + " is damaged; copy it again");
  cv::Mat decoded;
  const bool is_decoded = capture_.retrieve(decoded) && !decoded.empty() && decoded.depth() == CV_8U;
  if (has_sought_ && !(is_decoded && IsTheSame(idx, decoded))) {
    if (Status status = ReadWithoutSeeking(); !status.ok()) return status;
    return Read(idx);
  }
  if (!is_decoded) return Status(ErrorCode::kUnreadable, Title(idx) + " cannot be decoded; copy it again");
  if (index_ && !has_sought_) index_->SetDigest(idx, DigestOf(decoded));
  const double recorded_ms = capture_.get(cv::CAP_PROP_POS_MSEC);
  const bool is_known = std::isfinite(recorded_ms) && (recorded_ms > 0 || idx == 0);
  recorded_s_ = is_known ? std::optional(1e-3 * recorded_ms) : std::nullopt;
  if (decoded.u == nullptr) decoded = decoded.clone();  // memory that the decoder reuses
  return std::optional<cv::Mat>(std::move(decoded));
}

}  // namespace

Result<std::unique_ptr<ImageStream>> StreamVideo(const fs::path& file, std::shared_ptr<VideoIndex> index) {
  auto stream = std::make_unique<VideoStream>(file, std::move(index));
  if (Status status = stream->Open(); !status.ok()) return status;
  return std::unique_ptr<ImageStream>(std::move(stream));
}

}  // namespace pliant
