// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Initialization that waits until two views can carry a map. Cheap tests come first, because an attempt is made in
// every frame while waiting: counts, then the pure rotation, then RANSAC, refinement, parallax, competing motions; the
// map's own refinement over all frames runs once, when everything else has passed.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/geometry/triangulation.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/initial_map.h"
#include "tracking/bootstrapping/rotation_check.h"

namespace pliant {
namespace {

// Motions whose translations are this near (and the rotations likewise) are the same motion.
constexpr double kSameMotionRad = 5.0 / kDegPerRad;
// Costs are compared as if every point had at least this error: exact data must not turn rounding into evidence.
constexpr double kMinInlierErrorPx = 0.02;
// A competing motion has to put nearly as many points in front of the cameras as the one it is compared with.
constexpr double kCompetingFrontShare = 0.9;

struct PairMotion {
  Rigid3 cam1_from_cam0;
  std::vector<char> inliers;
  int num_inliers = 0;
  double cost = 0;  // robust, of the correspondences compared
};

// What a pair's motion goes through before its cost is compared.
auto PairRefinement(RigidRefinement refinement) {
  switch (refinement) {
    case RigidRefinement::kNone:
      return &AssessTwoView;
    case RigidRefinement::kOpengv:
      return &RefineTwoViewByOpengv;
    default:
      return &RefineTwoView;
  }
}

bool SameMotion(const Rigid3& a, const Rigid3& b) {
  return AngleBetween(a.translation, b.translation) < kSameMotionRad &&
         RotationAngle(a.rotation * b.rotation.conjugate()) < kSameMotionRad;
}

// One attempt on one pair of frames.
class Attempt {
 public:
  Attempt(const MonocularInitOptions& options, const InitInput& input, Random random, InitOutcome* outcome)
      : options_(options),
        input_(input),
        random_(random),
        focal_px_(input.camera.MeanFocalLengthPx()),
        matched_(MatchRays(input.camera, input.frames.front(), input.frames.back())),
        outcome_(*outcome) {
    outcome_.measured.correspondences = static_cast<int>(matched_.ids.size());
  }

  // Whether this reference can still make a map; if not, waiting does not help.
  Status ReferenceServes() const {
    const int kept = static_cast<int>(matched_.ids.size());
    const std::size_t had = input_.frames.front().observations.size();
    const double share = had == 0 ? 0.0 : static_cast<double>(kept) / static_cast<double>(had);
    if (kept >= options_.min_points && share >= options_.min_kept_share) return Status::Ok();
    return {ErrorCode::kInsufficient, "only " + std::to_string(kept) + " of the reference's " + std::to_string(had) +
                                          " points are still followed (at least " +
                                          std::to_string(options_.min_points) + " and " +
                                          Percent(options_.min_kept_share) + " must be)"};
  }

  // What is missing for a map; ok when the outcome is one.
  Status Run() {
    if (Status status = MoreThanARotation(); !status.ok()) return status;
    if (Status status = FindMotion(); !status.ok()) return status;
    if (Status status = EnoughParallax(); !status.ok()) return status;
    if (Status status = CompareCompetingMotions(); !status.ok()) return status;
    return MakeMap();
  }

 private:
  Status MoreThanARotation() {
    const auto rotation =
        CheckNotARotation(matched_, focal_px_, options_.max_error_px, options_.max_rotation_share, &outcome_.measured);
    if (!rotation.ok()) return rotation.status();
    rotation_only_ = rotation->cam1_from_cam0;
    return Status::Ok();
  }

  // RANSAC, then the motion refined by the options on its inliers, twice: a better motion has better inliers.
  Status FindMotion() {
    const auto ransac = EstimateMotion(matched_, focal_px_, options_, random_);
    if (!ransac.ok()) return ransac.status();
    motion_ = {ransac->cam1_from_cam0, ransac->inliers, ransac->num_inliers, 0.0};
    constexpr int kRounds = 2;
    for (int round = 0; round < kRounds; ++round)
      if (Status status = Refine(motion_.cam1_from_cam0, motion_.inliers, &motion_); !status.ok()) return status;
    outcome_.measured.inliers = motion_.num_inliers;
    const double share = static_cast<double>(motion_.num_inliers) / static_cast<double>(matched_.ids.size());
    if (share >= options_.min_inlier_share && motion_.num_inliers >= options_.min_points) return Status::Ok();
    return {ErrorCode::kInsufficient,
            "only " + std::to_string(motion_.num_inliers) + " of " + std::to_string(matched_.ids.size()) +
                " points agree with one rigid motion (at least " + Percent(options_.min_inlier_share) + " must)"};
  }

  // The rays in both views of the correspondences flagged in `used`.
  std::array<std::vector<Eigen::Vector3d>, 2> RaysOf(const std::vector<char>& used) const {
    std::array<std::vector<Eigen::Vector3d>, 2> rays;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] == 0) continue;
      rays[0].push_back(matched_.rays0[i]);
      rays[1].push_back(matched_.rays1[i]);
    }
    return rays;
  }

  // Refines `start` by the options on those flagged in `used` and finds the inliers of the result among all.
  Status Refine(const Rigid3& start, const std::vector<char>& used, PairMotion* motion) const {
    const auto [rays0, rays1] = RaysOf(used);
    const auto refined = PairRefinement(options_.refinement)(start, rays0, rays1, focal_px_, {});
    if (!refined.ok()) return refined.status();
    PairMotion result;
    result.cam1_from_cam0 = FacingForwards(refined->cam1_from_cam0, rays0, rays1);
    result.cost = refined->cost;
    const double max_error_rad = std::atan(options_.max_error_px / focal_px_);
    for (std::size_t i = 0; i < used.size(); ++i) {
      result.inliers.push_back(
          AgreesWithMotion(result.cam1_from_cam0, matched_.rays0[i], matched_.rays1[i], max_error_rad) ? 1 : 0);
      result.num_inliers += result.inliers.back();
    }
    *motion = std::move(result);
    return Status::Ok();
  }

  // Epipolar errors do not see the translation's sign; the points in front of the cameras do.
  static Rigid3 FacingForwards(const Rigid3& motion, const std::vector<Eigen::Vector3d>& rays0,
                               const std::vector<Eigen::Vector3d>& rays1) {
    const Rigid3 opposite(motion.rotation, -motion.translation);
    int vote = 0;
    for (std::size_t i = 0; i < rays0.size(); ++i) {
      vote += TriangulateIdwm(motion, rays0[i], rays1[i]).ok() ? 1 : 0;
      vote -= TriangulateIdwm(opposite, rays0[i], rays1[i]).ok() ? 1 : 0;
    }
    return vote >= 0 ? motion : opposite;
  }

  Status EnoughParallax() {
    std::vector<double> parallaxes;
    for (std::size_t i = 0; i < matched_.ids.size(); ++i)
      if (motion_.inliers[i] != 0)
        parallaxes.push_back(ParallaxAngle(motion_.cam1_from_cam0.rotation, matched_.rays0[i], matched_.rays1[i]));
    outcome_.measured.median_parallax_deg = Median(std::move(parallaxes)) * kDegPerRad;
    if (outcome_.measured.median_parallax_deg >= options_.min_parallax_deg) return Status::Ok();
    return {ErrorCode::kInsufficient, "the median parallax is " + Digits(outcome_.measured.median_parallax_deg, 2) +
                                          " deg, " + Digits(options_.min_parallax_deg, 2) + " are needed"};
  }

  // Other motions that may explain the same points: those of the dominant plane, and translations along the axes with
  // the rotation that explains most alone (the ambiguity of small rotations and sideways translations).
  std::vector<Rigid3> CompetingStarts() const {
    std::vector<Rigid3> starts;
    const auto plane =
        FitHomography(matched_.rays0, matched_.rays1, focal_px_, options_.max_error_px, random_.Child("homography"));
    if (plane.ok()) starts = MotionsFromHomography(plane->cam1_from_cam0, matched_.rays0);
    for (int axis = 0; axis < 3; ++axis)
      starts.emplace_back(rotation_only_, Eigen::Vector3d(Eigen::Vector3d::Unit(axis)));
    return starts;
  }

  // Refines every competing motion on the same points. A better one replaces the motion; one that is about as good, and
  // is another motion, means that the data do not determine the answer, as it is with a plane seen without bumps.
  Status CompareCompetingMotions() {
    const std::vector<char> used = motion_.inliers;
    if (Status status = Refine(motion_.cam1_from_cam0, used, &motion_); !status.ok()) return status;
    const double floor = 0.5 * motion_.num_inliers * kMinInlierErrorPx * kMinInlierErrorPx;
    std::vector<PairMotion> competing;
    for (const Rigid3& start : CompetingStarts()) {
      PairMotion other;
      if (!Refine(start, used, &other).ok()) continue;
      if (other.num_inliers < kCompetingFrontShare * motion_.num_inliers) continue;
      if (other.cost < motion_.cost) std::swap(other, motion_);
      competing.push_back(std::move(other));
    }
    double ratio = std::numeric_limits<double>::infinity();
    for (const PairMotion& other : competing)
      if (!SameMotion(other.cam1_from_cam0, motion_.cam1_from_cam0)) ratio = std::min(ratio, CostRatio(other, floor));
    outcome_.measured.competing_cost_ratio = ratio;
    outcome_.measured.inliers = motion_.num_inliers;
    if (ratio >= options_.min_competing_cost_ratio) return EnoughParallax();
    return {ErrorCode::kDegenerate,
            "a second camera motion fits as well (" + Digits(ratio, 2) + " times the cost, " +
                Digits(options_.min_competing_cost_ratio, 2) +
                " are needed): the points lie in a plane or move too little; more parallax or relief is needed"};
  }

  // Over the pairs that both agree with: an outlier that agrees with one alone, by chance, is no evidence.
  double CostRatio(const PairMotion& other, double floor) const {
    std::vector<char> both = other.inliers;
    for (std::size_t i = 0; i < both.size(); ++i) both[i] &= motion_.inliers[i];
    const auto rays = RaysOf(both);
    const auto cost = [&](const PairMotion& motion) {
      const auto assessed = AssessTwoView(motion.cam1_from_cam0, rays[0], rays[1], focal_px_, {});
      return assessed.ok() ? assessed->cost + floor : std::numeric_limits<double>::infinity();
    };
    return cost(other) / cost(motion_);
  }

  Status MakeMap() {
    InitialMap map = TriangulateInliers(motion_.cam1_from_cam0, motion_.inliers, focal_px_, options_, &matched_);
    std::vector<KnownPose> known(input_.frames.size());
    known.front().known = true;
    known.back() = {true, motion_.cam1_from_cam0};
    if (static_cast<int>(map.ids.size()) < options_.min_points) return TooFewPoints(map);
    if (options_.refinement == RigidRefinement::kWindow)
      if (Status status = RefineMap(&map, &known); !status.ok()) return status;
    DropUncertain(options_.max_depth_sigma, &map);
    if (static_cast<int>(map.ids.size()) < options_.min_points) return TooFewPoints(map);

    std::vector<double> relative_sigmas;
    for (std::size_t i = 0; i < map.ids.size(); ++i)
      relative_sigmas.push_back(map.depth_sigmas[i] / map.positions[i].norm());
    outcome_.measured.median_depth_sigma = Median(std::move(relative_sigmas));
    if (outcome_.measured.median_depth_sigma > options_.max_median_depth_sigma)
      return {ErrorCode::kInsufficient, "the predicted depth noise is " +
                                            Digits(100.0 * outcome_.measured.median_depth_sigma, 1) + " %, at most " +
                                            Digits(100.0 * options_.max_median_depth_sigma, 1) + " % is accepted"};

    const auto poses = EstimateFramePoses(input_, map, std::move(known), {});
    if (!poses.ok()) return poses.status();
    outcome_.reason = "first map of " + std::to_string(map.ids.size()) + " points, " +
                      std::to_string(input_.frames.size() - 1) + " frames after the reference, median parallax " +
                      Digits(outcome_.measured.median_parallax_deg, 2) + " deg, predicted depth noise " +
                      Digits(100.0 * outcome_.measured.median_depth_sigma, 1) + " %";
    return FillRigidMap(input_, map, *poses, matched_.rejected, options_.nominal_depth_mm, &outcome_);
  }

  Status TooFewPoints(const InitialMap& map) const {
    return {ErrorCode::kInsufficient, "only " + std::to_string(map.ids.size()) +
                                          " points have a certain depth, at least " +
                                          std::to_string(options_.min_points) + " are needed"};
  }

  // Keeps the points for which keep(i) holds and books the others under `reason`.
  template <class Keep>
  void Filter(InitRejection reason, Keep keep, InitialMap* map) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < map->ids.size(); ++i) {
      if (!keep(i)) {
        matched_.rejected.push_back({map->ids[i], reason});
        continue;
      }
      map->ids[kept] = map->ids[i];
      map->positions[kept] = map->positions[i];
      map->depth_sigmas[kept] = map->depth_sigmas[i];
      map->parallaxes_rad[kept] = map->parallaxes_rad[i];
      ++kept;
    }
    map->ids.resize(kept);
    map->positions.resize(kept);
    map->depth_sigmas.resize(kept);
    map->parallaxes_rad.resize(kept);
  }

  void DropUncertain(double max_relative_sigma, InitialMap* map) {
    Filter(
        InitRejection::kUncertainDepth,
        [&](std::size_t i) { return map->depth_sigmas[i] <= max_relative_sigma * map->positions[i].norm(); }, map);
  }

  // Bundle adjustment over the window. Points that it cannot determine are left out before it: far ones hardly help.
  Status RefineMap(InitialMap* map, std::vector<KnownPose>* known) {
    constexpr double kStartErrorFactor = 2.0;  // the pair's depths carry more noise than the window's
    constexpr double kBeforeWindow = 3.0;      // the window improves a depth by less than this
    DropUncertain(kBeforeWindow * options_.max_depth_sigma, map);
    if (static_cast<int>(map->ids.size()) < options_.min_points) return TooFewPoints(*map);
    const std::vector<std::size_t> frames =
        SpreadViews(input_.frames.size(), static_cast<std::size_t>(options_.window_frames));
    Window window;
    window.points_in_world = map->positions;
    window.cams_from_world.assign(frames.size(), known->back().cam_from_world);
    for (std::size_t k = frames.size() - 1; k-- > 0;) {
      const auto pose =
          k == 0 ? Result<Rigid3>(Rigid3())
                 : EstimateFramePose(input_.camera, input_.frames[frames[k]], *map, window.cams_from_world[k + 1], {});
      if (!pose.ok()) return pose.status();
      window.cams_from_world[k] = *pose;
    }
    AddObservations(frames, *map, &window);
    // A point that is wrong between the pair's frames would run to infinity and spoil the normal equations.
    DropContradicted(window, kStartErrorFactor * options_.max_error_px, map);
    if (static_cast<int>(map->ids.size()) < options_.min_points) return TooFewPoints(*map);
    window.points_in_world = map->positions;
    AddObservations(frames, *map, &window);
    const auto refined = RefineWindow(window, focal_px_, WindowPoints::kRefined, {});
    if (!refined.ok()) return refined.status();
    outcome_.measured.median_error_px = refined->median_error_px;
    for (std::size_t k = 0; k < frames.size(); ++k) (*known)[frames[k]] = {true, refined->window.cams_from_world[k]};
    Adopt(refined->window, map);
    return Status::Ok();
  }

  // An observation behind its camera contradicts the start; without it the window decides.
  void AddObservations(const std::vector<std::size_t>& frames, const InitialMap& map, Window* window) const {
    window->observations.clear();
    for (std::size_t k = 0; k < frames.size(); ++k)
      for (const WindowObservation& observation :
           ObservationsOf(input_.camera, input_.frames[frames[k]], map.ids, static_cast<int>(k))) {
        const Eigen::Vector3d x =
            window->cams_from_world[k] * map.positions[static_cast<std::size_t>(observation.point_idx)];
        if (x.dot(observation.ray) > 0.0) window->observations.push_back(observation);
      }
    std::stable_sort(window->observations.begin(), window->observations.end(),
                     [](const WindowObservation& a, const WindowObservation& b) { return a.point_idx < b.point_idx; });
  }

  // Takes over the refined points with their new predictions, without those that contradict the refined window.
  void Adopt(const Window& window, InitialMap* map) {
    map->positions = window.points_in_world;
    for (std::size_t i = 0; i < map->ids.size(); ++i) {
      const Eigen::Matrix3d covariance =
          PointCovariance(window.cams_from_world, map->positions[i], options_.sigma_px / focal_px_);
      map->depth_sigmas[i] = DepthSigma(covariance, map->positions[i]);
    }
    DropContradicted(window, options_.max_error_px, map);
  }

  // Drops the points whose root mean square error over the window's views is larger; they are the window's points.
  void DropContradicted(const Window& window, double max_error_px, InitialMap* map) {
    std::vector<double> squares(map->ids.size(), 0.0);
    std::vector<int> counts(map->ids.size(), 0);
    for (const WindowObservation& observation : window.observations) {
      const auto i = static_cast<std::size_t>(observation.point_idx);
      const Rigid3& cam_from_world = window.cams_from_world[static_cast<std::size_t>(observation.view_idx)];
      const Eigen::Vector3d x = cam_from_world * window.points_in_world[i];
      squares[i] += std::pow(focal_px_ * AngleBetween(x, observation.ray), 2);
      ++counts[i];
    }
    Filter(
        InitRejection::kReprojection,
        [&](std::size_t i) { return squares[i] <= counts[i] * max_error_px * max_error_px; }, map);
  }

  const MonocularInitOptions& options_;
  const InitInput& input_;
  Random random_;
  double focal_px_;
  MatchedRays matched_;
  InitOutcome& outcome_;
  Eigen::Quaterniond rotation_only_ = Eigen::Quaterniond::Identity();
  PairMotion motion_;
};

class GatedInitializer final : public Initializer {
 public:
  GatedInitializer(const MonocularInitOptions& options, Random random) : options_(options), random_(random) {}

  std::string_view name() const override { return "gated"; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    const int since = static_cast<int>(input.frames.size()) - 1;
    if (const Status status = CheckIsFollowed(input); !status.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = status.message();
      return outcome;
    }
    if (since < 1) {
      outcome.reason = "this is the reference frame";
      return outcome;
    }
    Attempt attempt(options_, input, random_, &outcome);
    if (Status status = attempt.ReferenceServes(); !status.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = status.message();
    } else if (status = attempt.Run(); !status.ok()) {
      outcome.decision = since >= options_.max_window ? InitDecision::kNewReference : InitDecision::kWait;
      outcome.reason = status.message();
      if (since >= options_.max_window) outcome.reason = WithGivenUp(outcome.reason, since);
    }
    return outcome;
  }

 private:
  MonocularInitOptions options_;
  Random random_;
};

}  // namespace

std::unique_ptr<Initializer> MakeGatedInitializer(const MonocularInitOptions& options, Random random) {
  return std::make_unique<GatedInitializer>(options, random);
}

}  // namespace pliant
