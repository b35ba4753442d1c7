// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Bundle adjustment of a window in which the scene deforms: poses, points and how the points move, together.
//
// The low-rank deformation model of non-rigid structure from motion (Bregler, Hertzmann, Biermann, CVPR 2000): a tissue
// that breathes, beats or is pushed moves in few ways at a time, so its motion is a sum of R basis shapes, each with a
// coefficient that changes over time (docs/method.md, eq. W1):
//   X_i(v) = X_i + sum_r c_r(v) m_ir,   c_r(0) = 0
// The R temporal coefficients c are common to all points; a point has 3 R numbers of its own (its part m of the basis
// shapes), where a free motion would take 3 numbers a point and view. Basis shapes are alike at neighboring points (W3)
// and small (W4), coefficients are smooth in time (W5). A motion common to all points is the camera's: a uniform motion
// of the scene and the camera's own cannot be told apart, and their sum is what is found. Scale is free in a monocular
// window; it stays that of the start (W7).
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// One ray of the window, and what the light says of the distance along it.
struct DeformingObservation {
  int view_idx = 0;
  int point_idx = 0;
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  // unit, in the view's camera
  // Log distance up to a constant of the view, from brightness (LogDistanceFromLight) or a depth prior; NaN: unknown.
  double log_cue = std::numeric_limits<double>::quiet_NaN();
};

// What a distance that comes with a ray is from.
enum class DistanceCue {
  kLight,  // at the camera: brightness, which also falls with the surface's inclination (W6)
  kPrior,  // a depth prior: the distance itself
  kNone,   // there is none: every log_cue is NaN
};

// How the camera may move in a window.
enum class WindowCamera {
  kFree,      // turns and translates
  kRotation,  // turns at most: all parallax is the scene's
};

struct DeformingWindow {
  std::vector<double> times;                       // of the views, in frames since the reference, ascending from 0
  std::vector<Rigid3> cams_from_world;             // view 0 is the reference: the identity, and it stays so
  Eigen::MatrixXd coefficients;                    // temporal, c_r(v): R x views, no unit; column 0 is zero
  std::vector<Eigen::Vector3d> points_in_world;    // X_i, in the reference view
  std::vector<Eigen::Matrix3Xd> shapes;            // basis shapes, m_ir: 3 x R a point, map units
  std::vector<DeformingObservation> observations;  // any order
  WindowCamera camera = WindowCamera::kFree;
  DistanceCue cue = DistanceCue::kLight;

  // X_i(v), world frame.
  Eigen::Vector3d Position(int point_idx, int view_idx) const;
  // Median of |X_i|; there is at least one point.
  double MedianDistance() const;
};

constexpr int kMaxWindowRank = 4;

struct DeformingWindowOptions {
  int rank = 3;                 // R; with light one less is tried too
  double loss_scale_px = 0.15;  // Cauchy loss
  double gradient_sigma = 0.3;  // of neighbors' basis shapes: standard deviation of their difference by their distance
  double shape_sigma = 0.2;     // of a basis shape's components by the median distance
  double acceleration_sigma = 0.02;  // of a coefficient's second derivative, 1/frame^2
  double light_sigma = 2.0;          // of log distance from brightness; large, because neighbors err alike
  int neighbors = 6;                 // of the smoothness over the surface
  int nodes = 16;                    // of the surface, at which basis shapes are free; between them: interpolated
  int sample_points = 80;            // in each of the two samples that are solved first
  int max_iterations = 12;           // of one solution; a sixth of it for the last
  int patch_px = 15;  // side of the tracked patches, which is LucasKanade.patch_size; no option of its own

  void List(OptionTable& table);  // group "Window"
};

// Nodes of the surface with basis shapes of their own, which regularize those of the points around them (W3).
struct SurfaceNodes {
  std::vector<Eigen::Vector3d> positions;  // world, in the reference
  Eigen::MatrixXd shapes;                  // a column a node: 3 x R, column by column
};

struct DeformingSolution {
  DeformingWindow window;
  SurfaceNodes nodes;  // none where there are no coefficients
  // Predicted standard deviation of log |X_i|, with noise and deformation of the sizes that were found (W12); relative
  // to the gauge (W7). Infinite where it cannot be computed.
  std::vector<double> log_depth_sigmas;
  // Standard deviation of log distance between the solutions of two samples of the points, over the window (W10): what
  // the linear prediction does not see, another minimum. Where it is larger, that between the two motions of a scene
  // that is nearly flat. Infinite where one sample has no solution, and empty where there is nothing to compare.
  std::vector<double> sample_sigmas;
  double cost = 0;
  // How much alike the errors of neighbors are (W11): about 0 where the window explains all but noise, near 1 where
  // the scene moves in ways that it has not.
  double residual_correlation = 0;
  double light_error = 0;          // median deviation of log distance from what the cue says (W8); 0: there is none
  double log_distance_spread = 0;  // the same from one distance for all: a light that says something is well below it

  // A point's log_depth_sigmas and, where there are samples, sample_sigmas together.
  double LogDepthSigma(std::size_t point) const;
};

// Solves the window from a rigid start: `start` has times, poses, points and observations, and no coefficients. Images
// alone hardly tell one minimum from another, so there are several solutions to choose from. Two samples of the points
// are solved each by itself: the coefficients start from what the rigid scene leaves unexplained, then poses,
// points, shapes and coefficients are solved for together, with rank R and from there with R - 1; the other points join
// with the views fixed. The most plausible by images and light is then solved with all points, in at most a sixth of
// the steps. It is of rank R unless the light_error of rank R - 1 is clearly less; without light R - 1 is not tried. Of
// a scene that is nearly flat a sample is also solved from the other motion that explains its plane.
//
// `threads` never changes the result. Fails with kInvalidArgument for sizes, indices, numbers and options that are
// none, kInsufficient below three views or twelve points, and kDegenerate when there is no usable step.
Result<DeformingSolution> SolveDeformingWindow(const DeformingWindow& start, double focal_px,
                                               const DeformingWindowOptions& options, int threads = 1);

// The same of a scene that does not deform: no coefficients, and no samples. It is also solved by the other motion that
// explains the plane nearest to its points, and the solution of lower cost is returned; sample_sigmas are then of these
// two, and empty where the other costs clearly more.
Result<DeformingSolution> SolveRigidWindow(const DeformingWindow& start, double focal_px,
                                           const DeformingWindowOptions& options, int threads = 1);

// Whether a scene is rigid, asked of a sample of its points alone: their residual_correlation (W11) in the rigid
// solution.
Result<double> RigidResidualCorrelation(const DeformingWindow& start, double focal_px,
                                        const DeformingWindowOptions& options);

// Poses and coefficients of more views of a solved window's points, which stay as they are with their shapes: `views`
// has a start of every view's pose and coefficients. The first view stays as it is. Fails like SolveDeformingWindow.
Result<DeformingWindow> OptimizeDeformingViews(const DeformingWindow& views, double focal_px,
                                               const DeformingWindowOptions& options, int threads = 1);

// A solution with other views, and with more points: every point and its basis shapes are optimized independently, with
// views, coefficients and nodes fixed. `joining` are observations of `num_joining` other points, numbered from 0 and
// ordered by view. They come after the solution's own, and start at the distance and with the shapes of those nearest
// to their first ray. log_depth_sigmas are by at most eight of the views; sample_sigmas of those that join are their
// neighbors', and infinite for one that no view sees; the rest is the solution's. `threads` never changes the result.
// Fails like SolveDeformingWindow.
Result<DeformingSolution> OptimizeDeformingPoints(const DeformingSolution& solution,
                                                  const std::vector<DeformingObservation>& joining, int num_joining,
                                                  double focal_px, const DeformingWindowOptions& options,
                                                  int threads = 1);

// Root mean square error of each point over its views but the reference, which the start was made of; infinite for a
// point that no other view sees.
std::vector<double> PointErrorsPx(const DeformingWindow& window, double focal_px);

// Errors of points that are neighbors in the reference, as chords of unit rays: those of noise differ, those of a wrong
// model are alike.
struct NeighborErrors {
  double shared = 0;  // mean of e_i . e_j, without unit; noise alone: about 0, of either sign
  double all = 0;     // mean of (|e_i|^2 + |e_j|^2) / 2
  // Standard deviation of the correlation of noise: by the pairs of one view, as a point's errors last over views.
  double correlation_sigma = 0;
  // From -1 to 1 (W11); 0 where there are no errors.
  double Correlation() const { return all > 0.0 ? shared / all : 0.0; }
};

// Largest correlation of a window that leaves noise alone unexplained.
inline constexpr double kMaxNoiseCorrelation = 0.1;

// Over the views in `view_idxs`. Neighbors are the nearest at an angle of at least `min_angle_rad`: the tracks of
// patches that overlap err alike. Errors above four times the median one count as that large.
NeighborErrors ErrorsOfNeighbors(const DeformingWindow& window, const std::vector<int>& view_idxs,
                                 double min_angle_rad);

// Their correlation over all views (W11).
double ResidualCorrelation(const DeformingWindow& window, double min_angle_rad);

}  // namespace pliant
