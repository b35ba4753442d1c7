// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_checkpoint.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <zlib.h>

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

std::string TextOf(const FrameSelection& range) {
  return "--start " + std::to_string(range.start) + " --end " + std::to_string(range.end) + " --stride " +
         std::to_string(range.stride);
}

bool IsSamePlace(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code error;
  return std::filesystem::equivalent(a, b, error) ||
         std::filesystem::absolute(a).lexically_normal() == std::filesystem::absolute(b).lexically_normal();
}

// Of what may be left out.
bool IsSameGiven(const std::string& a, const std::filesystem::path& b) {
  return a.empty() || b.empty() ? a.empty() && b.empty() : IsSamePlace(a, b);
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

FrameSelection SelectionOf(const SequenceRequest& input) { return {input.start, input.end, input.stride}; }

std::uint32_t ChecksumOf(const cv::Mat& image) {
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  auto checksum = crc32_z(0, nullptr, 0);
  for (int y = 0; y < image.rows; ++y) checksum = crc32_z(checksum, image.ptr(y), row_bytes);
  return static_cast<std::uint32_t>(checksum);
}

Result<std::optional<RunSummary>> SummaryOfEnded(const RunRequest& request, const TrackOptions& options) {
  const std::string& run_path = request.output_path;
  auto summary = EndedRun(run_path);
  if (!summary) return summary;
  TrackOptions of_run;
  OptionTable table;
  of_run.List(table);
  const auto other = [&](const std::string& what) {
    return Status(ErrorCode::kMismatch, "the run in " + run_path + " has come to its end with other " + what +
                                            ": there is nothing to resume; give another --output_path, or "
                                            "--overwrite to replace it");
  };
  const Status loaded = LoadOptionsFile(run_path + "/config.yaml", table);
  if (!loaded.ok() || ComparedOptions(of_run) != ComparedOptions(options)) return other("options");
  if (!IsSamePlace(summary->description.input, request.input.image_path))
    return other("images, " + Quoted(summary->description.input));
  if (!IsSameGiven(summary->description.camera, request.input.camera_path))
    return other("calibration, " + Quoted(summary->description.camera));
  if (!IsSameGiven(summary->description.mask, request.input.mask_path))
    return other("masks, " + Quoted(summary->description.mask));
  if (summary->description.range != SelectionOf(request.input))
    return other("frames, " + TextOf(summary->description.range));
  return summary;
}

RunIdentity IdentityOf(const RunRequest& request, const TrackOptions& options, const Sequence& sequence) {
  const SequenceRequest& input = request.input;
  RunIdentity identity;
  identity.options = ComparedOptions(options);
  for (const std::string& name : request.extensions.Names()) identity.options += name + "\n";
  if (!input.mask_path.empty())
    identity.options += "mask_path " + std::filesystem::absolute(input.mask_path).lexically_normal().string() + "\n";
  identity.frames = TextOf(SelectionOf(input));
  const Camera& camera = sequence.camera();
  identity.camera =
      std::string(camera.model_name()) + " " + std::to_string(camera.width()) + "x" + std::to_string(camera.height());
  std::vector<double> parameters(camera.params().begin(), camera.params().end());
  if (const auto light = sequence.Photometric()) {
    parameters.insert(parameters.end(), {light->gamma, light->vignetting, light->light_spread});
    parameters.insert(parameters.end(), light->light_axis.begin(), light->light_axis.end());
  }
  for (const double parameter : parameters) identity.camera += " " + FormatDouble(parameter);
  return identity;
}

void Serialize(StateArchive& archive, ResumePoint& point) {
  archive(point.run.options, point.run.frames, point.run.camera, point.frame_idx, point.frame_name,
          point.image_checksum);
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
  if (!last->has_value() || (*last)->name != point.frame_name || ChecksumOf((*last)->image) != point.image_checksum)
    return Status(ErrorCode::kMismatch, "the run cannot be resumed: its last frame was " + Quoted(point.frame_name) +
                                            ", and frame " + std::to_string(point.frame_idx) + " of " +
                                            input.image_path.string() +
                                            " is another one now; give the same images, or track them anew with "
                                            "--overwrite");
  return sequence;
}

}  // namespace pliant
