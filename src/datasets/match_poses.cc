// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/match_poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/text.h"
#include "pliant/datasets/frame_checks.h"

namespace pliant {
namespace {

struct TimeUnit {
  const char* name;
  double seconds;
};

constexpr std::array<TimeUnit, 4> kTimeUnits{
    {{"seconds", 1.0}, {"milliseconds", 1e-3}, {"microseconds", 1e-6}, {"nanoseconds", 1e-9}}};

// Of the poses, or of the frames: a clock that is not the sequence's matches less, by chance.
constexpr double kMinMatchedShare = 0.1;
// Concentration of poses that belong to frames. Their times may be off by a constant, by a jitter whose standard
// deviation is 0.19 of the frames' step, or by a drift of 0.6 of it, which no tolerance below 0.4 takes for the next.
constexpr double kMinConcentration = 0.5;
constexpr int kMinJudgedPoses = 5;  // fewer are concentrated by chance

using FrameAtTime = std::map<double, int>;  // seconds of the sequence's clock

struct NearestPose {
  double difference_s = 0;
  const TimedPose* pose = nullptr;
};

// There is one.
FrameAtTime::const_iterator NearestFrame(const FrameAtTime& frame_at, double time_s) {
  const auto after = frame_at.lower_bound(time_s);
  const bool before_is_nearer = after == frame_at.end() ||
                                (after != frame_at.begin() && time_s - std::prev(after)->first < after->first - time_s);
  return before_is_nearer ? std::prev(after) : after;
}

// How many of the poses have a frame near them.
std::size_t NumNear(std::span<const TimedPose> poses, const FrameAtTime& frame_at, double unit_s,
                    double max_difference_s) {
  return static_cast<std::size_t>(std::ranges::count_if(poses, [&](const TimedPose& pose) {
    const double time_s = unit_s * pose.timestamp_s;
    const auto at = frame_at.lower_bound(time_s - max_difference_s);
    return at != frame_at.end() && at->first <= time_s + max_difference_s;
  }));
}

// By frame number.
std::map<int, NearestPose> NearestPoses(std::span<const TimedPose> poses, const FrameAtTime& frame_at, double unit_s,
                                        double max_difference_s) {
  std::map<int, NearestPose> nearest;
  for (const TimedPose& pose : poses) {
    const double time_s = unit_s * pose.timestamp_s;
    const auto frame = NearestFrame(frame_at, time_s);
    const double difference_s = std::abs(frame->first - time_s);
    if (difference_s > max_difference_s) continue;
    const auto [it, is_new] = nearest.try_emplace(frame->second, NearestPose{difference_s, &pose});
    if (!is_new && difference_s < it->second.difference_s) it->second = {difference_s, &pose};
  }
  return nearest;
}

std::string HowMany(std::size_t matched, std::size_t poses, const std::string& name) {
  if (matched == 0) return "no pose of " + name + " is";
  return "only " + std::to_string(matched) + " of the " + std::to_string(poses) + " poses of " + name +
         (matched == 1 ? " is" : " are");
}

std::string Span(double first_s, double last_s) { return Seconds(first_s) + " to " + Seconds(last_s); }

std::vector<double> TimesOf(std::span<const TimedPose> poses, double unit_s) {
  std::vector<double> times_s;
  for (const TimedPose& pose : poses) times_s.push_back(unit_s * pose.timestamp_s);
  return times_s;
}

// ", as nanoseconds would" where no camera is that slow.
std::string UnitHint(std::span<const TimedPose> poses) {
  const std::string_view unit = UnitOfSteps(TimesOf(poses, 1));
  return unit.empty() ? "" : ", as " + std::string(unit) + " would";
}

// Mean resultant length (Mardia and Jupp, Directional Statistics, 2.3) of where the poses lie between two frames, as
// angles: 1 where all are equally far from a frame, near 0 where they are spread evenly. Only poses between the first
// frame and the last count; of a few it is 1.
double Concentration(std::span<const double> times_s, const FrameAtTime& frame_at, double frame_step_s) {
  std::complex<double> sum;
  int judged = 0;
  for (const double time_s : times_s) {
    if (time_s < frame_at.begin()->first - frame_step_s / 2 || time_s > frame_at.rbegin()->first + frame_step_s / 2)
      continue;
    const double from_frame_s = time_s - NearestFrame(frame_at, time_s)->first;
    sum += std::polar(1.0, 2 * std::numbers::pi * from_frame_s / frame_step_s);
    ++judged;
  }
  return judged < kMinJudgedPoses ? 1.0 : std::abs(sum) / judged;
}

// Poses that were computed from the frames have their times. Another device may give poses at any times, but then it
// gives more than there are frames, so that each frame has one near it. What is neither has a wrong rate.
Status CheckRate(std::span<const TimedPose> poses, const FrameAtTime& frame_at, const TimeUnit& unit,
                 const std::string& name) {
  const std::vector<double> times_s = TimesOf(poses, unit.seconds);
  std::vector<double> frame_times_s;
  for (const auto& [time_s, frame_idx] : frame_at) frame_times_s.push_back(time_s);
  const double step_s = MedianStep(times_s);
  const double frame_step_s = MedianStep(frame_times_s);
  const bool is_denser = poses.size() > frame_at.size() && step_s < frame_step_s;
  if (is_denser || Concentration(times_s, frame_at, frame_step_s) >= kMinConcentration) return Status::Ok();
  const std::string read_as = unit.seconds == 1.0 ? "" : ", read as " + std::string(unit.name) + ",";
  return {ErrorCode::kMismatch, "the poses of " + name + read_as + " come " + Digits(1 / step_s, 2) +
                                    " times a second and the frames " + Digits(1 / frame_step_s, 2) +
                                    " times, and most poses lie between two frames: give each pose the time of its "
                                    "frame, and leave out poses between frames"};
}

}  // namespace

Result<MatchedPoses> MatchPoses(std::span<const TimedPose> poses, const Sequence& sequence, double max_difference_s,
                                const std::string& name) {
  FrameAtTime frame_at;
  for (int i = 0; i < sequence.size(); ++i)
    if (const auto time_s = sequence.TimestampS(i)) frame_at.emplace(*time_s, i);
  if (frame_at.empty())
    return Status(ErrorCode::kMismatch,
                  "the sequence has no times to which the poses of " + name + " could be matched");
  std::map<int, NearestPose> nearest;
  const TimeUnit* unit = kTimeUnits.data();
  for (const TimeUnit& candidate : kTimeUnits) {
    auto found = NearestPoses(poses, frame_at, candidate.seconds, max_difference_s);
    if (found.size() <= nearest.size()) continue;
    nearest = std::move(found);
    unit = &candidate;
  }
  const std::size_t near = NumNear(poses, frame_at, unit->seconds, max_difference_s);
  const double share = std::max(static_cast<double>(near) / static_cast<double>(std::max<std::size_t>(1, poses.size())),
                                static_cast<double>(nearest.size()) / static_cast<double>(frame_at.size()));
  const bool is_several = poses.size() > 1 && frame_at.size() > 1;
  const bool by_chance = is_several && (nearest.size() == 1 || share < kMinMatchedShare);
  if ((nearest.empty() && !poses.empty()) || by_chance)
    return Status(ErrorCode::kMismatch, HowMany(std::min(near, nearest.size()), poses.size(), name) + " within " +
                                            Seconds(max_difference_s) + " of a frame: its times go from " +
                                            Span(poses.front().timestamp_s, poses.back().timestamp_s) +
                                            UnitHint(poses) + ", the sequence's from " +
                                            Span(frame_at.begin()->first, frame_at.rbegin()->first) +
                                            "; write times in seconds of the sequence's clock");
  if (is_several)
    if (Status status = CheckRate(poses, frame_at, *unit, name); !status.ok()) return status;
  MatchedPoses matched;
  for (const auto& [frame_idx, match] : nearest) matched.world_from_cam.emplace(frame_idx, match.pose->world_from_cam);
  if (unit->seconds != 1.0) matched.notes.push_back("the times of " + name + " are read as " + unit->name);
  if (const auto left_out = poses.size() - nearest.size(); left_out > 0)
    matched.notes.push_back(std::to_string(left_out) + " of " + std::to_string(poses.size()) + " poses of " + name +
                            " are not near any frame in time and are left out");
  return matched;
}

}  // namespace pliant
