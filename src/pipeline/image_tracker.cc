// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/image_tracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "pipeline/choose_working_image.h"
#include "pipeline/working_frame.h"
#include "pliant/datasets/frame_checks.h"

namespace pliant {
namespace {

Status NeedsImagesAlone(const TrackOptions& track_options) {
  const TrackerOptions& options = track_options.tracker;
  if (track_options.track_file.IsGiven())
    return {ErrorCode::kInvalidArgument,
            "TrackFile.path is a file of the tracks of a sequence; track its folder, or leave it empty"};
  if (options.oracle.Any())
    return {ErrorCode::kInvalidArgument, "Oracle options ask the truth of a simulated sequence; track its folder"};
  if (options.depth_prior.IsGiven())
    return {ErrorCode::kInvalidArgument,
            "DepthPrior.path is a folder, and here depth priors come with their images; leave it empty"};
  if (options.init.TakesKnownDepth())
    return {ErrorCode::kInvalidArgument, "Init.method " + std::string(EnumName(options.init.method)) +
                                             " needs more than images; track a sequence that has it"};
  return Status::Ok();
}

Status CheckImageSize(const cv::Mat& image, const std::string& what, const Camera& camera) {
  if (image.cols == camera.width() && image.rows == camera.height()) return Status::Ok();
  return {ErrorCode::kMismatch, what + " has " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                                    " pixels, and the camera " + std::to_string(camera.width()) + "x" +
                                    std::to_string(camera.height()) + "; give images of the camera's size"};
}

}  // namespace

Result<ImageTracker> ImageTracker::Create(const Camera& camera,
                                          const std::optional<PhotometricCalibration>& photometric,
                                          const TrackOptions& options, std::span<const SequenceFrame> examples,
                                          const TrackerExtensions& extensions) {
  if (Status status = NeedsImagesAlone(options); !status.ok()) return status;
  for (const SequenceFrame& frame : examples)
    if (Status status = CheckImageSize(frame.image, "image " + frame.name, camera); !status.ok()) return status;
  const WorkingImage working = ChooseWorkingImage({ImageRun(examples.begin(), examples.end())}, options);
  auto working_camera = camera.Resized(working.scale);
  if (!working_camera.ok()) return working_camera.status();
  return ImageTracker(camera, *working_camera, working, {.photometric = photometric, .extensions = extensions},
                      options);
}

ImageTracker::ImageTracker(const Camera& source, const Camera& working_camera, const WorkingImage& working,
                           const TrackerInputs& inputs, const TrackOptions& options)
    : camera_(source), working_(working), options_(options) {
  options_.tracker = WorkingOptions(std::move(options_.tracker), working);
  tracker_ = std::make_unique<Tracker>(working_camera, options_.tracker, static_cast<std::uint64_t>(options.seed),
                                       options.threads, inputs);
}

Result<std::vector<FrameReport>> ImageTracker::Process(const SequenceFrame& frame) {
  if (Status status = CheckImageSize(frame.image, "image " + frame.name, camera_); !status.ok()) return status;
  if (!frame.mask.empty())
    if (Status status = CheckImageSize(frame.mask, "the mask of image " + frame.name, camera_); !status.ok())
      return status;
  if (!frame.depth_prior.empty() && frame.depth_prior.type() != CV_32FC1)
    return Status(ErrorCode::kInvalidArgument,
                  "the depth prior of image " + frame.name + " is not of 32-bit floats with one channel; convert it");
  if (!frame.depth_prior.empty())
    if (Status status = CheckDepthPriorSize(frame.depth_prior.size(), {camera_.width(), camera_.height()},
                                            "the depth prior of image " + frame.name);
        !status.ok())
      return status;
  if (Status status = CheckTime(frame); !status.ok()) return status;
  last_timestamp_s_ = frame.timestamp_s;
  ++images_;
  kept_.push_back(frame);
  std::vector<FrameReport> done = ProcessFrom(kept_.size() - 1);
  ForgetFrames();
  return done;
}

// A pause may be long, but the second image does not come a thousand seconds after the first.
Status ImageTracker::CheckTime(const SequenceFrame& frame) const {
  if (!std::isfinite(frame.timestamp_s) || (last_timestamp_s_ && !(frame.timestamp_s > *last_timestamp_s_)))
    return {ErrorCode::kInvalidArgument,
            "the time of image " + frame.name +
                " is not finite, or not after that of the one before; give times that grow"};
  if (images_ != 1) return Status::Ok();
  return CheckFrameTimes(std::array{*last_timestamp_s_, frame.timestamp_s}, "the times of the first two images are");
}

std::vector<FrameReport> ImageTracker::Finish() {
  std::vector<FrameReport> done;
  while (true) {
    tracker_->EndSequence();
    std::size_t next = kept_.size();
    if (!GoBack(&next)) break;
    std::ranges::move(ProcessFrom(next), std::back_inserter(done));
  }
  for (FrameReport& report : tracker_->Finish()) done.push_back(InSourcePixels(std::move(report), working_));
  kept_.clear();
  return done;
}

// The kept frames from `next` on; tracking may go back on the way.
std::vector<FrameReport> ImageTracker::ProcessFrom(std::size_t next) {
  std::vector<FrameReport> done;
  while (next < kept_.size()) {
    const PreparedFrame frame = PrepareWorkingFrame(kept_[next], working_, options_.tracker);
    for (FrameReport& report : tracker_->Process(frame)) done.push_back(InSourcePixels(std::move(report), working_));
    ++next;
    GoBack(&next);
  }
  return done;
}

// Whether tracking went back: what comes next is the frame after the one that it went back to.
bool ImageTracker::GoBack(std::size_t* next) {
  const auto back = tracker_->TakeGoesBackTo();
  if (!back) return false;
  const auto after = std::ranges::find_if(kept_, [&](const SequenceFrame& frame) { return frame.frame_idx > *back; });
  *next = static_cast<std::size_t>(after - kept_.begin());
  return true;
}

void ImageTracker::ForgetFrames() {
  const int first = tracker_->held().empty() ? kept_.back().frame_idx + 1 : tracker_->held().front().frame_idx;
  std::erase_if(kept_, [&](const SequenceFrame& frame) { return frame.frame_idx < first; });
}

}  // namespace pliant
