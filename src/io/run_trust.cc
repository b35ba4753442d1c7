// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_trust.h"

#include <algorithm>
#include <cctype>

#include "pliant/base/text.h"
#include "pliant/camera/assumed_camera.h"

namespace pliant {
namespace {

constexpr double kMinFrameShare = 0.85;  // with a map
constexpr double kMinCoverage = 0.5;
constexpr double kMinDoubtShare = 0.8;  // of the frames, in which a depth prior falls

std::int64_t FramesIn(const RunSummary& summary, TrackingState state) {
  const auto found = std::ranges::find(summary.states, state, [](const auto& count) { return count.first; });
  return found == summary.states.end() ? 0 : found->second;
}

std::string OfFrames(const RunSummary& summary) {
  std::string text =
      std::to_string(summary.frames_tracked) + " of " + std::to_string(summary.frames_read) + " frames have a map (" +
      Percent(static_cast<double>(summary.frames_tracked) / static_cast<double>(summary.frames_read), 0) + ")";
  const auto add = [&](TrackingState state, const std::string& what) {
    if (const auto count = FramesIn(summary, state); count > 0) text += "; in " + std::to_string(count) + " " + what;
  };
  add(TrackingState::kProvisional, "of them it is provisional");
  add(TrackingState::kAmbiguous, "camera and scene cannot be told apart");
  add(TrackingState::kLost, "it was lost");
  add(TrackingState::kWaitingForReference, "the image showed too little to start from");
  return text + ".";
}

// Some methods measure no spread.
bool HasMeasuredDepth(const FirstMapEvidence& evidence) {
  return evidence.depth_sigma > 0.0 && evidence.depth_spread > 0.0;
}

bool IsDepthKnown(const FirstMapEvidence& evidence) {
  return DepthSignal(evidence.depth_spread, evidence.depth_sigma) >= kMinDepthSignal;
}

std::string Capitalized(std::string sentence) {
  sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence.front())));
  return sentence;
}

// Sentences as one text; empty ones are left out.
std::string Joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences)
    if (!sentence.empty()) text += (text.empty() ? "" : " ") + sentence;
  return text;
}

// Of a refined run the map that it has is not the first one.
bool IsRefined(const RunSummary& summary) { return !summary.description.refined_from.empty(); }

bool HasEstimatedCamera(const RunSummary& summary) {
  return summary.description.refinement && summary.description.refinement->has_estimated_camera;
}

// Sentences on each map, in order; nothing where there is nothing to say.
template <class Sentence>
std::string OfMaps(const RunSummary& summary, Sentence sentence) {
  std::string text;
  for (std::size_t i = 0; i < summary.first_maps.size(); ++i) {
    std::string of_map = sentence(summary.first_maps[i].evidence);
    if (of_map.empty()) continue;
    if (!text.empty()) text += " ";
    text += summary.first_maps.size() > 1 ? "Map " + std::to_string(i) + ": " + of_map : Capitalized(of_map);
  }
  return text;
}

std::string OfDepth(const FirstMapEvidence& evidence) {
  if (!HasMeasuredDepth(evidence)) return {};
  const std::string numbers = "the first map's depths spread by " + Percent(evidence.depth_spread, 1) +
                              " and are known to " + Percent(evidence.depth_sigma, 1) + " (" +
                              std::to_string(evidence.points) + " points, parallax " +
                              Digits(evidence.median_parallax_deg, 1) + " deg): ";
  if (!IsDepthKnown(evidence)) return numbers + "they are hardly better than one constant depth.";
  return numbers + (evidence.provisional ? "the shape is there, but not as certain as demanded."
                                         : "the shape can be trusted to about that, if the calibration is right.");
}

// A certain map becomes provisional where its scene, which was taken for rigid, is found to deform (W13).
bool WasFoundToDeform(const RunSummary& summary) {
  const bool were_certain =
      std::ranges::none_of(summary.first_maps, [](const FirstMapFrames& map) { return map.evidence.provisional; });
  return were_certain && FramesIn(summary, TrackingState::kProvisional) > 0;
}

std::string OfRigidity(const RunSummary& summary) {
  if (!WasFoundToDeform(summary)) return {};
  return "The scene was taken for rigid and then found to deform: where the map is provisional its depths are known "
         "less well than that.";
}

std::string OfRefinedDepth(const RunSummary& summary) {
  const auto& refinement = summary.description.refinement;
  if (!refinement || !(refinement->depth_sigma > 0.0)) return {};
  return "All frames were solved for at once: points' distances from the camera are known to " +
         Percent(refinement->depth_sigma, 1) +
         " in the median (standard deviation), as far as the scene moves as it was taken to" +
         (HasEstimatedCamera(summary) ? "." : ", and if the calibration is right.");
}

std::string OfModel(RefinedModel model) {
  switch (model) {
    case RefinedModel::kRigid:
      return "the scene was taken for rigid, so that all motion is the camera's.";
    case RefinedModel::kDeforming:
      return "the scene was taken for deforming; what moves all of it alike counts as the camera's motion.";
    case RefinedModel::kUnchanged:
      break;
  }
  return "it could not be refined, and is as it was tracked.";
}

std::string OfModels(const RunSummary& summary) {
  if (!summary.description.refinement) return {};
  const std::vector<RefinedModel>& models = summary.description.refinement->models;
  std::string text;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (i > 0) text += " ";
    text +=
        models.size() > 1 ? "Submap " + std::to_string(i) + ": " + OfModel(models[i]) : Capitalized(OfModel(models[i]));
  }
  return text;
}

// A start from one image is provisional from the first frame on.
bool IsFromPriorAlone(const RunSummary& summary) {
  return std::ranges::any_of(summary.first_maps, [](const FirstMapFrames& map) {
    return map.evidence.provisional && !(map.evidence.depth_sigma > 0.0);
  });
}

std::string OfUseOfPrior(const RunSummary& summary) {
  const auto first_maps =
      std::ranges::count_if(summary.first_maps, [](const FirstMapFrames& map) { return map.evidence.uses_prior; });
  const std::int64_t maps = first_maps + summary.prior.reestimated_maps;
  if (maps > 0)
    return "A depth prior was given; " + std::to_string(maps) + (maps == 1 ? " map, " : " maps, ") +
           "first or re-estimated, took depths from it.";
  if (summary.prior.compared > 0) return "A depth prior was given and had no effect: no map took depths from it.";
  return "A depth prior was given; it counts where brightness is no depth cue.";
}

// What a start from one image took for granted, or what became of a weak measurement.
std::string OfPrior(const RunSummary& summary) {
  if (summary.description.depth_prior.empty()) return {};
  if (IsRefined(summary)) return "The run that was refined was tracked with a depth prior.";
  std::string doubt = DoubtOfPrior(summary);
  if (!doubt.empty()) doubt = Capitalized(doubt + (doubt.ends_with('?') ? "" : "."));
  if (IsFromPriorAlone(summary))
    return Joined(
        {"The first map's depths are those of the depth prior in one image, up to a scale; nothing confirmed "
         "them.",
         doubt});
  if (doubt.empty() && summary.prior.compared > 0)
    doubt = "It agrees with the map in " + std::to_string(summary.prior.agree) + " of " +
            std::to_string(summary.prior.compared) + " frames.";
  return Joined({OfUseOfPrior(summary), doubt});
}

std::string OfCamera(const FirstMapEvidence& evidence) {
  if (!(evidence.depth_sigma > 0.0)) return {};
  const bool was_tested = evidence.still_camera_error_ratio > 0.0;
  if (!evidence.deforming && !was_tested)
    return std::string("the scene was taken for rigid, so that all motion is the camera's") +
           (HasMeasuredDepth(evidence) ? "." : "; whether the camera moved at all was not tested.");
  if (!was_tested) return "the scene deforms; whether the camera moves was not tested.";
  const std::string by_errors =
      std::string(evidence.deforming ? "the scene deforms"
                                     : "the scene deforms, but so little that a rigid map knows its depths better") +
      "; with a camera that stands still the errors would be " + Digits(evidence.still_camera_error_ratio, 2) +
      " times as large, ";
  if (!evidence.moves_by_depth) return by_errors + "so it moved.";
  return by_errors + "too little to tell in so much noise; that it moved is said by the depths, which stand out.";
}

std::string OfTrackedCamera(const RunSummary& summary) {
  return Joined({OfMaps(summary, OfCamera),
                 WasFoundToDeform(summary)
                     ? "Later it was found to deform: from then on a part of the motion may be the scene's."
                     : ""});
}

std::string OfCalibration(const FirstMapEvidence& evidence) {
  if (evidence.focal_length_factor == 1.0) return {};
  return "the images contradict the calibration: with about " + Digits(evidence.focal_length_factor, 2) +
         " times its focal length a rigid scene explains them clearly better. If the calibration is wrong, so are the "
         "shapes.";
}

std::string OfAssumedCamera(const RunDescription& run) {
  if (!IsAssumedCamera(run.camera)) return {};
  return "The camera is not calibrated; " + run.camera +
         " degrees were assumed. If that is wrong, so are depths and motion.";
}

std::string WhyFocalLengthWasKept(const RunSummary& summary) {
  return summary.description.refinement ? summary.description.refinement->focal_length_kept : "";
}

std::string OfKeptFocalLength(const RunSummary& summary) {
  const std::string why = WhyFocalLengthWasKept(summary);
  return why.empty() ? "" : "The refinement was to estimate the focal length and kept it: " + why + ".";
}

// The topic calibration says what an assumed camera means.
std::string OfRecording(const RunDescription& run) {
  std::vector<std::string> sentences;
  for (const std::string& warning : run.warnings)
    if (!warning.starts_with(kAssumedCameraWarning)) sentences.push_back(warning + ".");
  return Joined(sentences);
}

std::string OfImages(const RunDescription& run) {
  if (!(run.track_noise_px > 0.0)) return {};
  // None is seen in images that are black.
  const std::string noise = Digits(run.image_noise_levels, 1);
  return (noise == "0.0"
              ? "In the first images points are tracked to "
              : "The first images have a noise of " + noise + " gray levels; points are tracked in them to ") +
         Digits(run.track_noise_px, 2) + " px (working image), and " + Percent(run.alive_after_9, 0) +
         " of the corners last nine frames.";
}

// Whether points have displacements of their own in every frame.
bool HasDisplacements(const RunSummary& summary) {
  if (const auto& refinement = summary.description.refinement)
    return std::ranges::find(refinement->models, RefinedModel::kDeforming) != refinement->models.end();
  return FramesIn(summary, TrackingState::kProvisional) > 0 ||
         std::ranges::any_of(summary.first_maps, [](const FirstMapFrames& map) { return map.evidence.deforming; });
}

std::string OfTracks(const RunSummary& summary) {
  // Points of a map that deforms are nearly where the images have them: two decimals would say 0.00.
  const double error_px = summary.median_reprojection_error_px;
  return "Points lie " + (error_px < 0.01 ? "less than 0.01" : Digits(error_px, 2)) +
         " px from where the map has them, in the median (pixels of the source)" +
         (HasDisplacements(summary)
              ? "; their displacements take up the error, so that it does not say whether they are right. "
              : ". ") +
         "Points were tracked in images of " + Digits(summary.description.image_scale, 2) + " times the source's size.";
}

std::string OfCoverage(const RunSummary& summary) {
  const std::string of_map = Percent(summary.median_coverage, 0);
  const std::string followed = Percent(summary.median_followed_coverage, 0);
  std::string text =
      "In the median frame " + of_map + " of the scene lies near a point (within 1/32 of the image's width)";
  if (summary.median_followed_coverage > summary.median_coverage && followed != of_map)
    text += ", and " + followed + " with points that are followed but whose depth is not certain enough for the map";
  return text + ".";
}

// The most parallax of the maps whose depths are hardly known; negative: there is none.
double ParallaxOfUncertainMaps(const RunSummary& summary) {
  double parallax_deg = -1.0;
  if (IsRefined(summary)) return parallax_deg;
  for (const FirstMapFrames& map : summary.first_maps)
    if (HasMeasuredDepth(map.evidence) && !IsDepthKnown(map.evidence))
      parallax_deg = std::max(parallax_deg, map.evidence.median_parallax_deg);
  return parallax_deg;
}

std::string AdviceOnDepth(const RunSummary& summary) {
  const double parallax_deg = ParallaxOfUncertainMaps(summary);
  if (parallax_deg < 0.0) return {};
  return (parallax_deg < kEnoughParallaxDeg
              ? std::string("Depth needs more parallax: move the camera sideways, and further by the distance of the "
                            "tissue.")
              : Capitalized(AdviceOnUncertainDepth(parallax_deg, OriginOf(summary.description.camera))) + ".") +
         " Compare a run begun at another frame: pliant evaluate tells how far they agree.";
}

std::string Advice(const RunSummary& summary) {
  std::vector<std::string> advice;
  const auto count = [&](auto test) {
    return std::ranges::any_of(summary.first_maps, [&](const FirstMapFrames& map) { return test(map.evidence); });
  };
  if (FramesIn(summary, TrackingState::kAmbiguous) > 0)
    advice.emplace_back(
        "If the camera does stand still, start from depth (--Init.method depth --Tracking.camera_motion none), or from "
        "a network's (--depth_prior DIR --Init.method depth_prior --Tracking.camera_motion none); if it moves, move it "
        "further and not evenly.");
  advice.push_back(AdviceOnDepth(summary));
  if (!HasEstimatedCamera(summary) && count([](const FirstMapEvidence& e) { return e.focal_length_factor != 1.0; }))
    advice.emplace_back("Calibrate the camera, or check that the calibration is of this lens, zoom and image size.");
  else if (IsAssumedCamera(summary.description.camera))
    advice.push_back("Calibrate the camera (pliant calibrate)" +
                     std::string(summary.frames_tracked == 0 || !WhyFocalLengthWasKept(summary).empty()
                                     ? "."
                                     : ", or let pliant refine estimate its focal length where the scene is rigid."));
  if (FramesIn(summary, TrackingState::kLost) > 0)
    advice.emplace_back("Where the map was lost, look for tools, smoke and fast motion; a mask over tools helps.");
  const bool is_sparse = summary.median_coverage > 0.0 && summary.median_coverage < kMinCoverage;
  if (is_sparse && summary.median_followed_coverage < kMinCoverage)
    advice.emplace_back("Much of the scene has no point: raise --Corners.max_corners, or check the mask.");
  else if (is_sparse && ParallaxOfUncertainMaps(summary) < kEnoughParallaxDeg)
    advice.emplace_back("Much of the scene has points whose depth is not certain: move the camera sideways.");
  const std::int64_t explained = summary.frames_tracked + FramesIn(summary, TrackingState::kWaitingForReference);
  // A run without any says in its note what the references lacked.
  if (summary.frames_tracked > 0 &&
      static_cast<double>(explained) < kMinFrameShare * static_cast<double>(summary.frames_read) &&
      FramesIn(summary, TrackingState::kAmbiguous) == 0)
    advice.emplace_back("Where there is no map, the camera moved too little or the points lasted too briefly.");
  if (const std::string on_skipped = AdviceOnSkippedImages(summary); !on_skipped.empty())
    advice.push_back(on_skipped + ".");
  return Joined(advice);
}

}  // namespace

std::string AdviceOnSkippedImages(const RunSummary& summary) {
  if (!summary.stream || summary.stream->skipped == 0 || summary.frames_tracked > 0) return {};
  return std::to_string(summary.stream->skipped) + " of " + std::to_string(summary.stream->received) +
         " images were skipped, which makes points harder to follow: track all with --LiveInput.frames all, or what "
         "was "
         "recorded with pliant track " +
         summary.description.input;
}

std::string DoubtOfPrior(const RunSummary& summary) {
  const PriorCounts& prior = summary.prior;
  if (prior.fall == 0 || static_cast<double>(prior.fall) < kMinDoubtShare * static_cast<double>(prior.compared))
    return {};
  const std::string numbers = " in " + std::to_string(prior.fall) + " of " + std::to_string(prior.compared) +
                              " frames: is it of the other DepthPrior.kind?";
  if (prior.by_brightness == 0) return "the depth prior falls where the map's values grow" + numbers;
  return "the depth prior falls where by brightness it should grow" + numbers +
         " Where the light is not at the camera, set WindowInit.light off";
}

std::vector<std::pair<std::string, std::string>> TrustIn(const RunSummary& summary) {
  std::vector<std::pair<std::string, std::string>> trust;
  const auto add = [&](const std::string& topic, std::string text) {
    if (!text.empty()) trust.emplace_back(topic, std::move(text));
  };
  if (summary.frames_read == 0) return trust;
  add("frames", OfFrames(summary));
  add("depth", IsRefined(summary) ? OfRefinedDepth(summary) : Joined({OfMaps(summary, OfDepth), OfRigidity(summary)}));
  add("depth_prior", OfPrior(summary));
  add("camera", IsRefined(summary) ? OfModels(summary) : OfTrackedCamera(summary));
  add("calibration",
      HasEstimatedCamera(summary)
          ? "The camera's focal length was estimated together with the scene."
          : Joined({OfAssumedCamera(summary.description), OfKeptFocalLength(summary), OfMaps(summary, OfCalibration)}));
  add("recording", OfRecording(summary.description));
  add("images", OfImages(summary.description));
  if (summary.median_reprojection_error_px > 0.0) add("tracks", OfTracks(summary));
  if (summary.median_coverage > 0.0) add("coverage", OfCoverage(summary));
  add("advice", Advice(summary));
  return trust;
}

}  // namespace pliant
