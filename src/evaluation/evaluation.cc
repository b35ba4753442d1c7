// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/evaluation.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "pliant/evaluation/surface_error.h"

namespace pliant {
namespace {

// The truth of the tracked frames, collected in one pass.
struct CollectedTruth {
  std::vector<PairedFrame> surface;
  std::optional<MaterialErrorCollector> material;
  std::vector<PosePair> poses;
  FirstMapTruth reference;  // of the first map
  FirstMapTruth declared;
  std::vector<int> own_pairs;  // frames that maps were made of alone, perhaps of their pair, where pairs are the truth
};

// The points of a frame, each with the true surface at its pixel.
struct PointsWithTruth {
  std::vector<TrackedPoint> points;
  std::optional<PairedFrame> surface;  // nothing where the frame has no true surface
};

Result<PointsWithTruth> PairFrame(const EvaluationFrame& frame, const Camera& camera, double max_sigma_mm,
                                  SurfaceTruth* surface) {
  PointsWithTruth paired;
  std::vector<Eigen::Vector3d> points_in_cam;
  std::vector<double> sigmas;
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& observation : frame.observations) {
    sigmas.push_back(observation.sigma);
    points_in_cam.push_back(*frame.cam_from_world * observation.position);
    pixels.push_back(observation.pixel);
    paired.points.push_back({observation.id, pixels.back(), points_in_cam.back()});
  }
  const auto depths = surface->At(frame.frame_idx, pixels);
  if (!depths.ok()) return depths.status();
  if (!depths->has_value()) return paired;
  for (std::size_t i = 0; i < pixels.size(); ++i) paired.points[i].surface = (**depths)[i];
  paired.surface = PairWithSurface(frame.frame_idx, points_in_cam, sigmas, pixels, camera, **depths, max_sigma_mm);
  return paired;
}

// The frame is one of the two that the first map's error looks at, if that is wanted.
bool IsOfFirstMap(const EvaluationFrame& frame, const EvaluationOptions& options) {
  return options.Wants(EvaluationPart::kFirstMap) && frame.first_map &&
         (frame.frame_idx == frame.first_map->reference_frame_idx ||
          frame.frame_idx == frame.first_map->declared_frame_idx);
}

Status CollectFrame(const EvaluationFrame& frame, const Sequence& sequence, const EvaluationOptions& options,
                    SurfaceTruth* surface, CollectedTruth* truth) {
  const bool of_first_map = IsOfFirstMap(frame, options);
  FirstMapTruth known;
  if (options.Wants(EvaluationPart::kSurface) || truth->material || of_first_map) {
    auto paired = PairFrame(frame, sequence.camera(), options.points.max_truth_sigma_mm, surface);
    if (!paired.ok()) return paired.status();
    if (truth->material)
      if (Status status = truth->material->AddFrame(frame.frame_idx, frame.submap, paired->points); !status.ok())
        return status;
    known.surface = std::move(paired->surface);
    if (known.surface) known.surface->submap = frame.submap;
    // It would be compared with itself.
    if (frame.makes_map_alone && surface->IsOfPairs()) {
      known.surface.reset();
      truth->own_pairs.push_back(frame.frame_idx);
    }
  }
  if (const std::optional<Rigid3> world_from_cam = sequence.WorldFromCamera(frame.frame_idx))
    known.poses = {frame.frame_idx, frame.cam_from_world->Inverse(), *world_from_cam, frame.submap};
  if (of_first_map && frame.frame_idx == frame.first_map->reference_frame_idx) truth->reference = known;
  if (of_first_map && frame.frame_idx == frame.first_map->declared_frame_idx) truth->declared = known;
  if (options.Wants(EvaluationPart::kCamera) && known.poses) truth->poses.push_back(*known.poses);
  if (options.Wants(EvaluationPart::kSurface) && known.surface) truth->surface.push_back(*std::move(known.surface));
  return Status::Ok();
}

TrackSurvival Survival(const EvaluationInput& run) {
  std::vector<FrameTracks> tracks;
  for (const EvaluationFrame& frame : run.frames) {
    FrameTracks& row = tracks.emplace_back();
    row.frame_idx = frame.frame_idx;
    row.tracked = frame.cam_from_world.has_value();
    if (!row.tracked) continue;
    row.submap = frame.submap;
    for (const PointObservation& observation : frame.observations) row.ids.push_back(observation.id);
  }
  return ComputeTrackSurvival(tracks);
}

// Takes over a part, or notes why it is missing; a part that was asked for by name must be there.
template <class Part>
Status Take(EvaluationPart name, Result<Part> result, const EvaluationOptions& options, std::optional<Part>* part,
            std::vector<std::string>* notes) {
  if (result.ok()) {
    *part = *std::move(result);
    return Status::Ok();
  }
  const std::string sentence = "no " + std::string(EnumName(name)) + " error: " + result.status().message();
  if (!options.parts.empty()) return {result.status().code(), sentence};
  notes->push_back(sentence);
  return Status::Ok();
}

Status ComputeParts(const EvaluationInput& run, const CollectedTruth& truth, const Status& material_status,
                    const EvaluationOptions& options, Evaluation* evaluation) {
  const auto missing = [](const char* what) { return Status(ErrorCode::kNotFound, what); };
  if (options.Wants(EvaluationPart::kSurface)) {
    Result<PointError> surface =
        truth.surface.empty() ? Result<PointError>(missing("the sequence has no true surface for the tracked frames"))
                              : ComputePointError(truth.surface, options.points);
    if (Status status =
            Take(EvaluationPart::kSurface, std::move(surface), options, &evaluation->surface, &evaluation->notes);
        !status.ok())
      return status;
    if (evaluation->surface) {
      auto uncertainty = ComputeUncertaintyError(truth.surface, *evaluation->surface);
      if (uncertainty.ok()) evaluation->uncertainty = *std::move(uncertainty);
    }
  }
  if (options.Wants(EvaluationPart::kMaterial)) {
    Result<MaterialError> material =
        truth.material ? truth.material->Compute(options.points) : Result<MaterialError>(material_status);
    if (Status status =
            Take(EvaluationPart::kMaterial, std::move(material), options, &evaluation->material, &evaluation->notes);
        !status.ok())
      return status;
  }
  if (options.Wants(EvaluationPart::kCamera)) {
    Result<TrajectoryError> trajectory =
        truth.poses.empty() ? Result<TrajectoryError>(missing("the sequence has no pose for the tracked frames"))
                            : ComputeTrajectoryError(truth.poses, options.trajectory);
    if (Status status =
            Take(EvaluationPart::kCamera, std::move(trajectory), options, &evaluation->trajectory, &evaluation->notes);
        !status.ok())
      return status;
  }
  if (!options.Wants(EvaluationPart::kFirstMap)) return Status::Ok();
  const bool is_of_own_pair = std::ranges::any_of(run.frames, [&](const EvaluationFrame& frame) {
    return frame.first_map && std::ranges::count(truth.own_pairs, frame.frame_idx) > 0;
  });
  auto first_map =
      is_of_own_pair
          ? Result<FirstMapError>(missing(
                "the map was made from one frame, perhaps from the pair of images that it would be compared with"))
          : ComputeFirstMapError(run.frames, truth.reference, truth.declared);
  return Take(EvaluationPart::kFirstMap, std::move(first_map), options, &evaluation->first_map, &evaluation->notes);
}

// The points of a run as tracks in its images.
std::vector<PixelTrack> TracksOf(const EvaluationInput& run) {
  std::map<PointId, PixelTrack> tracks;
  for (const EvaluationFrame& frame : run.frames)
    for (const PointObservation& seen : frame.observations)
      tracks[seen.id].pixels.push_back({frame.frame_idx, seen.pixel});
  std::vector<PixelTrack> result;
  for (auto& [id, track] : tracks) result.push_back({id, std::move(track.pixels)});
  return result;
}

// The same in space, in the frames that were tracked.
std::vector<Track3d> TracksInSpace(const EvaluationInput& run) {
  std::map<PointId, Track3d> tracks;
  for (const EvaluationFrame& frame : run.frames) {
    if (!frame.cam_from_world) continue;
    for (const PointObservation& seen : frame.observations)
      tracks[seen.id].points.push_back({frame.frame_idx, seen.pixel, *frame.cam_from_world * seen.position});
  }
  std::vector<Track3d> result;
  for (auto& [id, track] : tracks) result.push_back(std::move(track));
  return result;
}

Status ComputeTracks(const EvaluationInput& run, const Camera& camera, const Result<MaterialTruth*>& material,
                     const EvaluationOptions& options, Evaluation* evaluation) {
  // That there is no such truth was said of the material error.
  if (!options.Wants(EvaluationPart::kTracks) || (options.parts.empty() && !material.ok())) return Status::Ok();
  std::vector<int> frames;
  for (const EvaluationFrame& frame : run.frames) frames.push_back(frame.frame_idx);
  Result<TrackError> error = material.ok() ? ComputeTrackError(TracksOf(run), frames, camera, **material)
                                           : Result<TrackError>(material.status());
  Status status = Take(EvaluationPart::kTracks, std::move(error), options, &evaluation->tracks, &evaluation->notes);
  if (!status.ok() || !evaluation->tracks) return status;
  const ErrorScale scale = run.metric ? ErrorScale::kNone : options.points.scale;
  return Take(EvaluationPart::kTracks, ComputeTrackError3d(TracksInSpace(run), frames, camera, **material, scale),
              options, &evaluation->tracks_3d, &evaluation->notes);
}

// What needs no truth; `sequence_camera` may be null.
Result<Evaluation> Begin(const EvaluationInput& run, const Camera* sequence_camera) {
  Evaluation evaluation;
  evaluation.run = run.name;
  evaluation.notes = run.notes;
  evaluation.survival = Survival(run);
  const Camera* camera = run.camera ? &*run.camera : sequence_camera;
  if (camera != nullptr) evaluation.reprojection = ComputeReprojectionError(run, *camera);
  evaluation.run_seconds = run.seconds;
  if (evaluation.survival.frames_tracked == 0)
    return Status(ErrorCode::kInsufficient, "the run " + run.name + " has no tracked frame among the " +
                                                std::to_string(run.frames.size()) +
                                                " it read; there is nothing to evaluate");
  return evaluation;
}

Status CheckProtocols(const Evaluation& evaluation, const EvaluationOptions& options) {
  if (evaluation.surface || evaluation.material) return Status::Ok();
  for (const ErrorProtocol protocol : options.points.protocols)
    if (protocol != ErrorProtocol::kPaper)
      return {ErrorCode::kNotFound, "the protocol " + std::string(EnumName(protocol)) +
                                        " compares points, and there is no truth for the points of the run " +
                                        evaluation.run + "; evaluate on a sequence with depth/ or simulation.yaml"};
  return Status::Ok();
}

}  // namespace

bool EvaluationOptions::Wants(EvaluationPart part) const {
  return parts.empty() || std::find(parts.begin(), parts.end(), part) != parts.end();
}

void EvaluationOptions::List(OptionTable& table) {
  table.BeginGroup("Evaluation", "what is compared, and how run and sequence are brought together");
  table.AddChoices("parts", &parts,
                   "the parts to compute; one that has no truth is an error. Empty: all that have truth");
  table.AddChoice("surface_from", &surface_from,
                  "where the true surface comes from: depth, the depth images; pairs, the disparity of pairs of images "
                  "at the pixels of the points; any, the first of these that the sequence has");
  matching.List(table);
  table.BeginGroup("PointError", "surface error and material error: estimated points against true ones");
  points.List(table);
  table.BeginGroup("TrajectoryError", "distance of the estimated camera path from the true one");
  trajectory.List(table);
  table.BeginGroup("SfmError", "depths against those of structure from motion, one scale a frame");
  sfm.List(table);
  table.BeginGroup("Consistency", "depths against those of another run, one scale a frame");
  consistency.List(table);
}

Result<Evaluation> Evaluate(const EvaluationInput& run, const Sequence& sequence,
                            const Result<MaterialTruth*>& material, const EvaluationOptions& options,
                            SurfaceTruth* surface, const JobProgress& progress) {
  if (Status status = CheckBelongsTo(run, sequence, options.matching); !status.ok()) return status;
  Result<Evaluation> begun = Begin(run, &sequence.camera());
  if (!begun.ok()) return begun.status();
  Evaluation evaluation = *std::move(begun);
  CollectedTruth truth;
  if (material.ok() && options.Wants(EvaluationPart::kMaterial)) truth.material.emplace(**material, sequence.camera());
  if (surface == nullptr && options.surface_from == SurfaceSource::kPairs)
    return Status(ErrorCode::kInvalidArgument, "SurfaceSource pairs needs an opened PairTruth");
  const std::unique_ptr<SurfaceTruth> images = SurfaceTruthFromDepthImages(sequence, options.points.max_depth_step);
  if (surface == nullptr) surface = images.get();
  int done = 0;
  for (const EvaluationFrame& frame : run.frames) {
    if (frame.cam_from_world)
      if (Status status = CollectFrame(frame, sequence, options, surface, &truth); !status.ok()) return status;
    if (Status status = Tell(progress, "evaluate", ++done, static_cast<int>(run.frames.size())); !status.ok())
      return status;
  }
  if (options.Wants(EvaluationPart::kSurface))
    for (const int frame_idx : truth.own_pairs)
      evaluation.notes.push_back("the surface of frame " + std::to_string(frame_idx) +
                                 " is not evaluated with its pair of images: a map was made from that frame alone, "
                                 "perhaps from the same pair");
  if (Status status = ComputeParts(run, truth, material.status(), options, &evaluation); !status.ok()) return status;
  if (Status status = ComputeTracks(run, sequence.camera(), material, options, &evaluation); !status.ok())
    return status;
  if (Status status = CheckProtocols(evaluation, options); !status.ok()) return status;
  return evaluation;
}

Result<Evaluation> EvaluateWithoutTruth(const EvaluationInput& run, const EvaluationOptions& options) {
  if (!options.parts.empty())
    return Status(ErrorCode::kNotFound, "no " + std::string(EnumName(options.parts.front())) + " error of the run " +
                                            run.name + " without its sequence; give --sequence");
  Result<Evaluation> evaluation = Begin(run, nullptr);
  if (!evaluation.ok()) return evaluation;
  if (Status status = CheckProtocols(*evaluation, options); !status.ok()) return status;
  return evaluation;
}

Result<Evaluation> EvaluateTracks(const std::string& name, std::span<const PixelTrack> tracks, int frames,
                                  const Camera& camera, const Result<MaterialTruth*>& material) {
  if (!material.ok()) return material.status();
  Evaluation evaluation;
  evaluation.run = name;
  std::vector<int> frames_idx(static_cast<std::size_t>(frames));
  std::iota(frames_idx.begin(), frames_idx.end(), 0);
  auto error = ComputeTrackError(tracks, frames_idx, camera, **material);
  if (!error.ok()) return error.status();
  evaluation.tracks = *std::move(error);
  std::vector<FrameTracks> rows;
  for (const int frame_idx : frames_idx) {
    FrameTracks& row = rows.emplace_back(FrameTracks{.frame_idx = frame_idx, .tracked = true, .ids = {}});
    for (const PixelTrack& track : tracks)
      if (const TrackPixel* pixel = PixelIn(track, frame_idx); pixel != nullptr && pixel->visible)
        row.ids.push_back(track.id);
  }
  evaluation.survival = ComputeTrackSurvival(rows);
  return evaluation;
}

Status AddSfmError(const EvaluationInput& run, const SfmPoints& sfm, int width_px, const EvaluationOptions& options,
                   Evaluation* evaluation) {
  Result<RelativeDepthError> error = ComputeSfmError(run, sfm, width_px, options.sfm);
  if (!error.ok()) return error.status();
  evaluation->sfm = *std::move(error);
  return Status::Ok();
}

Status AddConsistency(const EvaluationInput& run, const EvaluationInput& other, int width_px,
                      const EvaluationOptions& options, Evaluation* evaluation) {
  Result<RelativeDepthError> depths = CompareRuns(run, other, width_px, options.consistency);
  Result<TrajectoryError> path = CompareCameraPaths(run, other, options.consistency, {});
  if (!depths.ok() && !path.ok()) return depths.status();
  if (!depths.ok()) evaluation->notes.push_back(depths.status().message());
  evaluation->consistency.push_back({other.name, depths.ok() ? std::optional(*std::move(depths)) : std::nullopt,
                                     path.ok() ? std::optional(*std::move(path)) : std::nullopt});
  return Status::Ok();
}

}  // namespace pliant
