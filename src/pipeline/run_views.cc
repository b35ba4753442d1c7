// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_views.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/run_frames.h"
#include "pliant/base/statistics.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/image/interlacing.h"
#include "pliant/photometric/stereo_matching.h"

namespace pliant {
namespace {

constexpr std::size_t kMinPairPoints = 20;
constexpr double kMaxPairSpread = 0.05;  // relative, of the depths of a pair by those of the run; median

}  // namespace

Result<std::vector<PosedFrame>> ReadPosedFrames(const std::string& path, const Run& run) {
  const auto frames_idx = FramesWithPose(path, run);
  if (!frames_idx.ok()) return frames_idx.status();
  std::set<int> provisional;
  for (const RunFrame& frame : run.frames)
    if (frame.state == TrackingState::kProvisional) provisional.insert(frame.frame_idx);
  std::vector<PosedFrame> frames;
  for (const RunPose& pose : run.poses)
    frames.push_back({*pose.frame_idx,
                      pose.submap,
                      pose.timestamp_s,
                      provisional.contains(*pose.frame_idx),
                      pose.world_from_cam.Inverse(),
                      {}});
  const Status status = ForEachFrame(path, *frames_idx, [&](std::size_t k, const auto& observations) {
    frames[k].observations = observations;
    std::ranges::sort(frames[k].observations, {}, &PointObservation::id);
    return Status::Ok();
  });
  if (!status.ok()) return status;
  return frames;
}

Status RunViews::ReadUntil(std::size_t position, const std::function<bool(std::size_t)>& is_needed,
                           const std::function<bool(std::size_t)>& needs_right) {
  for (; next_ <= position; ++next_) {
    const PosedFrame& posed = frames_[next_];
    const auto name = known_.names.find(posed.frame_idx);
    const auto frame = NextFrameOfRun(*known_.camera, posed.frame_idx,
                                      name != known_.names.end() ? name->second : std::string(), sequence_.get());
    if (!frame.ok()) return frame.status();
    const cv::Mat image = ImageOf(frame->image);
    colors_.Compare(posed.observations, image);
    if (!is_needed(next_)) continue;
    const SurfaceView& view =
        views_[next_] = {image, ValidMask(image, frame->mask, masks_), posed.cam_from_world, posed.observations};
    masks_given_[next_] = frame->mask;
    if (pair_threads_ == 0 || !needs_right || !needs_right(next_)) continue;
    if (!CheckPairs("a surface", *known_.camera, sequence_->BaselineMm()).ok()) continue;
    const auto right = sequence_->Right();
    if (!right.ok()) return right.status();
    if (!right->has_value()) continue;
    if (auto right_view = RightView(view, frame->mask, ImageOf(**right))) rights_[next_] = *std::move(right_view);
  }
  return Status::Ok();
}

cv::Mat RunViews::ImageOf(const cv::Mat& source) const { return known_.interlaced ? WithoutOddRows(source) : source; }

const SurfaceView* RunViews::RightOf(std::size_t position) const {
  const auto found = rights_.find(position);
  return found != rights_.end() ? &found->second : nullptr;
}

void RunViews::ForgetUnless(const std::function<bool(std::size_t)>& is_needed) {
  for (auto* views : {&views_, &rights_})
    std::erase_if(*views, [&](const auto& entry) { return !is_needed(entry.first); });
  std::erase_if(masks_given_, [&](const auto& entry) { return !is_needed(entry.first); });
}

cv::Mat RunViews::TissueIn(std::size_t position) const {
  MaskOptions masks = masks_;
  masks.highlights = Switch::kOff;
  return ValidMask(views_.at(position).image, masks_given_.at(position), masks);
}

// One map unit is as many millimeters as the pair's depths of the frame's points say.
std::optional<SurfaceView> RunViews::RightView(const SurfaceView& left, const cv::Mat& mask,
                                               const cv::Mat& right) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& observation : left.observations) pixels.push_back(observation.pixel);
  const double baseline_mm = *sequence_->BaselineMm();
  const auto depths = DepthsOfPair(*known_.camera, baseline_mm, left.image, mask, right, pixels, pair_threads_);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double depth = (left.cam_from_world * left.observations[i].position).z();
    if (depths[i].lookup == DepthLookup::kOk && depth > 0.0) ratios.push_back(std::log(depths[i].depth_mm / depth));
  }
  if (ratios.size() < kMinPairPoints || MedianDeviation(ratios) > kMaxPairSpread) return std::nullopt;
  const double unit_mm = std::exp(Median(ratios));
  const Rigid3 right_from_left(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-baseline_mm / unit_mm, 0.0, 0.0));
  return SurfaceView{right, ValidMask(right, {}, masks_), right_from_left * left.cam_from_world, left.observations};
}

}  // namespace pliant
