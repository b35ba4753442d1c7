// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/surface_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "pipeline/run_views.h"
#include "pipeline/surface_meshes.h"
#include "pipeline/surface_neighbors.h"
#include "pipeline/surface_notes.h"
#include "pipeline/surface_writer.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/image/depth_lookup.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/surface/fill_holes.h"
#include "pliant/surface/normals.h"

namespace pliant {
namespace {

constexpr const char* kOtherImages =
    "the images do not show the points in the colors that they had when they were tracked; are they the images of the "
    "run? Name those with --sequence";

// Which frames are to be done, and when: a frame is done when the last of its images has been read.
struct Plan {
  std::vector<std::size_t> references;              // in the order in which they can be done
  std::vector<std::vector<std::size_t>> neighbors;  // one list each
  std::map<std::size_t, std::size_t> last_use;      // of an image, by its position: in `references`
};

std::size_t LastImage(std::size_t reference, const std::vector<std::size_t>& neighbors) {
  std::size_t last = reference;
  for (const std::size_t n : neighbors) last = std::max(last, n);
  return last;
}

Plan MakePlan(const std::vector<PosedFrame>& frames, const SurfaceRequest& request, const SurfaceRunOptions& options) {
  std::vector<std::pair<std::size_t, std::vector<std::size_t>>> wanted;
  const std::set<int> chosen(request.frames.begin(), request.frames.end());
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (chosen.empty() || chosen.contains(frames[i].frame_idx))
      wanted.emplace_back(i, ChooseNeighbors(frames, i, options));
  std::ranges::stable_sort(wanted, {}, [](const auto& entry) { return LastImage(entry.first, entry.second); });
  Plan plan;
  for (auto& [reference, neighbors] : wanted) {
    for (const std::size_t n : neighbors) plan.last_use[n] = plan.references.size();
    plan.last_use[reference] = plan.references.size();
    plan.references.push_back(reference);
    plan.neighbors.push_back(std::move(neighbors));
  }
  return plan;
}

void Describe(const DenseDepth& dense, const cv::Mat& valid, SurfaceFrame* frame) {
  const std::vector<double> sigmas = KnownDepths(dense.sigma);
  frame->known_share = static_cast<double>(sigmas.size()) / std::max(1, cv::countNonZero(valid));
  if (!sigmas.empty()) frame->median_sigma = Median(sigmas);
}

int ThreadsOf(const SurfaceRunOptions& options) {
  return options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

TrackedImage TrackedImageOf(const Run& run) {
  TrackedImage tracked;
  if (!run.summary) return tracked;
  const RunDescription& description = run.summary->description;
  tracked.working = {.scale = description.image_scale, .smoothing_px = description.image_smoothing_px};
  if (description.patch_size > 0) tracked.patch_px = description.patch_size;
  tracked.noise_levels = description.image_noise_levels;
  return tracked;
}

// Side of a compared window, in pixels of the camera; odd. Depths tell nothing smaller.
int ComparedWindowPx(const TrackedImage& tracked, const DenseDepthOptions& options) {
  const double side = options.window * tracked.patch_px / tracked.working.scale;
  return 2 * std::max(1, static_cast<int>(std::lround((side - 1) / 2))) + 1;
}

// A bound on the depths of the run: no surface that was tracked is farther, but for wild points, which would make the
// steps of all depth images coarse.
double LargestDepth(const std::vector<PosedFrame>& frames) {
  constexpr double kFar = 0.9;  // of a frame's points are nearer
  double largest = 0.0;
  double far = 0.0;
  for (const PosedFrame& frame : frames) {
    std::vector<double> distances;
    for (const PointObservation& o : frame.observations)
      distances.push_back((frame.cam_from_world * o.position).norm());
    if (distances.empty()) continue;
    largest = std::max(largest, *std::ranges::max_element(distances));
    far = std::max(far, Quantile(std::move(distances), kFar));
  }
  return std::min(2.0 * largest, 4.0 * far);
}

class SurfaceMaker {
 public:
  // `window_px`: of the normals.
  SurfaceMaker(const SurfaceRequest& request, const SurfaceRunOptions& options, const SurfaceProgress& callback,
               const DenseDepthEstimator& estimator, int window_px, SurfaceWriter* writer)
      : request_(request),
        options_(options),
        callback_(callback),
        estimator_(estimator),
        window_px_(window_px),
        writer_(writer) {}

  // `summary` has what was done, also where this fails.
  Status Make(const std::vector<PosedFrame>& frames, const Plan& plan, const RunMap& known, RunViews* images,
              SurfaceSummary* summary) {
    const int total = static_cast<int>(plan.references.size());
    const std::set<std::size_t> is_reference(plan.references.begin(), plan.references.end());
    const SurfaceFileNames names(known.names);
    if (callback_) callback_(SurfaceStage::kDepth, 0, total, 0.0);
    for (std::size_t k = 0; k < plan.references.size(); ++k) {
      if (request_.stop != nullptr && *request_.stop) {
        summary->stopped = true;
        break;
      }
      const std::size_t reference = plan.references[k];
      if (Status status = images->ReadUntil(
              LastImage(reference, plan.neighbors[k]),
              [&](std::size_t position) { return plan.last_use.contains(position); },
              [&](std::size_t position) { return is_reference.contains(position); });
          !status.ok())
        return status;
      SurfaceFrame frame;
      frame.frame_idx = frames[reference].frame_idx;
      frame.provisional = frames[reference].provisional;
      frame.name = names.Of(frame.frame_idx);
      for (const std::size_t n : plan.neighbors[k]) frame.neighbors.push_back(frames[n].frame_idx);
      if (Status status = MakeFrame(reference, plan.neighbors[k], *known.camera, *images, &frame); !status.ok())
        return status;
      images->ForgetUnless([&](std::size_t position) { return plan.last_use.at(position) > k; });
      summary->frames.push_back(frame);
      if (callback_) callback_(SurfaceStage::kDepth, static_cast<int>(k) + 1, total, frame.known_share);
    }
    return Status::Ok();
  }

 private:
  Status MakeFrame(std::size_t reference, const std::vector<std::size_t>& neighbors, const Camera& camera,
                   const RunViews& images, SurfaceFrame* frame) {
    const auto begin = std::chrono::steady_clock::now();
    // Between the images of a pair nothing moves: others, which are seen through the deformation, would add errors.
    const SurfaceView* right = images.RightOf(reference);
    frame->has_pair = right != nullptr;
    std::vector<SurfaceView> others;
    if (right != nullptr)
      others.push_back(*right);
    else
      for (const std::size_t n : neighbors) others.push_back(images.At(n));
    if (others.empty()) {
      frame->note = NoteWithoutNeighbors(options_);
      return Status::Ok();
    }
    auto dense = estimator_.Estimate(images.At(reference), others);
    frame->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!dense.ok()) {
      frame->note = dense.status().message();
      return Status::Ok();
    }
    Describe(*dense, images.At(reference).valid, frame);
    if (!(frame->known_share > 0.0)) {
      frame->note = NoteWithoutDepth(dense->rejected, options_.depth);
      return Status::Ok();
    }
    SurfaceMaps maps{*std::move(dense), {}, {}};
    if (options_.fill > 0) {
      maps.filled = FillHoles(camera, images.TissueIn(reference), options_.fill, &maps.dense);
      frame->filled_share = static_cast<double>(cv::countNonZero(maps.filled)) /
                            std::max(1, cv::countNonZero(images.At(reference).valid));
    }
    if (options_.normals_png) maps.normals = NormalsOfDepth(camera, maps.dense.depth, window_px_);
    return writer_->Write(*frame, maps);
  }

  const SurfaceRequest& request_;
  const SurfaceRunOptions& options_;
  const SurfaceProgress& callback_;
  const DenseDepthEstimator& estimator_;
  int window_px_;
  SurfaceWriter* writer_;
};

// Those that say something.
void AddWarnings(const std::vector<std::string>& warnings, SurfaceSummary* summary) {
  std::ranges::copy_if(warnings, std::back_inserter(summary->warnings),
                       [](const std::string& warning) { return !warning.empty(); });
}

// What the meshes of a surface are made of, besides its depths.
struct MeshInput {
  const std::vector<PosedFrame>& frames;
  const RunMap& known;
  const SequenceRequest& source;
  const Run& run;
};

// None where none are wanted.
Status AddMeshes(const SurfaceRequest& request, const SurfaceRunOptions& options, const SurfaceProgress& callback,
                 const MeshInput& input, SurfaceSummary* summary) {
  MadeMeshes made;
  if (options.mesh_columns > 0) {
    const auto folder = ReadSurfaceFolder(request.output_path);
    if (!folder.ok()) return folder.status();
    const std::set<int> chosen(request.frames.begin(), request.frames.end());
    const MeshSource meshes{input.frames, input.known, *folder, input.source, input.run.frames, chosen};
    const auto go_on = [&](int done, int total) {
      if (callback) callback(SurfaceStage::kMesh, done, total, 0.0);
      return request.stop == nullptr || !*request.stop;
    };
    const auto result = MakeMeshes(meshes, options, ThreadsOf(options), go_on);
    if (!result.ok()) return result.status();
    made = *result;
  }
  summary->stopped = made.stopped;
  AddWarnings({MeshWarning(made, options)}, summary);
  return Status::Ok();
}

}  // namespace

void SurfaceRunOptions::List(OptionTable& table) {
  depth.List(table);
  table.Add("neighbors", &neighbors, "", "other images that a frame is compared with", 1, 100);
  table.Add("min_common_points", &min_common_points, "1", "of the frame's points, that a neighbor has too", 0.0, 1.0);
  table.Add("max_parallax_deg", &max_parallax_deg, "deg", "of these, in the median", 0.1, 90.0);
  table.Add("max_frames_apart", &max_frames_apart, "frames",
            "between a frame and a neighbor; the images of so many frames are in memory", 1, 1000000);
  table.Add("pairs", &pairs, "bool", "a frame that has a right image is compared with that alone");
  table.Add("mesh_columns", &mesh_columns, "", "vertices of the mesh across an image; 0: no mesh", 0, 4096);
  table.Add("gltf", &gltf, "bool", "surface.glb: the mesh, its texture, its motion and the camera's");
  table.Add("vtk", &vtk, "bool", "surface.pvd and vtp/: the mesh in every frame, with displacement, strain and sigma");
  table.Add("obj", &obj, "bool", "obj/: the mesh in every frame, with its texture");
  table.Add("fill", &fill, "px", "holes of at most this area are filled from their rim, and marked; 0: none", 0,
            100000);
  table.Add("exr", &exr, "bool", "exr/: the depth as OpenEXR, 32-bit floats");
  table.Add("npy", &npy, "bool", "npy/: the depth as arrays of NumPy, float32, (height, width)");
  table.Add("normals_png", &normals_png, "bool", "normals/: of the depth, (n + 1) / 2 in red, green, blue");
  table.Add("animation_keys", &animation_keys, "", "frames whose mesh surface.glb has, evenly spread", 1, 1000);
  table.Add("threads", &threads, "", "0: as many as the machine has; the result is the same", 0, 1024);
  masks.List(table);
}

Result<SurfaceSummary> MakeSurface(const SurfaceRequest& request, const SurfaceRunOptions& options,
                                   const SurfaceProgress& callback) {
  const auto run = ReadRun(request.run_path);
  if (!run.ok()) return run.status();
  if (run->poses.empty())
    return Status(ErrorCode::kInsufficient,
                  "no frame of the run " + Quoted(request.run_path) + " was tracked; there is no surface to see");
  const auto checksum = TrajectoryChecksum(request.run_path);
  if (!checksum.ok()) return checksum.status();
  SequenceRequest source = SequenceOfRun(request.run_path, request.sequence_path, request.camera_path);
  if (!request.mask_path.empty()) source.mask_path = request.mask_path;
  if (Status status = CheckMasksOfRun(source, *run); !status.ok()) return status;
  auto sequence = OpenImagesOfRun(request.run_path, source);
  if (!sequence.ok()) return sequence.status();
  const auto known = KnownMapOfRun(request.run_path, source, *run);
  if (!known.ok()) return known.status();
  if (Status status = CheckCameraOfImages(source, *run, *known->camera, (*sequence)->camera()); !status.ok())
    return status;
  const auto frames = ReadPosedFrames(request.run_path, *run);
  if (!frames.ok()) return frames.status();
  const Plan plan = MakePlan(*frames, request, options);
  const std::vector<SurfaceFrame> missing = FramesWithoutPose(request, *run, *frames);
  if (plan.references.empty()) return NoFrameChosen(request, *run, missing);
  const TrackedImage tracked = TrackedImageOf(*run);
  const auto estimator = DenseDepthEstimator::Create(*known->camera, tracked, options.depth, ThreadsOf(options));
  if (!estimator.ok()) return estimator.status();
  auto writer = SurfaceWriter::Create(request.output_path,
                                      {*known->camera, LargestDepth(*frames),
                                       run->summary ? run->summary->description.metric : std::nullopt, *checksum},
                                      options);
  if (!writer.ok()) return writer.status();
  RunViews images(*std::move(sequence), *frames, *known, options.masks, options.pairs ? ThreadsOf(options) : 0);
  SurfaceSummary summary{.windows = estimator->windows(), .frames = missing, .warnings = WarningsOf(missing, *run)};
  const Status made =
      SurfaceMaker(request, options, callback, *estimator, ComparedWindowPx(tracked, options.depth), &*writer)
          .Make(*frames, plan, *known, &images, &summary);
  AddWarnings({images.AreOfOtherImages() ? kOtherImages : "", ProvisionalWarning(summary.frames),
               options.mesh_columns > 0 ? StillWarning(*frames, plan.references, *known) : ""},
              &summary);
  std::ranges::sort(summary.frames, {}, &SurfaceFrame::frame_idx);
  // Until the meshes are there too, the folder says that it was interrupted.
  const bool stopped = summary.stopped || !made.ok();
  summary.stopped = true;
  const Status finished = writer->Finish(request, options, summary);
  if (!made.ok()) return made;
  if (!finished.ok()) return finished;
  if (std::ranges::none_of(summary.frames, [](const SurfaceFrame& frame) { return frame.known_share > 0.0; }))
    return Status(ErrorCode::kInsufficient,
                  "no frame has a depth: " + (images.AreOfOtherImages() ? kOtherImages : ReasonOf(summary.frames)));
  if (stopped) return summary;
  if (Status status = AddMeshes(request, options, callback, {*frames, *known, source, *run}, &summary); !status.ok())
    return status;
  if (Status status = writer->Finish(request, options, summary); !status.ok()) return status;
  return summary;
}

}  // namespace pliant
