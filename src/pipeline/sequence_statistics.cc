// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/sequence_statistics.h"

#include <algorithm>
#include <string>
#include <vector>

#include "pipeline/choose_working_image.h"
#include "pipeline/working_frame.h"

namespace pliant {
namespace {

constexpr int kMaxRuns = 30;
// Of the first images, for a run that begins.
constexpr int kFirstRuns = 3;
constexpr int kFirstDistance = 60;

// Runs of images that follow each other, each `distance` after the one before; at most `max_runs`.
Result<std::vector<RunMeasurement>> MeasureRuns(Sequence& sequence, const WorkingImage& working, int distance,
                                                int max_runs, const TrackOptions& options, cv::Size* size) {
  std::vector<RunMeasurement> runs;
  std::vector<PreparedFrame> run;
  for (int read = 0; std::ssize(runs) < max_runs; ++read) {
    const auto next = sequence.Next();
    if (!next.ok()) return next.status();
    if (!next->has_value()) break;
    if (read % distance >= kStatisticsRunFrames) continue;
    run.push_back(PrepareWorkingFrame(**next, working, options.tracker));
    if (std::ssize(run) < kStatisticsRunFrames) continue;
    *size = run.front().gray.size();
    runs.push_back(MeasureRun(run, options.tracker, options.threads));
    run.clear();
  }
  return runs;
}

}  // namespace

Result<SequenceStatistics> MeasureSequenceStatistics(const SequenceRequest& request, const TrackOptions& options) {
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  SequenceStatistics measured{.working_image = ChooseWorkingImage(request, options), .size = {}, .images = {}};
  const int frames = (*sequence)->size();
  const int distance = std::max(kStatisticsRunFrames, (frames + kMaxRuns - 1) / kMaxRuns);
  const auto runs = MeasureRuns(**sequence, measured.working_image, distance, kMaxRuns, options, &measured.size);
  if (!runs.ok()) return runs.status();
  if (runs->empty())
    return {ErrorCode::kInsufficient, "the sequence has " + std::to_string(frames) + " frames; statistics need " +
                                          std::to_string(kStatisticsRunFrames) + " that follow each other"};
  measured.images = Summarize(*runs);
  return measured;
}

ImageStatistics MeasureFirstImages(const SequenceRequest& request, const WorkingImage& working,
                                   const TrackOptions& options) {
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return {};
  cv::Size size;
  const auto runs = MeasureRuns(**sequence, working, kFirstDistance, kFirstRuns, options, &size);
  return runs.ok() && !runs->empty() ? Summarize(*runs) : ImageStatistics();
}

}  // namespace pliant
