// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The deforming window of the frames since the reference: its views, its points, its start and its solution.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/estimation/window/deforming_window.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"

namespace pliant {

struct SolvedWindow {
  std::vector<std::size_t> views;
  std::vector<PointId> ids;
  DeformingSolution solution;
  bool light_is_of_no_use = false;  // it was to be used, and was not
  // Of a rigid window that leaves more than noise unexplained, and knows depths better all the same: the same window
  // with coefficients. Else null.
  std::shared_ptr<const SolvedWindow> deforming = nullptr;
  bool is_contradicted = false;  // that one is more certain, of depths that are all nearly the same

  bool IsRigid() const { return solution.window.coefficients.rows() == 0; }
  // Whether the sigmas allow for a deformation.
  bool AllowsDeformation() const { return !IsRigid() || deforming != nullptr; }
};

// Of the points, between the reference and a view: median.
double MedianParallaxRad(const DeformingWindow& window, const Rigid3& cam_from_world);

// The median of the standard deviations of the points' log depths.
double MedianSigma(const DeformingSolution& solution);

// The median of |log(value / median)|; infinite where a value is not positive.
double LogSpread(std::vector<double> values);

// Whether the light says of the distances next to nothing, or something else: the solution is wrong, or the light is
// not at the camera, of another response, or on tissue of many colors. False where there is no light.
bool ContradictsLight(const DeformingSolution& solution);

enum class WindowScene { kRigid, kDeforming, kAny };

// The window of the input's first `frames` frames, solved: as a rigid scene if it is one, else, where it may be any, or
// at once where it is known to deform, with coefficients; where the light turns out to say nothing of these, with the
// depth prior, and where that does not either, with none, if that is more certain. Where it may be any and its halves
// agree so well that a rigid scene leaves depths less uncertain than coefficients do, or that its depths stand out
// where those with coefficients do not, as a rigid scene all the same (W19).
// kInsufficient, kDegenerate: what is missing, or that the scene deforms.
Result<SolvedWindow> SolveWindow(const InitInput& input, std::size_t frames, WindowScene scene,
                                 const WindowInitOptions& options, double nominal_depth_mm);

// The same window as if the scene were rigid, whether it is or not: its residual_correlation tells.
Result<SolvedWindow> SolveAsRigid(const InitInput& input, std::size_t frames, const WindowInitOptions& options,
                                  double nominal_depth_mm);

// The options with another cue.
WindowInitOptions WithCue(WindowInitOptions options, DistanceCue cue);

// A point's index in the sorted `ids`, or -1.
int IndexOf(PointId id, const std::vector<PointId>& ids);

// Those of `ids` that a frame sees, as observations of view `view_idx`; points are numbered by their index in `ids`.
std::vector<DeformingObservation> SeenIn(const InitInput& input, const InitFrame& frame,
                                         const std::vector<PointId>& ids, int view_idx,
                                         const WindowInitOptions& options);

// A window solved in the frames `views` of the input, in all of its frames: points and shapes are those of `solved`,
// one for each of `ids`, poses and coefficients are between those of the views, or the last view's; not optimized.
DeformingWindow InAllFrames(const InitInput& input, const std::vector<std::size_t>& views,
                            const DeformingWindow& solved, const std::vector<PointId>& ids,
                            const WindowInitOptions& options);

}  // namespace pliant
