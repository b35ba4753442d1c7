// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/view.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/evaluation/evaluate_run.h"
#include "viewer/add_truth.h"
#include "viewer/align_runs.h"
#include "viewer/read_run.h"
#include "viewer/run_figures.h"
#include "viewer/view_mesh.h"

namespace pliant {
namespace {

// The sequence of the request, or the one that the first run names if it can be opened.
Result<std::optional<OpenedTruth>> OpenItsSequence(const ViewRequest& request, View* view) {
  SequenceRequest sequence = SequenceOfRun(request.run_paths.front(), request.sequence_path, request.camera_path);
  if (request.run_paths.size() > 1) sequence = sequence.Whole();  // the others may be of other frames
  const bool named = !request.sequence_path.empty();
  if (sequence.image_path.empty()) {
    view->notes.emplace_back("the run does not say which images it is of; name them with --sequence to see them");
    return std::optional<OpenedTruth>();
  }
  EvaluationOptions options;
  if (!request.figures) options.parts = {EvaluationPart::kSurface};
  auto opened = OpenTruth(sequence, options);
  if (opened.ok()) return std::optional(*std::move(opened));
  if (named) return opened.status();
  view->notes.push_back("the images cannot be shown: " + opened.status().message() +
                        "; name where they are now with --sequence, and their calibration with --camera");
  return std::optional<OpenedTruth>();
}

std::vector<int> SubmapsOf(const ViewedRun& run) {
  std::set<int> submaps;
  for (const ViewedFrame& frame : run.frames)
    if (frame.world_from_cam) submaps.insert(frame.row.submap);
  return {submaps.begin(), submaps.end()};
}

std::optional<double> MedianScale(const ViewedRun& run, int submap) {
  std::vector<double> scales;
  for (std::size_t i = 0; i < run.scales.size(); ++i)
    if (run.scales[i] && run.frames[i].row.submap == submap) scales.push_back(*run.scales[i]);
  if (scales.empty()) return std::nullopt;
  return Median(std::move(scales));
}

FramePoses TruePoses(const Sequence& sequence, const std::vector<ViewedRun>& runs) {
  FramePoses poses;
  for (const ViewedRun& run : runs)
    for (const ViewedFrame& frame : run.frames)
      if (const auto pose = sequence.WorldFromCamera(frame.row.frame_idx)) poses.emplace(frame.row.frame_idx, *pose);
  return poses;
}

// A submap without a frame in common goes on where the one before it ended, with depths as they were there.
Sim3 AfterTheOneBefore(const FramePoses& before, double depth_before, const FramePoses& poses, double depth) {
  return WorldFromPoses(before.rbegin()->second.Inverse(), poses.begin()->second.Inverse(), depth_before / depth);
}

// Runs of one name are told apart by what their paths do not have in common.
void TakeNames(const std::vector<std::string>& run_paths, View* view) {
  std::map<std::string, int> uses;
  for (const ViewedRun& run : view->runs) ++uses[run.name];
  if (uses.size() == view->runs.size()) return;
  std::vector<std::vector<std::string>> parts;
  std::size_t shortest = std::numeric_limits<std::size_t>::max();
  for (const std::string& path : run_paths) {
    auto& folders = parts.emplace_back();
    for (const auto& folder : std::filesystem::path(path).lexically_normal()) folders.push_back(folder.string());
    shortest = std::min(shortest, folders.size());
  }
  const auto same = [&](const auto& part) {
    return std::all_of(parts.begin(), parts.end(),
                       [&](const auto& folders) { return part(folders) == part(parts[0]); });
  };
  std::size_t first = 0;
  while (first < shortest && same([&](const auto& folders) { return folders[first]; })) ++first;
  std::size_t last = 0;
  while (first + last < shortest && same([&](const auto& folders) { return folders[folders.size() - 1 - last]; }))
    ++last;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::filesystem::path name;
    for (std::size_t k = first; k + last < parts[i].size(); ++k) name /= parts[i][k];
    view->runs[i].name = name.empty() ? run_paths[i] : name.string();
  }
}

// The runs that tell the scale first.
std::vector<ViewedRun*> InOrderOfScale(View* view) {
  std::vector<ViewedRun*> runs;
  for (ViewedRun& run : view->runs) runs.push_back(&run);
  std::stable_partition(runs.begin(), runs.end(), [](const ViewedRun* run) { return run->in_millimeters; });
  return runs;
}

// Everything into one world: the truth's, else that of the first submap of the first run, or of the first one that is
// in millimeters.
void Align(const FramePoses& truth, View* view) {
  FramePoses reference = truth;  // and whatever has been placed beside it
  FrameDepths reference_depths;
  bool placed_after = false;
  for (ViewedRun* const run : InOrderOfScale(view)) {
    FramePoses before;
    double depth_before = 1;
    for (const int submap : SubmapsOf(*run)) {
      const FramePoses poses = PosesOf(*run, submap);
      const FrameDepths depths = DepthsOf(*run, submap);
      std::optional<double> scale = MedianScale(*run, submap);
      if (!scale) scale = DepthRatio(depths, reference_depths);
      std::optional<Sim3> world = reference.empty() ? Sim3() : AlignWorlds(poses, reference, scale, MedianOf(depths));
      if (!world && !before.empty()) {
        world = AfterTheOneBefore(before, depth_before, poses, MedianOf(depths));
        placed_after = true;
      }
      if (world)
        Move(*world, submap, run);
      else
        view->notes.push_back("the run " + run->name + " has no frame in common with " +
                              (truth.empty() ? "the first one" : "the truth") + "; it is shown in a world of its own");
      before = PosesOf(*run, submap);
      const FrameDepths placed_depths = DepthsOf(*run, submap);
      depth_before = MedianOf(placed_depths);
      if (!world) continue;
      reference.insert(before.begin(), before.end());
      reference_depths.insert(placed_depths.begin(), placed_depths.end());
    }
  }
  if (placed_after)
    view->notes.emplace_back(
        "maps that were not merged are shown one after the other: each begins where the one before it ended");
}

// Of a run that was killed while its images arrived, the last ones may not have been recorded.
void DropUnrecorded(const Sequence& recording, ViewedRun* run, std::vector<std::string>* notes) {
  const auto is_recorded = [&](const ViewedFrame& frame) {
    return recording.TimestampS(frame.row.frame_idx).has_value();
  };
  const auto first = std::ranges::find_if_not(run->frames, is_recorded);
  const auto count = std::distance(first, run->frames.end());
  if (count == 0 || first == run->frames.begin() || std::any_of(first, run->frames.end(), is_recorded)) return;
  run->frames.erase(first, run->frames.end());
  notes->push_back("the last " + std::to_string(count) + " frames of the run " + run->name +
                   " have no images in its sequence, which was cut off; they are not shown");
}

}  // namespace

void ViewOptions::List(OptionTable& table) {
  table.Add("max_observations", &max_observations, "-",
            "of all runs together; above it every second, third, ... point is shown", 1000, 100000000);
}

void Move(const Sim3& world_from_run, int submap, ViewedRun* run) {
  std::map<PointId, int> submap_of;  // the one in whose world a point's undeformed position is
  const auto transform = [&](Eigen::Vector3f* position) {
    *position = (world_from_run * position->cast<double>()).cast<float>();
  };
  for (ViewedFrame& frame : run->frames) {
    for (const ViewedObservation& o : frame.observations) submap_of.emplace(o.id, frame.row.submap);
    if (frame.row.submap != submap) continue;
    if (frame.world_from_cam)
      frame.world_from_cam = PoseInWorld(world_from_run, frame.world_from_cam->Inverse()).Inverse();
    for (ViewedObservation& o : frame.observations) {
      transform(&o.position);
      transform(&o.truth);
      o.depth *= static_cast<float>(world_from_run.scale);
      o.sigma *= static_cast<float>(world_from_run.scale);
    }
  }
  for (ViewedMesh& mesh : run->meshes)
    if (mesh.surface.submap == submap) Move(world_from_run, &mesh.surface);
  for (const auto& [id, of] : submap_of) {
    if (of != submap) continue;
    Eigen::Vector3d& position = run->points.at(id).position;
    position = world_from_run * position;
  }
}

Result<View> OpenView(const ViewRequest& request, const ViewOptions& options, const JobProgress& progress) {
  if (request.run_paths.empty())
    return Status(ErrorCode::kInvalidArgument, "there is no run to show; give the folder of one or more");
  View view;
  auto opened = OpenItsSequence(request, &view);
  if (!opened.ok()) return opened.status();
  std::optional<OpenedTruth>& sequence = *opened;
  const std::int64_t max_observations = options.max_observations / static_cast<std::int64_t>(request.run_paths.size());
  const bool named = !request.sequence_path.empty();
  bool has_images = false;
  auto meshes = ReadMeshes(request);
  if (!meshes.ok()) return meshes.status();
  for (const std::string& run_path : request.run_paths) {
    auto read = ReadRunForView(run_path, sequence ? sequence->sequence.get() : nullptr, max_observations);
    if (!read.ok()) return read.status();
    ViewedRun& run = read->run;
    run.meshes = std::move((*meshes)[view.runs.size()]);
    view.notes.insert(view.notes.end(), read->notes.begin(), read->notes.end());
    if (sequence && !named) DropUnrecorded(*sequence->sequence, &run, &view.notes);
    const Status fits = sequence ? CheckBelongsTo(FramesOf(run), *sequence->sequence, {}) : Status::Ok();
    if (!fits.ok() && named) return fits;
    if (!fits.ok()) view.notes.push_back("the run " + run.name + " is not compared with the truth: " + fits.message());
    std::optional<Evaluation> evaluation;
    if (sequence && fits.ok()) {
      has_images = true;
      if (!SubmapsOf(run).empty()) {
        auto evaluated = AddTruth(run_path, *sequence, progress, &run);
        if (!evaluated.ok()) return evaluated.status();
        evaluation = *std::move(evaluated);
      }
    }
    run.figures = RunFigures(run, read->summary, evaluation);
    view.runs.push_back(std::move(run));
  }
  TakeNames(request.run_paths, &view);
  if (std::all_of(view.runs.begin(), view.runs.end(), [](const ViewedRun& run) { return run.frames.empty(); }))
    return Status(ErrorCode::kInsufficient,
                  "no frame was read in the run " + request.run_paths.front() + "; there is nothing to show");
  if (has_images) {
    view.sequence = sequence->request;
    view.camera = sequence->sequence->camera();
  }
  for (const ViewedRun& run : view.runs)
    if (!view.camera) view.camera = run.camera;
  const FramePoses truth = has_images ? TruePoses(*sequence->sequence, view.runs) : FramePoses();
  for (const auto& [frame_idx, pose] : truth) view.truth.push_back({frame_idx, pose});
  view.in_millimeters = !truth.empty() || std::ranges::any_of(view.runs, [](const ViewedRun& run) {
    return run.in_millimeters && !SubmapsOf(run).empty();
  });
  Align(truth, &view);
  return view;
}

}  // namespace pliant
