// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <optional>
#include <string>

#include "evaluation/format_text.h"
#include "pliant/evaluation/report.h"

namespace pliant {
namespace {

std::string Row(const char* name, double estimate, double null) {
  return FormatText("  %-38s %10.3f %10.3f\n", name, estimate, null);
}

std::string ProtocolRows(const ProtocolError& e) {
  const std::string name(EnumName(e.protocol));
  return Row((name + ": RMSE, mean over frames").c_str(), e.estimate.mean_rmse_mm, e.null.mean_rmse_mm) +
         Row((name + ": median").c_str(), e.estimate.pooled_median_mm, e.null.pooled_median_mm) +
         Row((name + ": left out, %").c_str(), 100 * e.estimate.left_out_share, 100 * e.null.left_out_share);
}

std::string PointTable(const char* title, const PointError& e) {
  const PointSummary& estimate = e.plain.estimate;
  const PointSummary& null = e.plain.null;
  const std::string head = std::string(title) + ", mm (scale " + std::string(EnumName(e.scale)) + ")";
  std::string text = FormatText("%-40s %10s %10s\n", head.c_str(), "estimate", "null");
  text += Row("RMSE, mean over frames", estimate.mean_rmse_mm, null.mean_rmse_mm);
  text += Row("RMSE, all points", estimate.pooled_rmse_mm, null.pooled_rmse_mm);
  text += Row("median, all points", estimate.pooled_median_mm, null.pooled_median_mm);
  text += Row("median, mean over frames", estimate.mean_median_mm, null.mean_median_mm);
  text += Row("relative depth, median, %", 100 * estimate.median_relative_depth, 100 * null.median_relative_depth);
  for (const ProtocolError& protocol : e.protocols)
    if (protocol.protocol != ErrorProtocol::kPaper) text += ProtocolRows(protocol);
  text +=
      FormatText("  scale %.4f to %.4f; %d points in %zu frames; the RMSE and medians above leave none of them out\n",
                 estimate.min_scale, estimate.max_scale, e.points, e.plain.frames.size());
  if (e.truth_sigma_mm > 0)
    text +=
        FormatText("  the truth is measured too: its own uncertainty is %.3f mm, root mean square\n", e.truth_sigma_mm);
  const int observations = e.points + e.left_out.Total();
  return text +
         FormatText("  without truth: %.1f %% of %d observations: ", 100.0 * e.left_out.Total() / observations,
                    observations) +
         Describe(e.left_out) + "\n";
}

std::string UncertaintyTable(const UncertaintyError& e) {
  return FormatText(
             "uncertainty (of the distance of a point; %d observations)\n  within 1 sigma %.1f %%, within 2 sigma "
             "%.1f %% (68.3 and 95.4 where the sigmas are right); NEES %.2f\n",
             e.points, 100 * e.within_1_sigma, 100 * e.within_2_sigma, e.nees) +
         FormatText(
             "  sigma %.2f %% of the distance, median; without the least certain half the RMSE is %.2f of all, of the "
             "worst half %.2f\n",
             100 * e.median_sigma, e.curve[UncertaintyError::kSteps / 2], e.oracle[UncertaintyError::kSteps / 2]);
}

std::string DenseRow(const char* what, const DepthFigures& f) {
  return FormatText("  %-26s %8.4f %8.3f %8.3f %8.4f %7.1f %7.1f %7.1f\n", what, f.abs_rel, f.sq_rel_mm, f.rmse_mm,
                    f.rmse_log, 100 * f.within_mm[0], 100 * f.within_mm[1], 100 * f.within_mm[2]);
}

std::string DenseRow(const char* what, const std::optional<DepthFigures>& f) { return f ? DenseRow(what, *f) : ""; }

std::string DenseRow(const char* what, const std::optional<VertexFigures>& f) {
  return f ? DenseRow(what, f->depth) : "";
}

std::string SigmaRow(const char* what, const std::optional<VertexFigures>& f) {
  if (!f || !f->within_sigma) return "";
  return FormatText("  %s: within 1 sigma %.1f %%, 2 sigma %.1f %%\n", what, 100 * (*f->within_sigma)[0],
                    100 * (*f->within_sigma)[1]);
}

std::string DenseTable(const DenseError& e) {
  const std::string without =
      e.frames_without_depth > 0 ? FormatText(", %d more have no depth", e.frames_without_depth) : "";
  const std::string scale(EnumName(e.scale));
  return FormatText("dense depth (scale %s; %d frames%s; %.1f %% of the pixels with a true depth are known)\n",
                    scale.c_str(), e.frames, without.c_str(), 100 * e.known_share) +
         (e.textured ? FormatText("  of the %.1f %% that have texture and are seen in other images: %.1f %%\n",
                                  100 * e.textured->share, 100 * e.textured->known_share)
                     : "") +
         FormatText("  %-26s %8s %8s %8s %8s %7s %7s %7s\n", "", "AbsRel", "SqRel", "RMSE", "log", "<1 mm", "<2",
                    "<5 %") +
         DenseRow("surface", e.estimate) + DenseRow("  its more certain half", e.certain_half) +
         DenseRow("filled holes", e.filled) + DenseRow("mesh, where it is known", e.mesh) +
         DenseRow("mesh elsewhere", e.mesh_alone) + DenseRow("points, interpolated", e.interpolation) +
         DenseRow("one constant depth", e.null) +
         FormatText("  known to 1, 2, 5 mm: %.1f, %.1f, %.1f %%; within 1 sigma %.1f %%, 2 sigma %.1f %%\n",
                    100 * e.complete_mm[0], 100 * e.complete_mm[1], 100 * e.complete_mm[2], 100 * e.within_1_sigma,
                    100 * e.within_2_sigma) +
         SigmaRow("mesh, where it is known", e.mesh) + SigmaRow("mesh elsewhere", e.mesh_alone);
}

std::string MaterialTable(const MaterialError& e) {
  const PointSummary& estimate = e.error.plain.estimate;
  std::string text = PointTable("material error", e.error);
  text +=
      FormatText("  within 2, 4, 8, 16, 32 mm: %.1f, %.1f, %.1f, %.1f, %.1f %%; their mean %.1f %% (null %.1f %%)\n",
                 100 * estimate.within[0], 100 * estimate.within[1], 100 * estimate.within[2], 100 * estimate.within[3],
                 100 * estimate.within[4], 100 * estimate.average_within, 100 * e.error.plain.null.average_within);
  const DriftFigures& d = e.drift;
  text += FormatText("  drift, px: median %.3f, RMSE %.3f, 95 %% below %.3f (points that do not move: median %.3f)\n",
                     d.median_px, d.rmse_px, d.p95_px, d.still_median_px);
  if (d.points_mm > 0)
    text += FormatText("  drift along the surface, mm: median %.3f, RMSE %.3f, 95 %% below %.3f\n", d.median_mm,
                       d.rmse_mm, d.p95_mm);
  return text + FormatText(
                    "  tracked while truly occluded: %d times, %d tracks; outside the image: %d times, %d tracks; of "
                    "%d tracks\n  %d tracks continue another one that had ended at the same point\n",
                    e.occluded, e.tracks_occluded, e.outside_image, e.tracks_outside_image, e.tracks,
                    e.continuing_tracks);
}

std::string TrajectoryTable(const TrajectoryError& e) {
  std::string text = FormatText("camera error (%s, %d poses)\n", std::string(EnumName(e.alignment)).c_str(), e.poses);
  text += FormatText("  ATE RMSE %.4f mm, median %.4f, largest %.4f, over a path of %.2f mm\n", e.ate_rmse_mm,
                     e.ate_median_mm, e.ate_max_mm, e.true_path_length_mm);
  text += FormatText("  rotation RMSE %.4f deg%s\n", e.rotation_rmse_deg,
                     e.TurnIsUnknown()
                         ? " (little meaning: the path is nearly straight, so rotation about it is hardly observable)"
                         : "");
  if (e.rpe_pairs > 0)
    text += FormatText("  RPE over %d frame(s): %.4f mm, %.4f deg\n", e.rpe_delta, e.rpe_translation_rmse_mm,
                       e.rpe_rotation_rmse_deg);
  return text;
}

std::string DepthRows(const char* where, const FirstMapDepth& d) {
  const std::string head = FormatText("  %s frame %d, %d points", where, d.frame_idx, d.points);
  return FormatText("%-40s %10s %10s\n", head.c_str(), "estimate", "null") +
         Row("relative depth, median, %", 100 * d.estimate.median, 100 * d.null.median) +
         Row("relative depth, RMSE, %", 100 * d.estimate.rmse, 100 * d.null.rmse) +
         Row("relative depth, 90 % below, %", 100 * d.estimate.p90, 100 * d.null.p90);
}

std::string FirstMapTable(const FirstMapError& e) {
  std::string text = FormatText(
      "first map (waited %d frames since its reference, %d since the first; initializer %.0f ms, %.0f at once)\n",
      e.frames_waited, e.frames_before, e.initialize_total_ms, e.initialize_largest_ms);
  text += DepthRows("made in", e.declared);
  if (e.reference && e.frames_waited > 0) text += DepthRows("reference", *e.reference);
  if (e.motion) {
    text += FormatText("  camera between the two: rotation error %.3f of %.3f deg", e.motion->rotation_error_deg,
                       e.motion->true_rotation_deg);
    if (e.motion->direction_error_deg)
      text += FormatText(", direction %.2f deg over %.2f mm", *e.motion->direction_error_deg,
                         e.motion->true_translation_mm);
    text += "\n";
  }
  return text;
}

std::string RelativeDepthRows(const RelativeDepthError& e) {
  return Row("relative depth, median, %", 100 * e.difference, 100 * e.null) +
         FormatText("  %d points in %zu frames, one scale a frame; median over points, then over frames\n", e.points,
                    e.frames.size());
}

std::string SfmTable(const RelativeDepthError& e) {
  return FormatText("%-40s %10s %10s\n", "against structure from motion", "estimate", "null") + RelativeDepthRows(e);
}

std::string ConsistencyTable(const RunConsistency& e) {
  return FormatText("%-40s %10s %10s\n", "against another run", "difference", "null") + "  " + e.other_run + "\n" +
         (e.depths ? RelativeDepthRows(*e.depths) : "") +
         (e.path ? FormatText(
                       "  camera path: %.2f %% of its length apart (ATE after a similarity, %d poses); from frame to "
                       "frame %.1f %% of a step and %.3f deg\n",
                       100 * e.path->AteShare(), e.path->poses, 100 * e.path->RpeShare(), e.path->rpe_rotation_rmse_deg)
                 : "");
}

std::string ReprojectionTable(const ReprojectionError& e) {
  return FormatText("reprojection of its own points, px: median %.3f, RMSE %.3f\n", e.median_px, e.rmse_px);
}

std::string SurvivalTable(const TrackSurvival& s) {
  std::string text = "tracks\n";
  text += FormatText("  frames tracked %d of %d", s.frames_tracked, s.frames_read);
  if (s.submaps > 1) text += FormatText(", in %d maps", s.submaps);
  text += "\n";
  if (s.interruptions > 0)
    text +=
        FormatText("  interruptions %d; after %d of them tracking continued in the same map or one merged with it\n",
                   s.interruptions, s.interruptions_survived);
  text += FormatText("  points: first frame %d, last %d, mean %.1f\n", s.first_points, s.last_points, s.mean_points);
  text += FormatText("  of the first frame's points %d are alive in the last;", s.last_alive_of_first);
  text +=
      FormatText(" alive after 25, 50, 75, 100 %% of the frames: %.0f, %.0f, %.0f, %.0f %%\n", 100 * s.alive_shares[0],
                 100 * s.alive_shares[1], 100 * s.alive_shares[2], 100 * s.alive_shares[3]);
  text += FormatText("  %d tracks, length in frames: median %.1f, mean %.1f; %d were lost and found again\n", s.tracks,
                     s.median_track_length, s.mean_track_length, s.returned_points);
  return text;
}

std::string TrackRow(const char* name, const std::array<double, 5>& shares, double mean) {
  std::string text = FormatText("  %-22s", name);
  for (const double share : shares) text += FormatText(" %7.1f", 100 * share);
  return text + FormatText(" %7.1f\n", 100 * mean);
}

std::string TrackScoreRows(const TrackScores& s) {
  return FormatText("  %-22s %7s %7s %7s %7s %7s %7s\n", "", "< 1 px", "< 2", "< 4", "< 8", "< 16", "mean") +
         TrackRow("points within", s.within, s.average_within) + TrackRow("Jaccard", s.jaccard, s.average_jaccard);
}

std::string TrackErrorTable(const TrackError& e) {
  return FormatText("tracks against the truth, %% (%d tracks; distances in images of 256 x 256 px, as TAP-Vid)\n",
                    e.tracks) +
         TrackScoreRows(e) +
         FormatText(
             "  occlusion accuracy %.1f; survival (to 50 px) %.1f; error where visible, median %.3f px of the "
             "image\n",
             100 * e.occlusion_accuracy, 100 * e.survival, e.median_px);
}

std::string TrackError3dTable(const TrackError3d& e) {
  return FormatText("tracks in space, %% (%d tracks; pixels at the true depth, smaller side 256 px, as TAPVid-3D)\n",
                    e.tracks) +
         TrackScoreRows(e) + TrackRow("null: points within", e.null.within, e.null.average_within) +
         TrackRow("null: Jaccard", e.null.jaccard, e.null.average_jaccard) +
         FormatText("  occlusion accuracy %.1f; error where visible, median %.3f mm; scale %.4f\n",
                    100 * e.occlusion_accuracy, e.median_mm, e.scale);
}

}  // namespace

std::string EvaluationTable(const Evaluation& evaluation) {
  std::string text = "run " + evaluation.run + "\n";
  if (evaluation.surface) text += PointTable("surface error", *evaluation.surface);
  if (evaluation.uncertainty) text += UncertaintyTable(*evaluation.uncertainty);
  if (evaluation.dense) text += DenseTable(*evaluation.dense);
  if (evaluation.material) text += MaterialTable(*evaluation.material);
  if (evaluation.trajectory) text += TrajectoryTable(*evaluation.trajectory);
  if (evaluation.first_map) text += FirstMapTable(*evaluation.first_map);
  if (evaluation.sfm) text += SfmTable(*evaluation.sfm);
  for (const RunConsistency& other : evaluation.consistency) text += ConsistencyTable(other);
  if (evaluation.reprojection) text += ReprojectionTable(*evaluation.reprojection);
  if (evaluation.tracks) text += TrackErrorTable(*evaluation.tracks);
  if (evaluation.tracks_3d) text += TrackError3dTable(*evaluation.tracks_3d);
  text += SurvivalTable(evaluation.survival);
  for (const std::string& note : evaluation.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace pliant
