// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/bootstrapping/camera_motion_check.h"
#include "tracking/bootstrapping/focal_length_check.h"
#include "tracking/bootstrapping/initial_map.h"
#include "tracking/bootstrapping/rotation_check.h"
#include "tracking/bootstrapping/window_map.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {
namespace {

constexpr int kMinWait = 6;             // frames after the reference, before the first of the other attempts
constexpr double kMaxLightError = 0.2;  // of log distance, in the median: twice what it is where there is light at all

// How many of the reference's points a frame sees.
int KeptPoints(const InitFrame& reference, const InitFrame& frame) {
  return static_cast<int>(std::ranges::count_if(frame.observations, [&](const InitObservation& seen) {
    return FindById(reference.observations, seen.id) != nullptr;
  }));
}

// A rigid scene whose depths differ by more than the light could be wrong by, and not as the light says. Halves that
// agree show that it is no other minimum.
bool ContradictsLightClearly(const SolvedWindow& window) {
  return !window.AllowsDeformation() && window.solution.window.cue == DistanceCue::kLight &&
         ContradictsLight(window.solution) && window.solution.light_error > kMaxLightError;
}

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
    if (const Status status = CheckIsFollowed(input); !status.ok()) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = status.message();
      return outcome;
    }
    const int needed = NeededPoints(input, options_);
    if (followed < needed) {
      outcome.decision = InitDecision::kNewReference;
      outcome.reason = "only " + std::to_string(followed) + " points are still followed (at least " +
                       std::to_string(needed) + " must be)";
      return outcome;
    }
    const bool ends = input.moment == InitMoment::kLastFrame;
    if (!IsDue(input) && !ends) {
      outcome.reason = "the window has " + std::to_string(since + 1) + " frames, with " + std::to_string(followed) +
                       " points; a map is first attempted after " + std::to_string(options_.first_frame) +
                       " frames, then every " + std::to_string(options_.every) +
                       ", or when half of the points are lost";
      return outcome;
    }
    const bool last = ends || NextRegularAttempt(since) > options_.last_frame;
    Status status = CheckWindowNotARotation(input, &outcome.measured);
    const bool is_rotation = !status.ok();
    if (status.ok()) status = last ? LastAttempt(input, &outcome) : Attempt(input, &outcome);
    if (options_.focal_length_check == Switch::kOn && (status.ok() || (last && !is_rotation)))
      outcome.measured.focal_length_factor = ContradictingFocalLengthFactor(input, options_, nominal_depth_mm_);
    if (status.ok()) status = CheckRigidity(input, last, &outcome);
    if (status.ok()) status = CheckHalves(&outcome);
    if (!status.ok()) {
      outcome.decision = last ? InitDecision::kNewReference : InitDecision::kWait;
      outcome.reason = status.message();
      if (last) outcome.reason = WithGivenUp(outcome.reason, since);
    }
    if (const double factor = outcome.measured.focal_length_factor; factor != 1.0)
      outcome.reason += "; the images contradict the focal length: a rigid scene fits clearly better with about " +
                        Digits(factor, 2) + " times it, " +
                        (input.camera_origin == CameraOrigin::kAssumed ? "calibrate or assume another field of view"
                                                                       : "check the calibration");
    if (!status.ok() && ends && since < options_.last_frame) outcome.reason += "; give more frames";
    return outcome;
  }

 private:
  // Whether a map is attempted in the last frame: every few frames, and whenever half of the reference's points that
  // were there in the last attempt have been lost.
  bool IsDue(const InitInput& input) const {
    const InitFrame& reference = input.frames.front();
    auto at_last_attempt = static_cast<int>(reference.observations.size());
    bool due = false;
    for (int since = 1; since < static_cast<int>(input.frames.size()); ++since) {
      const int now = KeptPoints(reference, input.frames[static_cast<std::size_t>(since)]);
      due = since == NextRegularAttempt(since - 1) || (since >= kMinWait && 2 * now <= at_last_attempt);
      if (due) at_last_attempt = now;
    }
    return due;
  }

  // The first frame after this one, counted since the reference, in which a map is attempted in any case.
  int NextRegularAttempt(int since) const {
    const int after_first = since + 1 - options_.first_frame;
    if (after_first <= 0) return options_.first_frame;
    return options_.first_frame + (after_first + options_.every - 1) / options_.every * options_.every;
  }

  // (W20) The sigmas of a rigid window know nothing of a deformation that is taken for depth. Where something says that
  // there is one its map is provisional, and none if it would be provisional anyway.
  Status CheckRigidity(const InitInput& input, bool last, InitOutcome* outcome) const {
    const bool contradicts = outcome->measured.focal_length_factor != 1.0;
    if (outcome->deforming || outcome->allows_deformation || !(contradicts || input.was_ambiguous)) return Status::Ok();
    const std::string why = contradicts ? "a rigid motion does not explain the images with this focal length"
                                        : "camera and scene could not be told apart by another reference";
    if (outcome->provisional)
      return {ErrorCode::kDegenerate,
              "the depths are not as certain as demanded, and " + why + "; " +
                  AdviceOnUncertainDepth(outcome->measured.median_parallax_deg, input.camera_origin)};
    if (!contradicts) return Status::Ok();
    if (options_.provisional == Switch::kOff) return {ErrorCode::kInsufficient, why};
    outcome->provisional = true;
    outcome->refinable = false;
    if (!last) outcome->decision = InitDecision::kProvisional;
    return Status::Ok();
  }

  // (W19) Sigmas of two halves are one sample of what a deformation adds: it may as well be twice that. A map whose
  // depths would hardly stand out then is taken at once, since a longer window knows no better, but it is provisional.
  Status CheckHalves(InitOutcome* outcome) const {
    const double signal = outcome->measured.DepthSignal();
    if (!outcome->allows_deformation || outcome->provisional || signal >= 2 * kMinProvisionalSignal)
      return Status::Ok();
    const std::string why = "the scene deforms, and its depths stand out " + Digits(signal, 1) +
                            " times from what a rigid window leaves open, where a certain map needs " +
                            Digits(2 * kMinProvisionalSignal, 1);
    if (options_.provisional == Switch::kOff) return {ErrorCode::kInsufficient, why};
    outcome->provisional = true;
    outcome->reason += "; it is provisional: " + why;
    return Status::Ok();
  }

  // What is missing for a map; ok when the outcome is one.
  Status Attempt(const InitInput& input, InitOutcome* outcome) const {
    const auto since = static_cast<int>(input.frames.size()) - 1;
    // Where points are lost so fast, more frames would not add to the window. So few make a provisional map at most.
    const InitFrame& reference = input.frames.front();
    const bool half_kept =
        2 * KeptPoints(reference, input.frames.back()) > static_cast<int>(reference.observations.size());
    const bool early = since < options_.deforming_frame;
    const WindowScene scene = early && half_kept ? WindowScene::kRigid : WindowScene::kAny;
    const auto window = SolveWindow(input, input.frames.size(), scene, options_, nominal_depth_mm_);
    Status status(ErrorCode::kInsufficient, "the scene deforms, and a window of " + std::to_string(since + 1) +
                                                " frames is too short for depths that are certain");
    if (!window.ok() || !early || !window->AllowsDeformation())
      status = Make(input, window, DemandsAfter(since), outcome);
    // In a scene that deforms depths that hardly stand out may do so later, and what they alone show be contradicted.
    if (status.ok() && window->AllowsDeformation() && (outcome->provisional || outcome->moves_by_depth))
      outcome->decision = InitDecision::kProvisional;
    if (status.ok()) return status;
    status = MakeProvisional(input, window, status, outcome);
    if (status.ok()) outcome->decision = InitDecision::kProvisional;
    return status;
  }

  Status LastAttempt(const InitInput& input, InitOutcome* outcome) const {
    const auto window = SolveWindow(input, input.frames.size(), WindowScene::kAny, options_, nominal_depth_mm_);
    Status status = LastMap(input, window, outcome);
    if (status.ok() || !window.ok() || outcome->ambiguous) return status;
    // What its depths lack may be that the camera moves.
    InitOutcome asked;
    asked.measured = outcome->measured;
    Status motion = CheckCameraMotion(input, *window, options_, &asked);
    if (motion.ok() || !asked.camera_may_stand_still) return status;
    outcome->measured.still_camera_error_ratio = asked.measured.still_camera_error_ratio;
    outcome->camera_may_stand_still = true;
    return motion;
  }

  // A sequence may end so early that its map must be certain all the same.
  Status LastMap(const InitInput& input, const Result<SolvedWindow>& window, InitOutcome* outcome) const {
    const auto since = static_cast<int>(input.frames.size()) - 1;
    Status status = Make(input, window, LastDemands(since), outcome);
    if (status.ok() || outcome->ambiguous) return status;
    // Where the depths hardly stand out, those of fewer frames do so by chance.
    if (window.ok() && status.code() == ErrorCode::kDegenerate) return status;
    // The longer the window the more it holds, and the more there is to go wrong.
    const int shorter = 2 * (since + 1) / 3;
    Status of_shorter = Make(
        input, SolveWindow(input, static_cast<std::size_t>(shorter), WindowScene::kAny, options_, nominal_depth_mm_),
        LastDemands(shorter - 1), outcome);
    if (of_shorter.ok() || outcome->ambiguous) return of_shorter;
    return MakeProvisional(input, window, status, outcome);
  }

  // After an attempt at a map that is certain came to nothing, with that `status`.
  Status MakeProvisional(const InitInput& input, const Result<SolvedWindow>& window, const Status& status,
                         InitOutcome* outcome) const {
    if (options_.provisional == Switch::kOff || !window.ok() || outcome->ambiguous) return status;
    // Where the depths of all points hardly stand out, those of fewer do so by chance.
    if (status.code() == ErrorCode::kDegenerate || ContradictsLightClearly(*window)) return status;
    Status missing = status;
    for (const bool far_by_own_distance : {false, true}) {
      // Sigmas of rigid windows know nothing of a deformation: they are not taken for more than they are.
      if (outcome->camera_may_stand_still || (far_by_own_distance && window->IsRigid())) break;
      const bool was_ambiguous = outcome->ambiguous;
      const MapDemands demands = ProvisionalDemands(window->solution.window, far_by_own_distance);
      Status made = MakeWindowMap(input, *window, demands, options_, nominal_depth_mm_, outcome);
      if (made.ok()) return made;
      if (outcome->ambiguous && !was_ambiguous) missing = std::move(made);
    }
    return missing;
  }

  MapDemands LastDemands(int since) const {
    return DemandsAfter(since < options_.deforming_frame ? since : options_.last_frame);
  }

  // The longer the wait the less it still gives, and the more points leave the image.
  MapDemands DemandsAfter(int since) const {
    const double waited = std::clamp(static_cast<double>(since - options_.deforming_frame) /
                                         std::max(1, options_.last_frame - options_.deforming_frame),
                                     0.0, 1.0);
    return DemandsOf(options_, waited * waited * waited);
  }

  Status Make(const InitInput& input, const Result<SolvedWindow>& window, const MapDemands& demands,
              InitOutcome* outcome) const {
    if (!window.ok()) return window.status();
    MapDemands least = demands;
    // Another minimum than the right one may look as certain: what no light confirms must be more so, and most of all
    // what the light contradicts.
    const MapDemands full = DemandsOf(options_, 0.0);
    if (window->light_is_of_no_use || ContradictsLightClearly(*window)) least = full;
    if (options_.light == Switch::kOff) {
      least.certain_sigma = std::min(least.certain_sigma, full.max_sigma);
      least.max_sigma = std::min(least.max_sigma, full.max_sigma);
    }
    return MakeWindowMap(input, *window, least, options_, nominal_depth_mm_, outcome);
  }

  WindowInitOptions options_;
  double nominal_depth_mm_;
};

}  // namespace

void WindowInitOptions::List(OptionTable& table) {
  table.BeginGroup("WindowInit", "the first map from a deforming window (Init.method = window)");
  table.Add("first_frame", &first_frame, "frames",
            "frames after the reference at which a map is first attempted; sooner when half of the points are lost", 2,
            100000);
  table.Add("every", &every, "frames", "frames between two attempts", 1, 100000);
  table.Add("deforming_frame", &deforming_frame, "frames",
            "frames after the reference before which only a rigid scene is attempted, or, once half of the points are "
            "lost, a provisional map of any scene",
            2, 100000);
  table.Add("last_frame", &last_frame, "frames",
            "frames after the reference at which it is given up if there is no map", 2, 100000);
  table.Add("views", &views, "frames", "frames in the bundle adjustment, spread evenly since the reference", 3, 1000);
  table.Add("rigid_views", &rigid_views, "frames", "the same for a rigid scene; a re-estimated map takes views", 3,
            1000);
  table.Add("min_views", &min_views, "frames",
            "minimum number of views in which a point is seen, and as large a share of rigid_views", 2, 1000);
  table.Add("min_frame_share", &min_frame_share, "-",
            "minimum share of all frames since the reference in which a point is seen to be added to the map", 0, 1);
  table.Add("max_points", &max_points, "-",
            "maximum number of points in the bundle adjustment; its time grows with them", 12, 100000);
  table.Add("min_points", &min_points, "-",
            "minimum number of certain points in the last frame; half of the reference's points where these are fewer",
            12, 100000);
  table.Add("max_correlation", &max_correlation, "-",
            "maximum correlation of the reprojection errors of neighbors, at least a patch apart, under a rigid "
            "motion; above "
            "it the scene deforms",
            -1, 1);
  table.Add("certain_depth_sigma", &certain_depth_sigma, "-",
            "maximum standard deviation of depth divided by the median depth, of a certain point, up to "
            "deforming_frame",
            1e-4, 10);
  table.Add("last_depth_sigma", &last_depth_sigma, "-", "the same at last_frame; it increases from deforming_frame on",
            1e-4, 10);
  table.Add("max_depth_sigma", &max_depth_sigma, "-",
            "maximum standard deviation of depth divided by the median depth, of a point of the map, unless "
            "those two are larger",
            1e-4, 10);
  table.Add("max_error_px", &max_error_px, "px", "maximum root mean square reprojection error of a point of the map",
            1e-3, 100);
  table.Add("min_certain_share", &min_certain_share, "-",
            "minimum share of certain points among those still seen; it decreases to 0 at last_frame", 0, 1);
  table.Add(
      "min_still_camera_ratio", &min_still_camera_ratio, "-",
      "minimum ratio of the reprojection errors of a camera that stands still to those of one that moves; below it "
      "camera and scene cannot be told apart, and a deforming window is no map; 0: not compared",
      0, 100);
  table.AddChoice("light", &light, "use brightness as a depth cue; the light source has to be at the camera");
  table.Add("gamma", &gamma, "-",
            "gamma of the camera's response, for the depth from brightness; a sequence's own photometric "
            "calibration overrides it",
            0.1, 10);
  table.AddChoice("refine_rigid", &refine_rigid,
                  "re-estimate the map from all frames since the reference, as long as the scene is rigid");
  window.List(table);
}

std::unique_ptr<Initializer> MakeWindowInitializer(const WindowInitOptions& options, double nominal_depth_mm) {
  return std::make_unique<WindowInitializer>(options, nominal_depth_mm);
}

}  // namespace pliant
