// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/window_initializer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "pliant/base/statistics.h"
#include "pliant/estimation/two_view_models.h"
#include "tracking/initial_map.h"

namespace pliant {
namespace {

// A rotation that explains this share of the points to this error leaves nothing to triangulate.
constexpr double kRotationErrorPx = 1.5;
constexpr double kMaxRotationShare = 0.8;
constexpr std::size_t kLeastPoints = 12;
constexpr std::size_t kLeastFrames = 6;

// Whether to wait while many points are uncertain.
enum class WhenUncertain { kWait, kTakeTheCertain };

// One attempt on the frames since the reference.
class Attempt {
 public:
  Attempt(const WindowInitOptions& options, double nominal_depth_mm, const InitInput& input, InitOutcome* outcome)
      : options_(options),
        nominal_depth_mm_(nominal_depth_mm),
        input_(input),
        focal_px_(input.camera.MeanFocalLengthPx()),
        outcome_(*outcome) {}

  // What is missing for a map; ok when the outcome is one. The window is that of the first `frames` frames; the others
  // are located in it.
  Status Run(std::size_t frames, WhenUncertain when_uncertain) {
    if (frames < kLeastFrames)
      return {ErrorCode::kInsufficient, "a window takes at least " + std::to_string(kLeastFrames) + " frames"};
    if (Status status = MoreThanARotation(); !status.ok()) return status;
    ChooseViews(frames);
    ChoosePoints();
    if (ids_.size() < kLeastPoints)
      return {ErrorCode::kInsufficient, "only " + std::to_string(ids_.size()) + " points were followed long enough"};
    if (Status status = Start(); !status.ok()) return status;
    auto solution = SolveDeformingWindow(start_, focal_px_, options_.window, input_.threads);
    if (!solution.ok()) return solution.status();
    ChooseCertain(*solution, solution->sample_sigmas);
    Status status = EnoughCertain(when_uncertain);
    if (!status.ok() && when_uncertain == WhenUncertain::kTakeTheCertain) {
      // Better a map that only the prediction speaks for than none.
      ChooseCertain(*solution, {});
      status = EnoughCertain(when_uncertain);
    }
    if (!status.ok()) return status;
    return HandOver(*solution);
  }

 private:
  Status MoreThanARotation() {
    const MatchedRays matched = MatchRays(input_.camera, input_.frames.front(), input_.frames.back());
    outcome_.measured.correspondences = static_cast<int>(matched.ids.size());
    const auto rotation = FitRotation(matched.rays0, matched.rays1, focal_px_, kRotationErrorPx);
    if (!rotation.ok()) return rotation.status();
    outcome_.measured.rotation_only_share = rotation->num_inliers / static_cast<double>(matched.ids.size());
    if (outcome_.measured.rotation_only_share <= kMaxRotationShare) return Status::Ok();
    return {ErrorCode::kDegenerate, "the camera rotated or stood still: a rotation alone explains " +
                                        Digits(100.0 * outcome_.measured.rotation_only_share, 0) +
                                        " % of the points; move it sideways or forwards"};
  }

  // Spread evenly.
  void ChooseViews(std::size_t frames) {
    const std::size_t last = frames - 1;
    const std::size_t count = std::min(last + 1, static_cast<std::size_t>(options_.views));
    for (std::size_t k = 0; k < count; ++k) views_.push_back((k * last + (count - 1) / 2) / (count - 1));
  }

  // The points that are seen in enough views; where they are too many, those still seen, then those seen most.
  void ChoosePoints() {
    std::map<PointId, int> seen;
    for (const std::size_t view : views_)
      for (const InitObservation& observation : input_.frames[view].observations) ++seen[observation.id];
    const int least = std::min(options_.min_views, static_cast<int>(views_.size()));
    const int bonus = static_cast<int>(views_.size());
    for (const InitObservation& observation : input_.frames.back().observations)
      if (const auto found = seen.find(observation.id); found != seen.end() && found->second >= least)
        found->second += bonus;
    std::vector<std::pair<int, PointId>> chosen;
    for (const auto& [id, count] : seen)
      if (count >= least) chosen.emplace_back(count, id);
    std::stable_sort(chosen.begin(), chosen.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
    if (chosen.size() > static_cast<std::size_t>(options_.max_points))
      chosen.resize(static_cast<std::size_t>(options_.max_points));
    for (const auto& [count, id] : chosen) ids_.push_back(id);
    std::sort(ids_.begin(), ids_.end());
  }

  // The index of a chosen point, or -1.
  int IndexOf(PointId id) const {
    const auto found = std::lower_bound(ids_.begin(), ids_.end(), id);
    return found != ids_.end() && *found == id ? static_cast<int>(found - ids_.begin()) : -1;
  }

  // The observations of a frame as those of view `view_idx`.
  void Observe(const InitFrame& frame, int view_idx, std::vector<DeformingObservation>* observations) const {
    for (const InitObservation& observation : frame.observations) {
      const int point = IndexOf(observation.id);
      if (point < 0) continue;
      const auto ray = input_.camera.Unproject(observation.pixel);
      if (!ray || !ray->allFinite()) continue;
      const double light =
          LogDistanceFromLight(options_.light == LightCue::kOn ? observation.brightness : 0.0, options_.gamma);
      observations->push_back({view_idx, point, *ray, light});
    }
  }

  // Points where the light puts them, or all at one distance; views located against them as if nothing deformed. A
  // point that is first seen in a later view is put there, among those known already.
  Status Start() {
    std::map<PointId, Eigen::Vector3d> known;
    Rigid3 near;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const InitFrame& frame = input_.frames[views_[v]];
      if (v > 0) {
        InitialMap map;
        for (const auto& [id, position] : known) {
          map.ids.push_back(id);
          map.positions.push_back(position);
        }
        const auto pose = LocateFrame(input_.camera, frame, map, near, {});
        if (!pose.ok()) return pose.status();
        near = *pose;
      }
      start_.cams_from_world.push_back(near);
      start_.times.push_back(frame.frame_idx - input_.frames.front().frame_idx);
      AddNewPoints(frame, near, &known);
    }
    ids_.clear();
    for (const auto& [id, position] : known) {
      ids_.push_back(id);
      start_.points_in_world.push_back(position);
    }
    for (std::size_t v = 0; v < views_.size(); ++v)
      Observe(input_.frames[views_[v]], static_cast<int>(v), &start_.observations);
    return Status::Ok();
  }

  // Puts a frame's chosen points that are not known yet at the distance that the light says, relative to the others.
  void AddNewPoints(const InitFrame& frame, const Rigid3& cam_from_world, std::map<PointId, Eigen::Vector3d>* known) {
    std::vector<DeformingObservation> observations;
    Observe(frame, 0, &observations);
    std::vector<double> lights;
    std::vector<double> distances;
    std::vector<double> offsets;  // log distance less the light's
    for (const DeformingObservation& observation : observations) {
      if (std::isfinite(observation.log_light)) lights.push_back(observation.log_light);
      const auto found = known->find(ids_[static_cast<std::size_t>(observation.point_idx)]);
      if (found == known->end()) continue;
      distances.push_back((cam_from_world * found->second).norm());
      if (std::isfinite(observation.log_light)) offsets.push_back(std::log(distances.back()) - observation.log_light);
    }
    const double unlit = distances.empty() ? nominal_depth_mm_ : Median(distances);
    double offset = 0;
    if (!offsets.empty())
      offset = Median(offsets);
    else if (!lights.empty())
      offset = std::log(nominal_depth_mm_) - Median(lights);
    for (const DeformingObservation& observation : observations) {
      const double distance = std::isfinite(observation.log_light) ? std::exp(offset + observation.log_light) : unlit;
      known->try_emplace(ids_[static_cast<std::size_t>(observation.point_idx)],
                         cam_from_world.Inverse() * (distance * observation.ray));
    }
  }

  // By what the solution predicts, and by `more_sigmas`, one a point or none.
  void ChooseCertain(const DeformingSolution& solution, const std::vector<double>& more_sigmas) {
    certain_.clear();
    rejected_.clear();
    sigmas_.clear();
    std::vector<double> distances;
    for (const Eigen::Vector3d& position : solution.window.points_in_world) distances.push_back(position.norm());
    const double median = Median(distances);
    const std::vector<double> errors_px = PointErrorsPx(solution.window, focal_px_);
    std::vector<double> sigmas;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const double relative = std::hypot(solution.log_depth_sigmas[i], more_sigmas.empty() ? 0.0 : more_sigmas[i]);
      const double sigma = relative * distances[i] / median;
      sigmas_[ids_[i]] = relative * distances[i];
      const bool contradicts = !(errors_px[i] <= options_.max_error_px);
      certain_.push_back(!contradicts && sigma <= options_.max_depth_sigma ? 1 : 0);
      if (certain_.back() != 0)
        sigmas.push_back(sigma);
      else
        rejected_.push_back({ids_[i], contradicts ? InitRejection::kReprojection : InitRejection::kUncertainDepth});
    }
    outcome_.measured.inliers = static_cast<int>(sigmas.size());
    outcome_.measured.median_depth_sigma = sigmas.empty() ? 0.0 : Median(std::move(sigmas));
    outcome_.measured.median_error_px = Median(errors_px);
  }

  Status EnoughCertain(WhenUncertain when_uncertain) const {
    int seen = 0;
    int certain = 0;
    for (const InitObservation& observation : input_.frames.back().observations) {
      const int point = IndexOf(observation.id);
      if (point < 0) continue;
      ++seen;
      certain += certain_[static_cast<std::size_t>(point)];
    }
    const double share = seen > 0 ? static_cast<double>(certain) / seen : 0.0;
    if (certain >= options_.min_points &&
        (when_uncertain == WhenUncertain::kTakeTheCertain || share >= options_.min_certain_share))
      return Status::Ok();
    std::string needed = std::to_string(options_.min_points);
    if (when_uncertain == WhenUncertain::kWait)
      needed += " and " + Digits(100.0 * options_.min_certain_share, 0) + " %";
    return {ErrorCode::kInsufficient, "the depth of " + std::to_string(certain) + " of " + std::to_string(seen) +
                                          " points is certain, at least " + needed +
                                          " are needed; move the camera sideways or forwards"};
  }

  // All frames, the certain points alone.
  Result<DeformingWindow> LocateAllFrames(const DeformingWindow& solved) {
    DeformingWindow all;
    std::vector<PointId> certain_ids;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (certain_[i] == 0) continue;
      certain_ids.push_back(ids_[i]);
      all.points_in_world.push_back(solved.points_in_world[i]);
      all.modes.push_back(solved.modes[i]);
    }
    ids_ = std::move(certain_ids);
    all.courses.resize(solved.courses.rows(), static_cast<Eigen::Index>(input_.frames.size()));
    std::size_t next = 0;  // the first solved view that is not before the frame
    for (std::size_t k = 0; k < input_.frames.size(); ++k) {
      while (views_[next] < k && next + 1 < views_.size()) ++next;
      const std::size_t before = views_[next] <= k ? next : next - 1;
      const double share =
          before == next ? 0.0
                         : static_cast<double>(k - views_[before]) / static_cast<double>(views_[next] - views_[before]);
      const Rigid3& a = solved.cams_from_world[before];
      const Rigid3& b = solved.cams_from_world[next];
      all.times.push_back(input_.frames[k].frame_idx - input_.frames.front().frame_idx);
      all.cams_from_world.emplace_back(a.rotation.slerp(share, b.rotation),
                                       (1.0 - share) * a.translation + share * b.translation);
      all.courses.col(static_cast<Eigen::Index>(k)) =
          (1.0 - share) * solved.courses.col(static_cast<Eigen::Index>(before)) +
          share * solved.courses.col(static_cast<Eigen::Index>(next));
      Observe(input_.frames[k], static_cast<int>(k), &all.observations);
    }
    return LocateDeformingViews(all, focal_px_, options_.window);
  }

  // Between the views of the problem a track may be wrong that was right in them, or that had a course to itself there.
  void DropContradicting(DeformingWindow* all) {
    const std::vector<double> errors_px = PointErrorsPx(*all, focal_px_);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      if (!(errors_px[i] <= options_.max_error_px)) {
        rejected_.push_back({ids_[i], InitRejection::kReprojection});
        continue;
      }
      ids_[kept] = ids_[i];
      all->points_in_world[kept] = all->points_in_world[i];
      all->modes[kept] = all->modes[i];
      ++kept;
    }
    ids_.resize(kept);
    all->points_in_world.resize(kept);
    all->modes.resize(kept);
    all->observations.clear();  // they count the points otherwise
  }

  Status HandOver(const DeformingSolution& solution) {
    auto located = LocateAllFrames(solution.window);
    if (!located.ok()) return located.status();
    DropContradicting(&*located);
    if (ids_.empty()) return {ErrorCode::kDegenerate, "no point agrees with the frames between the window's views"};
    std::vector<double> depths;
    for (const Eigen::Vector3d& position : located->points_in_world) depths.push_back(position.z());
    const double median = Median(std::move(depths));
    if (!(median > 0.0)) return {ErrorCode::kDegenerate, "the map's median depth is not in front of the camera"};
    const double scale = nominal_depth_mm_ / median;

    for (std::size_t i = 0; i < ids_.size(); ++i) {
      InitPoint point{ids_[i], scale * located->points_in_world[i], scale * sigmas_.at(ids_[i]), 0.0};
      outcome_.points.push_back(point);
    }
    for (std::size_t k = 0; k < input_.frames.size(); ++k) {
      const Rigid3& pose = located->cams_from_world[k];
      InitFrameState state{input_.frames[k].frame_idx, Rigid3(pose.rotation, scale * pose.translation), {}};
      for (const InitObservation& observation : input_.frames[k].observations)
        if (const int point = IndexOf(observation.id); point >= 0)
          state.positions.push_back({observation.id, scale * located->Position(point, static_cast<int>(k))});
      outcome_.frames.push_back(std::move(state));
    }
    std::set<PointId> others;
    for (const InitFrame& frame : input_.frames)
      for (const InitObservation& observation : frame.observations) others.insert(observation.id);
    for (const PointId id : ids_) others.erase(id);
    for (const InitRejectedPoint& rejected : rejected_) others.erase(rejected.id);
    for (const PointId id : others) rejected_.push_back({id, InitRejection::kTooFewViews});
    std::sort(rejected_.begin(), rejected_.end(),
              [](const InitRejectedPoint& a, const InitRejectedPoint& b) { return a.id < b.id; });
    outcome_.rejected = std::move(rejected_);
    outcome_.decision = InitDecision::kMap;
    outcome_.reason = "first map of " + std::to_string(ids_.size()) + " points from a deforming window of " +
                      std::to_string(input_.frames.size()) + " frames, predicted depth noise " +
                      Digits(100.0 * outcome_.measured.median_depth_sigma, 1) + " % of the median depth";
    return Status::Ok();
  }

  WindowInitOptions options_;
  double nominal_depth_mm_;
  const InitInput& input_;
  double focal_px_;
  InitOutcome& outcome_;
  std::vector<std::size_t> views_;    // frames of the input
  std::vector<PointId> ids_;          // of the problem's points, sorted
  std::vector<char> certain_;         // one a point
  std::map<PointId, double> sigmas_;  // of the distance, map units
  std::vector<InitRejectedPoint> rejected_;
  DeformingWindow start_;
};

class WindowInitializer final : public Initializer {
 public:
  WindowInitializer(const WindowInitOptions& options, double nominal_depth_mm)
      : options_(options), nominal_depth_mm_(nominal_depth_mm) {}

  std::string_view name() const override { return "window"; }
  bool TakesLaterPoints() const override { return true; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    const int since = static_cast<int>(input.frames.size()) - 1;
    const int followed = static_cast<int>(input.frames.back().observations.size());
    outcome.measured.correspondences = followed;
    if (followed < options_.min_points) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = "only " + std::to_string(followed) + " points are still followed (at least " +
                       std::to_string(options_.min_points) + " must be)";
      return outcome;
    }
    const bool ends = input.moment == InitMoment::kLastFrame;
    const bool due = since >= options_.first_frame && (since - options_.first_frame) % options_.every == 0;
    if (!due && !ends) {
      outcome.reason = "the window has " + std::to_string(since + 1) + " frames, with " + std::to_string(followed) +
                       " points; a map is first sought after " + std::to_string(options_.first_frame) +
                       ", then every " + std::to_string(options_.every);
      return outcome;
    }
    const std::size_t frames = input.frames.size();
    const bool last = ends || since + options_.every > options_.last_frame;
    Status status = Attempt(options_, nominal_depth_mm_, input, &outcome)
                        .Run(frames, last ? WhenUncertain::kTakeTheCertain : WhenUncertain::kWait);
    // The longer the window the more it holds, and the more there is to go wrong.
    if (last && !status.ok() &&
        Attempt(options_, nominal_depth_mm_, input, &outcome).Run(2 * frames / 3, WhenUncertain::kTakeTheCertain).ok())
      status = Status::Ok();
    if (!status.ok()) {
      outcome.decision = last ? InitDecision::kNewReference : InitDecision::kWait;
      outcome.reason = status.message();
      if (last) outcome.reason += "; given up after " + std::to_string(since) + " frames from one reference";
    }
    return outcome;
  }

 private:
  WindowInitOptions options_;
  double nominal_depth_mm_;
};

}  // namespace

void WindowInitOptions::List(OptionTable& table) {
  table.BeginGroup("WindowInit", "the first map from a deforming window (Init.method = window)");
  table.Add("first_frame", &first_frame, "frames", "a map is first sought so long after the reference", 2, 100000);
  table.Add("every", &every, "frames", "from one attempt to the next", 1, 100000);
  table.Add("last_frame", &last_frame, "frames", "a reference that made no map by then is given up", 2, 100000);
  table.Add("views", &views, "frames", "in the problem, spread evenly since the reference", 3, 1000);
  table.Add("min_views", &min_views, "frames", "of them in which a point must be seen", 2, 1000);
  table.Add("max_points", &max_points, "-", "in the problem: time grows with them", 12, 100000);
  table.Add("min_points", &min_points, "-", "fewer certain points in the last frame make no map", 12, 100000);
  table.Add("max_depth_sigma", &max_depth_sigma, "-",
            "a point whose predicted standard deviation of depth by the median depth is larger stays out", 1e-4, 10);
  table.Add("max_error_px", &max_error_px, "px", "a point with a larger error in the window stays out", 1e-3, 100);
  table.Add("min_certain_share", &min_certain_share, "-",
            "wait while a smaller share of the points still seen is certain", 0, 1);
  table.AddChoice("light", &light, "brightness as a hint of distance: the light is at the camera");
  table.Add("gamma", &gamma, "-", "of the camera's response, for the light", 0.1, 10);
  window.List(table);
}

std::unique_ptr<Initializer> MakeWindowInitializer(const WindowInitOptions& options, double nominal_depth_mm) {
  return std::make_unique<WindowInitializer>(options, nominal_depth_mm);
}

}  // namespace pliant
