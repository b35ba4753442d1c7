// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_checkpoint.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "pliant/base/text.h"
#include "pliant/io/checkpoint.h"
#include "pliant/io/options_file.h"

namespace pliant {
namespace {

// The first line in which two texts differ, of each.
std::pair<std::string, std::string> FirstDifference(const std::string& a, const std::string& b) {
  const std::vector<std::string_view> of_a = Split(a, '\n');
  const std::vector<std::string_view> of_b = Split(b, '\n');
  const auto [in_a, in_b] = std::mismatch(of_a.begin(), of_a.end(), of_b.begin(), of_b.end());
  return {in_a == of_a.end() ? "" : std::string(*in_a), in_b == of_b.end() ? "" : std::string(*in_b)};
}

// A line each, without those that never change a result.
std::string ComparedOptions(TrackOptions options) {
  options.threads = 1;
  options.checkpoint_frames = 0;
  OptionTable table;
  options.List(table);
  std::string lines;
  for (const OptionField& field : table.fields()) lines += field.name + " " + field.get() + "\n";
  return lines;
}

}  // namespace

Result<std::optional<RunSummary>> SummaryOfEnded(const std::string& run_path, const TrackOptions& options) {
  if (HasCheckpoint(run_path)) return std::optional<RunSummary>();
  auto summary = ReadRunSummary(run_path + "/run.json");
  if (!summary.ok() || (summary->status != RunStatus::kCompleted && summary->status != RunStatus::kLost))
    return std::optional<RunSummary>();
  TrackOptions of_run;
  OptionTable table;
  of_run.List(table);
  const Status loaded = LoadOptionsFile(run_path + "/config.yaml", table);
  if (!loaded.ok() || ComparedOptions(of_run) != ComparedOptions(options))
    return Status(ErrorCode::kMismatch, "the run in " + run_path +
                                            " has come to its end with other options: there is nothing to resume; "
                                            "give another --output_path, or --overwrite to replace it");
  return std::optional(*std::move(summary));
}

RunIdentity IdentityOf(const RunRequest& request, const TrackOptions& options, const Camera& camera) {
  const SequenceRequest& input = request.input;
  RunIdentity identity;
  identity.options = ComparedOptions(options);
  for (const std::string& name : request.extensions.Names()) identity.options += name + "\n";
  if (!input.mask_path.empty())
    identity.options += "mask_path " + std::filesystem::absolute(input.mask_path).lexically_normal().string() + "\n";
  identity.frames = "--start " + std::to_string(input.start) + " --end " + std::to_string(input.end) + " --stride " +
                    std::to_string(input.stride);
  identity.camera =
      std::string(camera.model_name()) + " " + std::to_string(camera.width()) + "x" + std::to_string(camera.height());
  for (const double parameter : camera.params()) identity.camera += " " + FormatDouble(parameter);
  return identity;
}

void Serialize(StateArchive& archive, ResumePoint& point) {
  archive(point.run.options, point.run.frames, point.run.camera, point.frame_idx, point.frame_name);
}

Result<std::optional<OpenedCheckpoint>> OpenCheckpoint(const std::string& run_path) {
  if (!HasCheckpoint(run_path)) return std::optional<OpenedCheckpoint>();
  auto state = ReadCheckpoint(run_path);
  if (!state.ok()) return state.status();
  OpenedCheckpoint opened{StateArchive::Reading(*std::move(state)), {}};
  opened.archive(opened.point);
  return std::optional(std::move(opened));
}

Status CheckIdentity(const RunIdentity& of_checkpoint, const RunIdentity& wanted, const std::string& run_path) {
  const auto differs = [&](const char* what, const std::string& then, const std::string& now) {
    return Status(ErrorCode::kMismatch, "the run in " + run_path + " cannot be resumed: its " + what + " were '" +
                                            then + "', and now they are '" + now +
                                            "'; give the same again, or track it anew with --overwrite");
  };
  if (of_checkpoint.frames != wanted.frames) return differs("frames", of_checkpoint.frames, wanted.frames);
  if (of_checkpoint.camera != wanted.camera) return differs("camera's parameters", of_checkpoint.camera, wanted.camera);
  const auto [then, now] = FirstDifference(of_checkpoint.options, wanted.options);
  if (then != now) return differs("options", then, now);
  return Status::Ok();
}

// The checkpoint's own frame is read once more: there may be none after it.
Result<std::unique_ptr<Sequence>> OpenAfter(const ResumePoint& point, const SequenceRequest& input) {
  SequenceRequest rest = input;
  rest.start = point.frame_idx;
  auto sequence = OpenSequence(rest);
  if (!sequence.ok()) return sequence;
  const auto last = (*sequence)->Next();
  if (!last.ok()) return last.status();
  if (!last->has_value() || (*last)->name != point.frame_name)
    return Status(ErrorCode::kMismatch, "the run cannot be resumed: its last frame was " + Quoted(point.frame_name) +
                                            ", and frame " + std::to_string(point.frame_idx) + " of " +
                                            input.image_path.string() +
                                            " is another one now; give the same images, or track them anew with "
                                            "--overwrite");
  return sequence;
}

}  // namespace pliant
