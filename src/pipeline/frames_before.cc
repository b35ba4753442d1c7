// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/frames_before.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "pipeline/working_frame.h"
#include "pliant/scene/serialize.h"

namespace pliant {
namespace {

// Frames that are read and prepared at once, and then tracked in reverse order.
constexpr std::size_t kChunk = 10;

// The frame's own time was spent as well.
void AddTimes(const FrameReport& before, FrameReport* report) {
  for (auto& [stage, ms] : report->stage_ms)
    for (const auto& [stage_before, ms_before] : before.stage_ms)
      if (stage_before == stage) ms += ms_before;
}

}  // namespace

FramesBefore::FramesBefore(const SequenceRequest& input, const WorkingImage& working, const Camera& camera,
                           const TrackOptions& options, const TrackerInputs& inputs, Tracker* tracker)
    : input_(input), working_(working), camera_(camera), options_(options), inputs_(inputs), tracker_(tracker) {
  // The map grows as it does forwards; a window that runs backwards, with a reference of its own, would contradict it.
  options_.tracker.growth.window = 0;
  options_.tracker.submaps = Switch::kOff;
  if (options_.tracker.oracle.Any()) options_.max_frames_back = 0;
}

std::vector<FrameReport> FramesBefore::Pass(std::vector<FrameReport> reports) {
  std::vector<FrameReport> final_reports;
  const auto release = [&](std::size_t count) {
    const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
    std::move(waiting_.begin(), end, std::back_inserter(final_reports));
    waiting_.erase(waiting_.begin(), end);
  };
  for (FrameReport& report : reports) {
    if (!HasPose(report.state)) {
      waiting_.push_back(std::move(report));
      if (static_cast<int>(waiting_.size()) > options_.max_frames_back) release(1);
      continue;
    }
    if (report.first_map) evidence_[report.submap] = report.first_map->evidence;
    if (!waiting_.empty()) {
      TrackBack(report);
      MoveNewPoints(&report);
    }
    release(waiting_.size());
    final_reports.push_back(std::move(report));
  }
  return final_reports;
}

std::vector<FrameReport> FramesBefore::Finish() { return std::exchange(waiting_, {}); }

// Frames `first` to `last` of the source, prepared; nothing when one of them cannot be read.
std::vector<PreparedFrame> FramesBefore::Read(int first, int last, std::size_t count) const {
  SequenceRequest request = input_;
  request.start = first;
  request.end = last + 1;
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return {};
  std::vector<PreparedFrame> frames;
  while (frames.size() < count) {
    const auto next = (*sequence)->Next();
    if (!next.ok() || !next->has_value()) return {};
    frames.push_back(PrepareWorkingFrame(**next, working_, options_.tracker));
  }
  return frames;
}

// From `last`, the frame after those that wait. An image that cannot be read, or a map that is lost on the way, leaves
// the frames before it as they are.
void FramesBefore::TrackBack(const FrameReport& last) {
  const std::vector<PreparedFrame> at_last = Read(last.frame_idx, last.frame_idx, 1);
  if (at_last.empty()) return;
  Tracker tracker(camera_, options_.tracker, 0, options_.threads, inputs_);
  tracker.TakeMap(at_last.front(), last, evidence_[last.submap]);
  tracker.SkipPointIds(tracker_->next_point_id());
  const bool is_reference = last.first_map && last.first_map->reference_frame_idx == last.frame_idx;
  const std::string what = is_reference ? "the reference of the first map" : "in which the map is seen again";
  FollowBack(&tracker, "tracked back from frame " + last.name + ", " + what);
  tracker_->SkipPointIds(tracker.next_point_id());
}

// Until the map is lost.
void FramesBefore::FollowBack(Tracker* tracker, const std::string& note) {
  for (std::size_t end = waiting_.size(); end > 0;) {
    const std::size_t begin = end - std::min(end, kChunk);
    const auto frames = Read(waiting_[begin].frame_idx, waiting_[end - 1].frame_idx, end - begin);
    if (frames.empty()) return;
    for (; end > begin; --end) {
      FrameReport& waiting = waiting_[end - 1];
      FrameReport back = std::move(tracker->Process(frames[end - 1 - begin]).front());
      if (tracker->GaveUp()) return;
      if (!back.cam_from_world) continue;
      AddTimes(waiting, &back);
      back.note = note;
      waiting = std::move(back);
    }
  }
}

// A point is new in the first frame that shows it.
void FramesBefore::MoveNewPoints(FrameReport* last) {
  std::map<PointId, NewPoint> points;
  const auto take = [&](FrameReport& report) {
    for (const NewPoint& point : report.new_points) points.emplace(point.id, point);
    report.new_points.clear();
  };
  const auto give = [&](FrameReport& report) {
    for (const PointObservation& seen : report.observations)
      if (const auto point = points.extract(seen.id)) report.new_points.push_back(point.mapped());
    report.added = static_cast<int>(report.new_points.size());
  };
  for (FrameReport& report : waiting_) take(report);
  take(*last);
  for (FrameReport& report : waiting_) give(report);
  give(*last);
  for (const auto& [id, point] : points) last->new_points.push_back(point);
  last->added = static_cast<int>(last->new_points.size());
}

void FramesBefore::Serialize(StateArchive& archive) { archive(waiting_, evidence_); }

}  // namespace pliant
