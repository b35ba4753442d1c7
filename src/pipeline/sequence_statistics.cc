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

}  // namespace

Result<SequenceStatistics> MeasureSequenceStatistics(const SequenceRequest& request, const TrackOptions& options,
                                                     const JobProgress& progress) {
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  SequenceStatistics measured{
      .working_image = ChooseWorkingImage(ReadFirstRuns(request), options), .size = {}, .images = {}};
  const TrackerOptions tracker = WorkingOptions(options.tracker, measured.working_image);
  const int frames = (*sequence)->size();
  // Runs of images that follow each other, each `distance` after the one before.
  const int distance = std::max(kStatisticsRunFrames, (frames + kMaxRuns - 1) / kMaxRuns);
  std::vector<RunMeasurement> runs;
  std::vector<PreparedFrame> run;
  for (int read = 0; std::ssize(runs) < kMaxRuns; ++read) {
    if (Status status = Tell(progress, "statistics", read, frames); !status.ok()) return status;
    const auto next = (*sequence)->Next();
    if (!next.ok()) return next.status();
    if (!next->has_value()) break;
    if (read % distance >= kStatisticsRunFrames) continue;
    run.push_back(PrepareWorkingFrame(**next, measured.working_image, tracker));
    if (std::ssize(run) < kStatisticsRunFrames) continue;
    measured.size = run.front().gray.size();
    runs.push_back(MeasureRun(run, tracker, options.threads));
    run.clear();
  }
  if (runs.empty())
    return {ErrorCode::kInsufficient, "the sequence has " + std::to_string(frames) + " frames; statistics need " +
                                          std::to_string(kStatisticsRunFrames) + " that follow each other"};
  measured.images = Summarize(runs);
  return measured;
}

}  // namespace pliant
