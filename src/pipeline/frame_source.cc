// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/frame_source.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "pipeline/working_frame.h"
#include "pliant/base/state_archive.h"
#include "pliant/tracking/bootstrapping/stereo_pair.h"

namespace pliant {
namespace {

constexpr int kFramesAhead = 3;
constexpr double kMaxPixelsAhead = 36e6;  // of the source's images; none of a larger one
constexpr int kLiveFramesAhead = 1;       // it is prepared while tracking is busy; more would be old by then

// The depth image of a frame, read when it is asked for; copies read it once together. The sequence must outlive that.
class KnownDepth {
 public:
  KnownDepth(const Sequence& sequence, int frame_idx)
      : sequence_(&sequence), frame_idx_(frame_idx), read_(std::make_shared<std::optional<DepthImage>>()) {}
  const Result<std::optional<cv::Mat>>& Get() const {
    if (!*read_) *read_ = sequence_->Depth(frame_idx_);
    return **read_;
  }

 private:
  using DepthImage = Result<std::optional<cv::Mat>>;
  const Sequence* sequence_;
  int frame_idx_;
  std::shared_ptr<std::optional<DepthImage>> read_;
};

int FramesAhead(const RunStart& start) {
  const double scale = start.working_image.scale;
  const double pixels = 1.0 * start.working_camera->width() * start.working_camera->height() / (scale * scale);
  return std::clamp(static_cast<int>(kMaxPixelsAhead / pixels), 0, kFramesAhead);
}

}  // namespace

FrameSource::FrameSource(CheckedSequence& sequence, const SequenceRequest& input, const TrackOptions& options,
                         const RunStart& start, bool wants_depth, int last_frame_idx, int checkpoint_frames)
    : input_(input),
      options_(options),
      start_(start),
      wants_depth_(wants_depth),
      checkpoint_frames_(checkpoint_frames),
      last_frame_idx_(last_frame_idx) {
  ReadAhead(
      [this, &sequence] {
        auto read = Read(sequence);
        if (read && read->ok() && IsCheckpoint((*read)->frame.frame_idx)) {
          StateArchive archive;
          archive(sequence);
          (*read)->checked = archive.bytes();
        }
        return read;
      },
      &frames_);
}

bool FrameSource::IsCheckpoint(int frame_idx) const {
  return checkpoint_frames_ > 0 && ((frame_idx - input_.start) / input_.stride + 1) % checkpoint_frames_ == 0;
}

std::optional<Result<ReadFrame>> FrameSource::Read(Sequence& sequence) const {
  const WorkingImage& working = start_.working_image;
  auto next = sequence.Next();
  if (!next.ok()) return next.status();
  if (!next->has_value()) return std::nullopt;
  const SequenceFrame& frame = **next;
  ReadFrame read{PrepareWorkingFrame(frame, working, options_.tracker), frame.image, {}, {}};
  if (!wants_depth_) return read;
  if (options_.tracker.init.method == InitMethod::kColmapModel) {
    read.frame.known_points = [&start = start_, name = frame.name] {
      std::vector<PixelDepth> points = start.model->PointsIn(name);
      for (PixelDepth& point : points) point.pixel = start.working_image.ToWorking(point.pixel);
      return points;
    };
  } else if (!start_.cloud_depth_mm.empty()) {
    if (frame.frame_idx == start_.first_frame_idx)
      read.frame.known_depth_mm = [&start = start_] { return start.working_image.Nearest(start.cloud_depth_mm); };
  } else if (options_.tracker.init.method == InitMethod::kStereo) {
    const auto right = sequence.Right();
    read.depth_status = [status = right.status()] { return status; };
    if (right.ok() && right->has_value())
      read.frame.known_points = [left = read.frame, right = working.Image(**right), camera = *start_.working_camera,
                                 baseline_mm = sequence.BaselineMm().value_or(0.0), &options = options_.tracker,
                                 threads = options_.threads] {
        return PointsOfPair(left, right, camera, baseline_mm, options, threads);
      };
  } else {
    const KnownDepth depth(sequence, frame.frame_idx);
    read.depth_status = [depth] { return depth.Get().status(); };
    read.frame.known_depth_mm = [depth, &working] {
      const auto& depth_mm = depth.Get();
      return depth_mm.ok() && depth_mm->has_value() ? working.Nearest(**depth_mm) : cv::Mat();
    };
  }
  return read;
}

std::optional<Result<ReadFrame>> FrameSource::Next() {
  if (again_) {
    if (auto frame = again_->Next()) return frame;
    again_.reset();
  }
  const auto asked = Clock::now();
  auto frame = frames_->Next();
  if (!frame || !frame->ok()) return frame;
  arrived_ = asked;
  last_frame_idx_ = (*frame)->frame.frame_idx;
  if (input_.IsLive()) {
    const auto arrived = input_.given->images->Arrived(last_frame_idx_);
    arrived_ = arrived.value_or(arrived_);
  }
  return frame;
}

Status FrameSource::GoBackTo(int frame_idx) {
  again_.reset();
  if (frame_idx >= last_frame_idx_) return Status::Ok();
  SequenceRequest part = input_;
  part.start = frame_idx + input_.stride;
  part.end = last_frame_idx_ + 1;
  auto reopened = OpenSequence(part);
  if (!reopened.ok()) return reopened.status();
  reopened_ = *std::move(reopened);
  ReadAhead([this] { return Read(*reopened_); }, &again_);
  return Status::Ok();
}

void FrameSource::ReadAhead(std::function<std::optional<Result<ReadFrame>>()> read, Frames* frames) const {
  frames->emplace(std::move(read),
                  options_.threads == 1 ? 0 : (input_.IsLive() ? kLiveFramesAhead : FramesAhead(start_)));
}

}  // namespace pliant
