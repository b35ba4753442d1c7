// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/lucas_kanade.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "photometric/patch_solution.h"
#include "pliant/base/parallel.h"
#include "pliant/photometric/ssim.h"

namespace pliant {
namespace {

constexpr double kCoarseEpsilon_px = 0.05;  // of its own pixels: a coarse level only has to come near
constexpr double kRest_px = 0.1;            // a patch whose last step on the finest level is larger is not at rest
constexpr double kSamePixels_px = 0.5;
constexpr double kSimilarSupport = 0.9;
constexpr double kMinStepGain = 0.05;  // the fit says: nothing of the patch is there

// A solution that holds for the pixels usable in both images: the patch's own, or a recomputed one.
struct Solution {
  const float* solve = nullptr;
  const float* offsets = nullptr;
  const float* weights = nullptr;  // null: all ones
};

// Room for a recomputed solution.
struct Scratch {
  alignas(64) std::array<float, kMaxBlock> weights;
  alignas(64) std::array<float, static_cast<std::size_t>(7) * kMaxBlock> solve;
  std::array<float, 7> offsets;
};

struct Finest {
  const ReferencePatch& patch;
  const ImagePyramid& pyramid;
  const SupportMask& mask;
  const LucasKanadeOptions& options;
  PatchShape shape;
  ImageSize size;

  Finest(const ReferencePatch& p, const ImagePyramid& i, const SupportMask& m, const LucasKanadeOptions& o)
      : patch(p), pyramid(i), mask(m), options(o), shape(ShapeOf(p.size)), size{i.width(), i.height()} {}
  ImageView view(int level) const { return {pyramid.origin(level), pyramid.stride(level)}; }
};

// Whether the patch's own solution holds at (x, y) of level 0, or pixels masked there ask for another.
PatchFailure ChooseSolution(const Finest& f, int level, double x, double y, const Affine2& affine, BasisKind kind,
                            Scratch* scratch, Solution* solution) {
  const PatchLevel& reference = f.patch.levels[static_cast<std::size_t>(level)];
  const bool is_affine = kind == BasisKind::kAffine;
  *solution = {is_affine ? f.patch.solve_affine.data() : reference.solve.data(),
               is_affine ? f.patch.offsets_affine.data() : reference.offsets.data(),
               reference.weights.empty() ? nullptr : reference.weights.data()};
  const double reach = std::max(std::hypot(affine.xx, affine.yx), std::hypot(affine.xy, affine.yy));
  const int radius = static_cast<int>(std::ceil(reach * (f.shape.half() + 1))) - 1;
  const Support support = SupportAt(f.mask, f.size, x, y, radius);
  const double wanted = level == 0 ? f.options.min_valid_support : kMinCoarseSupport;
  if (support.inside < wanted) return PatchFailure::kOutOfImage;
  if (support.usable < wanted) return PatchFailure::kMasked;
  // A coarse level only has to come near: its own weights will do while about as much of it is usable as before.
  if (support.usable >= (level == 0 ? 1 : kSimilarSupport * reference.support)) return PatchFailure::kNone;
  FillWeights(f.mask, f.size, x, y, affine, f.shape, solution->weights, scratch->weights.data());
  const PatchFailure failure = SolvePatch(reference.values.data(), scratch->weights.data(), kind, level, f.shape,
                                          f.options, scratch->solve.data(), scratch->offsets.data());
  *solution = {scratch->solve.data(), scratch->offsets.data(), scratch->weights.data()};
  return failure;
}

// Steps on one level until at rest; `at` in pixels of the level.
PatchFailure IterateLevel(const Finest& f, int level, const Solution& solution, Pixel* at, int* iterations) {
  const double half = f.shape.half();
  const double epsilon = level == 0 ? f.options.epsilon_px : std::max(f.options.epsilon_px, kCoarseEpsilon_px);
  const double max_x = f.pyramid.width(level) - 1;
  const double max_y = f.pyramid.height(level) - 1;
  const ImageView image = f.view(level);
  const Pixel start = *at;
  double last_x = 0;
  double last_y = 0;
  double length = 0;
  for (int i = 0; i < f.options.max_iterations; ++i) {
    if (!(at->x >= 0 && at->y >= 0 && at->x <= max_x && at->y <= max_y)) return PatchFailure::kOutOfImage;
    std::array<float, 3> sums;
    SolveOnGrid(image, at->x - half, at->y - half, solution.solve, f.shape, sums.data());
    ++*iterations;
    const double gain = sums[2] - solution.offsets[2];
    if (!(gain > kMinStepGain)) return PatchFailure::kDiverged;
    const double step_x = -(sums[0] - solution.offsets[0]) / gain;
    const double step_y = -(sums[1] - solution.offsets[1]) / gain;
    at->x += step_x;
    at->y += step_y;
    length = std::hypot(step_x, step_y);
    if (length < epsilon) return PatchFailure::kNone;
    if (std::hypot(at->x - start.x, at->y - start.y) > f.shape.size) return PatchFailure::kDiverged;
    if (i > 0 && std::hypot(step_x + last_x, step_y + last_y) < epsilon) {  // it swings about the solution
      at->x -= 0.5 * step_x;
      at->y -= 0.5 * step_y;
      return PatchFailure::kNone;
    }
    last_x = step_x;
    last_y = step_y;
  }
  return length < kRest_px || level > 0 ? PatchFailure::kNone : PatchFailure::kDiverged;
}

// Gain, bias and SSIM from the patch's values and those found; sets the failure.
void Judge(const Finest& f, const float* found, const float* weights, PatchMatch* match) {
  const PatchLevel& finest = f.patch.levels.front();
  const float* reference = finest.values.data() + f.shape.row_stride + 1;
  const float origin = reference[f.shape.half() * f.shape.row_stride + f.shape.half()];
  const MomentSums sums = SumMoments(reference, found, weights, origin, f.shape);
  const double w = std::max(1.0F, sums.w);
  const double dx = sums.x / w;
  const double dy = sums.y / w;
  const PatchMoments moments{origin + dx, origin + dy, sums.xx / w - dx * dx, sums.yy / w - dy * dy,
                             sums.xy / w - dx * dy};
  if (f.options.gain_bias == Switch::kOn) {
    match->gain = moments.var_y > 1e-6 ? moments.cov / moments.var_y : 0;
    match->bias = moments.mean_x - match->gain * moments.mean_y;
  }
  match->ssim =
      Ssim(f.options.similarity == SimilarityMode::kPlain ? moments : Compensated(moments, match->gain, match->bias));
  if (!(match->gain <= f.options.max_gain && match->gain * f.options.max_gain >= 1)) {
    match->failure = PatchFailure::kGainOutOfRange;
  } else if (!(match->ssim >= f.options.min_ssim)) {
    match->failure = PatchFailure::kLowSimilarity;
  }
}

bool Inside(const ImagePyramid& pyramid, Pixel p) {
  return p.x >= 0 && p.y >= 0 && p.x <= pyramid.width() - 1 && p.y <= pyramid.height() - 1;
}

// One level of TrackPatch, from and to match->pixel; a coarse level that fails leaves it as it was.
void TrackLevel(const Finest& f, int level, PatchMatch* match) {
  Scratch scratch;
  Solution solution;
  const double scale = 1 << level;
  Pixel at{match->pixel.x / scale, match->pixel.y / scale};
  PatchFailure failure = PatchFailure::kNone;
  for (int round = 0; round < 2; ++round) {
    const Pixel start = at;
    failure = ChooseSolution(f, level, scale * at.x, scale * at.y, {scale, 0, 0, scale}, BasisKind::kTranslation,
                             &scratch, &solution);
    if (failure == PatchFailure::kNone) failure = IterateLevel(f, level, solution, &at, &match->iterations);
    // Weights were chosen for the start: where masked pixels matter, once more from where it led.
    const bool masked_here = level == 0 && solution.weights == scratch.weights.data();
    if (failure != PatchFailure::kNone || !masked_here || std::hypot(at.x - start.x, at.y - start.y) < kSamePixels_px)
      break;
  }
  if (failure == PatchFailure::kNone) match->pixel = {at.x * scale, at.y * scale};
  if (level > 0) return;
  match->failure = failure;
  if (failure != PatchFailure::kNone) return;
  if (!Inside(f.pyramid, match->pixel)) {
    match->failure = PatchFailure::kOutOfImage;
    return;
  }
  alignas(64) std::array<float, kMaxBlock> found;
  SampleGrid(f.view(0), at.x - f.shape.half(), at.y - f.shape.half(), f.shape.size, f.shape, found.data());
  Judge(f, found.data(), solution.weights, match);
}

// A (I + M / half)^-1, M = {xx, xy, yx, yy}; false where that turns the patch inside out.
bool Compose(const std::array<double, 4>& m, double half, Affine2* a) {
  const double xx = 1 + m[0] / half;
  const double xy = m[1] / half;
  const double yx = m[2] / half;
  const double yy = 1 + m[3] / half;
  const double det = xx * yy - xy * yx;
  if (!(det > 0.1)) return false;
  *a = {(a->xx * yy - a->xy * yx) / det, (a->xy * xx - a->xx * xy) / det, (a->yx * yy - a->yy * yx) / det,
        (a->yy * xx - a->yx * xy) / det};
  return true;
}

// Whether everything the kernel may read of the warped patch is inside the padded image.
bool Readable(const Finest& f, Pixel at, const Affine2& a) {
  const double half = f.shape.half() + 1;
  const double right = f.shape.row_stride - f.shape.half();
  const double reach_x = std::abs(a.xx) * right + std::abs(a.xy) * half;
  const double reach_y = std::abs(a.yx) * right + std::abs(a.yy) * half;
  const double margin = ImagePyramid::kPadding - 4;
  return at.x - reach_x >= -margin && at.y - reach_y >= -margin && at.x + reach_x <= f.size.width - 1 + margin &&
         at.y + reach_y <= f.size.height - 1 + margin;
}

void SampleWarped(const Finest& f, Pixel at, const Affine2& a, float* found) {
  const std::array<float, 4> coefficients = {static_cast<float>(a.xx), static_cast<float>(a.xy),
                                             static_cast<float>(a.yx), static_cast<float>(a.yy)};
  const double half = f.shape.half();
  SampleAffineGrid(f.view(0), at.x - (a.xx + a.xy) * half, at.y - (a.yx + a.yy) * half, coefficients.data(), f.shape,
                   found);
}

// Steps of AlignPatch; leaves the patch found last in `found`.
PatchFailure IterateWarped(const Finest& f, const Solution& solution, AlignmentModel model, PatchMatch* match,
                           float* found) {
  const int motion = model == AlignmentModel::kAffine ? 6 : 2;
  const double half = f.shape.half();
  const Pixel start = match->pixel;
  double length = 0;
  for (int i = 0;; ++i) {
    if (!Inside(f.pyramid, match->pixel) || !Readable(f, match->pixel, match->affine)) return PatchFailure::kOutOfImage;
    SampleWarped(f, match->pixel, match->affine, found);
    if (i > 0 && length < f.options.epsilon_px) return PatchFailure::kNone;
    if (i == f.options.max_iterations) return length < kRest_px ? PatchFailure::kNone : PatchFailure::kDiverged;
    std::array<float, 7> sums{};
    SolveOnValues(found, solution.solve, motion + 1, f.shape, sums.data());
    ++match->iterations;
    const double gain = sums[static_cast<std::size_t>(motion)] - solution.offsets[motion];
    if (!(gain > kMinStepGain)) return PatchFailure::kDiverged;
    std::array<double, 6> p{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(motion); ++k) p[k] = (sums[k] - solution.offsets[k]) / gain;
    if (motion == 6 && !Compose({p[2], p[3], p[4], p[5]}, half, &match->affine)) return PatchFailure::kDiverged;
    const Affine2& a = match->affine;
    match->pixel.x -= a.xx * p[0] + a.xy * p[1];
    match->pixel.y -= a.yx * p[0] + a.yy * p[1];
    length = std::hypot(std::hypot(p[0], p[1]), std::hypot(std::hypot(p[2], p[3]), std::hypot(p[4], p[5])));
    if (std::hypot(match->pixel.x - start.x, match->pixel.y - start.y) > half) return PatchFailure::kDiverged;
  }
}

}  // namespace

PatchMatch TrackPatch(const ReferencePatch& patch, const ImagePyramid& pyramid, const SupportMask& mask, Pixel start,
                      const LucasKanadeOptions& options) {
  PatchMatch match;
  match.pixel = start;
  match.failure = patch.failure();
  if (match.failure != PatchFailure::kNone) return match;
  if (!Inside(pyramid, start)) {
    match.failure = PatchFailure::kOutOfImage;
    return match;
  }
  const Finest f(patch, pyramid, mask, options);
  const int levels = std::min({static_cast<int>(patch.levels.size()), pyramid.levels(), options.levels});
  for (int level = levels - 1; level >= 0; --level)
    if (patch.levels[static_cast<std::size_t>(level)].failure == PatchFailure::kNone) TrackLevel(f, level, &match);
  const double moved = std::hypot(match.pixel.x - start.x, match.pixel.y - start.y);
  if (match.failure == PatchFailure::kNone && moved > options.max_correction_px)
    match.failure = PatchFailure::kDiverged;
  return match;
}

PatchMatch AlignPatch(const ReferencePatch& patch, const ImagePyramid& pyramid, const SupportMask& mask, Pixel start,
                      const Affine2& affine, AlignmentModel model, const LucasKanadeOptions& options) {
  PatchMatch match;
  match.pixel = start;
  match.affine = affine;
  match.failure = patch.failure();
  if (match.failure != PatchFailure::kNone) return match;
  if (model == AlignmentModel::kAffine && patch.solve_affine.empty()) {
    match.failure = PatchFailure::kLowTexture;
    return match;
  }
  const Finest f(patch, pyramid, mask, options);
  Scratch scratch;
  Solution solution;
  const BasisKind kind = model == AlignmentModel::kAffine ? BasisKind::kAffine : BasisKind::kTranslation;
  match.failure = ChooseSolution(f, 0, start.x, start.y, affine, kind, &scratch, &solution);
  if (match.failure != PatchFailure::kNone) return match;
  alignas(64) std::array<float, kMaxBlock> found;
  match.failure = IterateWarped(f, solution, model, &match, found.data());
  if (match.failure == PatchFailure::kNone) Judge(f, found.data(), solution.weights, &match);
  return match;
}

std::vector<PatchMatch> TrackBatch(std::span<const TrackRequest> requests, const ImagePyramid& pyramid,
                                   const SupportMask& mask, const LucasKanadeOptions& options, int threads) {
  std::vector<PatchMatch> matches(requests.size());
  ParallelFor(static_cast<int>(requests.size()), threads, [&](int i) {
    const TrackRequest& request = requests[static_cast<std::size_t>(i)];
    assert(request.patch != nullptr);
    matches[static_cast<std::size_t>(i)] = TrackPatch(*request.patch, pyramid, mask, request.start, options);
  });
  return matches;
}

}  // namespace pliant
