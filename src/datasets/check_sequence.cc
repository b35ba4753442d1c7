// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/check_sequence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "datasets/check_poses.h"
#include "datasets/check_stereo.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

// From a base frame to those that are compared with it: near ones overlap in any case, far ones tell readings apart.
constexpr int kGaps[] = {1, 4, 12};
constexpr double kMaxRowError_px = 1.0;
constexpr int kMinMatches = 20;          // fewer say nothing
constexpr double kMaxDepthError = 0.25;  // of the ratio
// Readings that fit less than this do not fit; one that fits by this much less than the best one is wrong.
constexpr double kMinCorrelation = 0.25;
constexpr double kClearlyLess = 0.8;

std::vector<int> BaseFrames(int frames, int count) {
  std::vector<int> bases;
  const int last = std::max(0, frames - 1 - kGaps[std::size(kGaps) - 1]);
  const int most = std::min(count, last + 1);
  for (int k = 0; k < most; ++k) bases.push_back(most == 1 ? 0 : k * last / (most - 1));
  return bases;
}

std::string Described(const PoseReading& reading) {
  std::string text = reading.name;
  if (reading.scale != 1.0)
    text += (text.empty() ? "" : ", and ") + ("lengths are " + FormatNumber("%g", reading.scale)) + " times as long";
  return text;
}

PoseCheck JudgePoses(const std::vector<PoseReading>& readings, std::size_t pairs) {
  PoseCheck poses;
  poses.pairs = static_cast<int>(pairs);
  poses.as_given = readings.front();
  poses.best = *std::max_element(readings.begin(), readings.end(), [](const PoseReading& a, const PoseReading& b) {
    return a.correlation < b.correlation;
  });
  const auto worse = std::count_if(readings.begin(), readings.end(), [&](const PoseReading& reading) {
    return reading.correlation < kClearlyLess * poses.best.correlation;
  });
  const bool tells = poses.best.correlation >= kMinCorrelation && 2 * worse > static_cast<long>(readings.size());
  if (tells) poses.right = poses.as_given.correlation >= kClearlyLess * poses.best.correlation;
  return poses;
}

bool Differs(double ratio) { return std::abs(std::log(ratio)) > std::log1p(kMaxDepthError); }

// Whether poses and baseline say of the depth images that they are so many times too large; nothing where they do not
// agree on it.
std::optional<double> DepthIsTooLarge(const SequenceCheck& check) {
  if (!check.poses || check.poses->right != false || !check.poses->best.name.empty()) return std::nullopt;
  if (!check.stereo || !check.stereo->enough || !check.stereo->depth_ratio) return std::nullopt;
  const double by_baseline = *check.stereo->depth_ratio;
  if (!Differs(by_baseline) || Differs(by_baseline / check.poses->best.scale)) return std::nullopt;
  return check.poses->best.scale;
}

std::vector<std::string> WhatIsWrong(const SequenceCheck& check) {
  std::vector<std::string> wrong;
  const auto depth_factor = DepthIsTooLarge(check);
  if (depth_factor)
    wrong.push_back("the depth images say " + FormatNumber("%g", *depth_factor) +
                    " times what poses and baseline agree on; give depth in millimeters");
  if (check.poses && check.poses->right == false && !depth_factor)
    wrong.push_back("the poses do not fit the depth: the images agree to " +
                    FormatNumber("%.2f", check.poses->as_given.correlation) + " as they are, and to " +
                    FormatNumber("%.2f", check.poses->best.correlation) + " if " + Described(check.poses->best) +
                    "; write the poses as right-handed ones of world from camera, in millimeters");
  if (!check.stereo || !check.stereo->enough) return wrong;
  const StereoCheck& stereo = *check.stereo;
  if (stereo.share_right_way < 0.5)
    wrong.push_back("left and right are swapped: of " + std::to_string(stereo.matches) + " points " +
                    FormatNumber("%.0f", 100.0 * (1.0 - stereo.share_right_way)) +
                    " % lie farther right in the right image; exchange the images");
  if (stereo.median_row_error_px > kMaxRowError_px)
    wrong.push_back("the pairs are not rectified: the rows of " + std::to_string(stereo.matches) +
                    " points differ by " + FormatNumber("%.1f", stereo.median_row_error_px) +
                    " px in the median; give the calibration of these cameras");
  if (stereo.depth_ratio && Differs(*stereo.depth_ratio) && !depth_factor)
    wrong.push_back("depth and baseline disagree: the depth images say " + FormatNumber("%.3g", *stereo.depth_ratio) +
                    " times what disparity and baseline say; give both in millimeters");
  return wrong;
}

}  // namespace

Result<SequenceCheck> CheckSequence(Sequence& sequence, const CheckOptions& options, const JobProgress& progress) {
  const std::vector<int> bases = BaseFrames(sequence.size(), options.base_frames);
  std::map<int, std::set<int>> compared;  // base, and the frames that are compared with it, by position in the sequence
  std::set<int> wanted;
  for (const int base : bases)
    for (const int gap : kGaps)
      if (options.poses && base + gap < sequence.size()) {
        compared[base].insert(base + gap);
        wanted.insert({base, base + gap});
      }
  SequenceCheck check;
  std::map<int, PosedImage> images;
  StereoChecker stereo;
  const int last = wanted.empty() ? (bases.empty() ? -1 : bases.back()) : *wanted.rbegin();
  ImageChecker checker;
  for (int position = 0; options.images || position <= last; ++position) {
    if (Status status = Tell(progress, "check", position, sequence.size()); !status.ok()) return status;
    auto frame = sequence.Next();
    if (!frame.ok()) return frame.status();
    if (!frame->has_value()) break;
    if (options.images) checker.Add(**frame);
    const bool is_base = std::find(bases.begin(), bases.end(), position) != bases.end();
    if (!is_base && !wanted.contains(position)) continue;
    const auto depth = sequence.Depth((*frame)->frame_idx);
    if (!depth.ok()) return depth.status();
    if (is_base && sequence.BaselineMm()) {
      const auto right = sequence.Right();
      if (!right.ok()) return right.status();
      if (right->has_value())
        stereo.Add((*frame)->image, **right, depth->value_or(cv::Mat()), sequence.camera(), *sequence.BaselineMm());
    }
    const auto pose = sequence.WorldFromCamera((*frame)->frame_idx);
    if (options.poses && pose && depth->has_value())
      images.emplace(position, PosedImage{FineStructure((*frame)->image), **depth, *pose});
  }
  std::vector<std::pair<const PosedImage*, const PosedImage*>> pairs;
  for (const auto& [base, others] : compared)
    for (const int other : others)
      if (images.contains(base) && images.contains(other)) pairs.emplace_back(&images.at(base), &images.at(other));
  if (!pairs.empty())
    check.poses = JudgePoses(CorrelateReadings(pairs, sequence.camera(), options.max_points), pairs.size());
  if (stereo.count() > 0) {
    check.stereo = stereo.Check();
    check.stereo->enough = check.stereo->matches >= kMinMatches;
  }
  check.wrong = WhatIsWrong(check);
  if (options.images) {
    check.images = checker.Check();
    check.wrong.insert(check.wrong.end(), check.images->wrong.begin(), check.images->wrong.end());
  }
  return check;
}

}  // namespace pliant
