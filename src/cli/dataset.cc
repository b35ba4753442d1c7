// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "cli/sequence_arguments.h"
#include "pliant/base/statistics.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/datasets/convert_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/image/depth_lookup.h"
#include "pliant/pipeline/sequence_statistics.h"

namespace pliant::cli {
namespace {

const Manual kInfoManual = {
    "dataset info",
    "say what a data set holds, and what is wrong with it",
    "Recognizes the kind of what lies at PATH and prints its frames, camera, pairs, depth and poses, in millimeters. "
    "Then it asks the images themselves. They are warped into each other by depth and poses, read in every way in "
    "which poses are usually meant, so that a flipped handedness, a wrong unit and a transposed matrix show and are "
    "told "
    "apart; points are matched between the images of pairs, so that pairs that are swapped or not rectified show; and "
    "depth is compared with what the baseline says. The images are also looked at by themselves: images that repeat "
    "the "
    "one before, time stamps at uneven steps, text or logos that are burned in, masks the wrong way round.\n\n"
    "Ends with 1 if something is wrong, or the data set cannot be read.",
    {"pliant dataset info seq", "pliant dataset info clip.mp4 --camera stereo.yaml"},
};

const Manual kDatasetConvertManual = {
    "dataset convert",
    "write a data set as a native sequence",
    "Reads what lies at PATH and writes images, right images, masks, depth, poses and times in Pliant's own "
    "layout: millimeters, right-handed world from camera, rectified pairs, 16-bit depth. The folder must be new or "
    "empty.",
    {"pliant dataset convert clip.mp4 --camera stereo.yaml --output_path seq --start 100 --end 400"},
};

const Manual kStatisticsManual = {
    "dataset statistics",
    "measure what the images are like for a point tracker",
    "Measures noise, corners, how long these last and how exactly they are followed, in runs of ten frames, at most "
    "thirty of them, spread over the sequence. The images are those that pliant track would track points in: resized "
    "and smoothed as measured (Image.working); with --Image.working fixed they are taken as they are, or as "
    "Image.scale "
    "and Image.smoothing_px say.\n\n"
    "Prints: the working image; the standard deviation of the noise in gray levels (from the median of a Laplacian "
    "that "
    "edges do not pass, so that correlated noise counts less); corners in a frame; the share of them that are tracked "
    "into the next frame and through the next nine; and the standard deviation of a track's coordinate in pixels (from "
    "the second difference in time of each track, against that of its twelve nearest neighbors). "
    "pliant/tracking/tracks/image_statistics.h has the formulas.",
    {"pliant dataset statistics clip.mp4", "pliant dataset statistics seq --Image.working fixed --Image.scale 0.5"},
};

void PrintLine(const std::string& name, const std::string& text) {
  SayResult(name + std::string(std::max<std::size_t>(1, 10 - name.size()), ' ') + text);
}

std::string DepthText(const Sequence& sequence, int frame_idx) {
  const auto depth_mm = sequence.Depth(frame_idx);
  if (!depth_mm.ok()) return depth_mm.status().message();
  if (!depth_mm->has_value()) return "none";
  const std::vector<double> depths = KnownDepths(**depth_mm);
  if (depths.empty()) return "none in the first frame";
  const auto [low, high] = std::minmax_element(depths.begin(), depths.end());
  return Formatted("%.1f to %.1f mm in the first frame, ", *low, *high) +
         Formatted("%.1f mm in the median", Median(depths));
}

std::string PosesText(const Sequence& sequence, const SequenceRequest& request) {
  int poses = 0;
  double path_mm = 0;
  std::optional<Rigid3> last;
  for (int k = 0; k < sequence.size(); ++k) {
    const auto pose = sequence.WorldFromCamera(request.start + k * request.stride);
    if (!pose) continue;
    if (last) path_mm += (pose->translation - last->translation).norm();
    last = pose;
    ++poses;
  }
  if (poses == 0) return "none";
  return Formatted("%d of %d, a path of %.1f mm", poses, sequence.size(), path_mm);
}

void PrintDescription(const Sequence& sequence, const SequenceRequest& request) {
  const Camera& camera = sequence.camera();
  const auto kind = RecognizeDataSet(request.image_path);
  PrintLine("kind", std::string(kind->name) + ": " + std::string(kind->what));
  std::string frames = std::to_string(sequence.size());
  const auto first = sequence.TimestampS(request.start);
  const auto second = sequence.TimestampS(request.start + request.stride);
  if (first && second && *second > *first) frames += Formatted(", %.3g a second", 1.0 / (*second - *first));
  PrintLine("frames", frames);
  PrintLine("camera", std::string(camera.model_name()) + Formatted(" %dx%d, focal length %.1f px", camera.width(),
                                                                   camera.height(), camera.MeanFocalLengthPx()));
  PrintLine("pairs", sequence.BaselineMm() ? Formatted("rectified, baseline %.4g mm", *sequence.BaselineMm()) : "none");
  if (const auto light = sequence.Photometric())
    PrintLine("light", Formatted("gamma %.3g, vignetting %.3g, spread %.3g", light->gamma, light->vignetting,
                                 light->light_spread));
  PrintLine("depth", DepthText(sequence, request.start));
  PrintLine("poses", PosesText(sequence, request));
  for (const std::string& warning : sequence.Warnings()) PrintLine("warning", warning);
}

void PrintImageCheck(const ImageCheck& check) {
  std::string what = std::to_string(check.images) + " images: repetitions";
  if (check.steps > 0) what += ", times";
  if (check.has_masks) what += ", masks";
  if (check.tells_overlays) what += ", overlays";
  PrintLine("checked", what);
  if (!check.tells_overlays && !check.masks_are_inverted)
    PrintLine("unchecked", "overlays: that takes 20 images, between which most of the view changes");
}

void PrintCheck(const SequenceCheck& check, bool has_pairs) {
  if (check.poses) {
    const PoseCheck& poses = *check.poses;
    std::string text = Formatted("%d pairs of images, warped by depth and poses, agree to %.2f", poses.pairs,
                                 poses.as_given.correlation);
    PrintLine(poses.right ? "checked" : "unchecked",
              poses.right ? text : text + ", which says nothing about the poses: too little motion or structure");
  } else {
    PrintLine("unchecked", "poses: no frame has both pose and depth, which warping images needs");
  }
  if (check.stereo)
    PrintLine(check.stereo->enough ? "checked" : "unchecked",
              Formatted("%d points in pairs, rows differ by %.2f px in the median", check.stereo->matches,
                        check.stereo->median_row_error_px));
  else if (has_pairs)
    PrintLine("unchecked", "pairs: no point of the left image is found in the right one");
  if (check.stereo && check.stereo->depth_ratio)
    PrintLine(check.stereo->enough ? "checked" : "unchecked",
              Formatted("depth is %.3f of what the baseline says", *check.stereo->depth_ratio));
  if (check.images) PrintImageCheck(*check.images);
  for (const std::string& wrong : check.wrong) PrintLine("wrong", wrong);
  const bool checked = (check.poses && check.poses->right) || (check.stereo && check.stereo->enough);
  if (check.wrong.empty())
    SayResult(checked ? "nothing is wrong with what was checked"
                      : "nothing is wrong with the images; of their truth nothing could be checked: that takes pairs "
                        "of images, or poses and depth");
}

int InfoCommand(std::span<const std::string> args) {
  SequenceArguments arguments;
  CommandLine line(kInfoManual);
  arguments.AddTo(&line);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable no_options;
  if (const auto exit = line.Resolve(no_options)) return *exit;
  if (const auto exit = arguments.Check(line)) return *exit;

  const SequenceRequest request = arguments.Request();
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return line.Failure(sequence.status().message());
  PrintDescription(**sequence, request);
  const auto check =
      WithBars(StopOnSignals(), [&](const JobProgress& progress) { return CheckSequence(**sequence, {}, progress); });
  if (!check.ok()) return line.Failure(check.status().message());
  PrintCheck(*check, (*sequence)->BaselineMm().has_value());
  return check->wrong.empty() ? kExitOk : kExitFailed;
}

int ConvertCommand(std::span<const std::string> args) {
  SequenceArguments arguments;
  std::string output_path;
  CommandLine line(kDatasetConvertManual);
  arguments.AddTo(&line);
  line.Add("output_path", &output_path, "DIR", "folder of the new sequence", Need::kRequired);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable no_options;
  if (const auto exit = line.Resolve(no_options)) return *exit;
  if (const auto exit = arguments.Check(line)) return *exit;

  const SequenceRequest request = arguments.Request();
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return line.Failure(sequence.status().message());
  const std::atomic<bool>& stop = StopOnSignals();
  Progress progress("convert", (*sequence)->size());
  const auto summary = ConvertSequence(
      **sequence, output_path,
      [&](int done) {
        progress.Update(done, "");
        return !stop;
      },
      request.stride);
  if (!summary.ok()) return line.Failure(summary.status().message());
  for (const std::string& warning : (*sequence)->Warnings()) SayWarning(warning);
  if (summary->clipped_depths > 0)
    SayWarning(std::to_string(summary->clipped_depths) + " pixels are too far away for 16 bits and have no depth");
  SayResult(Formatted("%d frames, %d pairs, %d masks, %d depth images, %d poses in ", summary->frames, summary->right,
                      summary->masks, summary->depths, summary->poses) +
            output_path);
  return kExitOk;
}

void ListStatisticsOptions(TrackOptions* options, OptionTable* table) {
  options->image.List(*table);
  options->tracker.corners.List(*table);
  options->tracker.masks.List(*table);
  options->tracker.point_tracker.List(*table);
}

void PrintStatistics(const SequenceStatistics& measured) {
  const ImageStatistics& images = measured.images;
  PrintLine("image", Formatted("%dx%d, scale %.3g, smoothing %.2g px%s", measured.size.width, measured.size.height,
                               measured.working_image.scale, measured.working_image.smoothing_px,
                               measured.working_image.interlaced ? ", interlaced" : ""));
  PrintLine("frames", std::to_string(images.frames));
  PrintLine("noise", Formatted("%.2f gray levels", images.noise_levels));
  PrintLine("corners", Formatted("%.0f in a frame", images.corners));
  PrintLine("alive", Formatted("%.3f after 1 frame, %.3f after 9", images.alive_after_1, images.alive_after_9));
  PrintLine("tracks", Formatted("%.3f px noise", images.track_noise_px));
}

int StatisticsCommand(std::span<const std::string> args) {
  SequenceArguments arguments;
  CommandLine line(kStatisticsManual);
  arguments.AddTo(&line);
  if (const auto exit = line.Parse(args)) return *exit;
  TrackOptions options;
  OptionTable table;
  ListStatisticsOptions(&options, &table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (const auto exit = arguments.Check(line)) return *exit;
  const auto measured = WithBars(StopOnSignals(), [&](const JobProgress& progress) {
    return MeasureSequenceStatistics(arguments.Request(), options, progress);
  });
  if (!measured.ok()) return line.Failure(measured.status().message());
  PrintStatistics(*measured);
  return kExitOk;
}

}  // namespace

int DatasetCommand(std::span<const std::string> args) {
  constexpr Verb kVerbs[] = {{"info", "PATH", InfoCommand},
                             {"statistics", "PATH", StatisticsCommand},
                             {"convert", "PATH --output_path DIR", ConvertCommand}};
  return RunVerb("dataset", kVerbs, args);
}

}  // namespace pliant::cli
