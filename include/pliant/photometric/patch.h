// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reference patches: the look of a small square around a pixel on every pyramid level, with all that Lucas-Kanade needs
// of it computed once. This header and its sources know no Eigen: they are compiled for several instruction sets.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"

namespace pliant {

struct Pixel {
  double x = 0;
  double y = 0;
};

// A 2x2 matrix, row by row: x' = xx x + xy y, y' = yx x + yy y.
struct Affine2 {
  double xx = 1, xy = 0, yx = 0, yy = 1;
};

// Why a patch could not be followed. The order is that of the report.
enum class PatchFailure {
  kNone,
  kUnknownPoint,     // nothing is stored under this id
  kOutOfImage,       // the patch left the image
  kMasked,           // too little of the patch lies on usable pixels
  kLowTexture,       // the patch does not determine its position
  kDiverged,         // ran away from its start, or did not come to rest
  kGainOutOfRange,   // the brightness change is not plausible
  kLowSimilarity,    // SSIM below its threshold
  kForwardBackward,  // followed back, it does not return to where it came from
  kOccluded,         // something lies before it; only the truth, or another program, can say so
};
template <>
struct EnumNames<PatchFailure> {
  static constexpr std::array kNames = {std::pair{PatchFailure::kNone, std::string_view("none")},
                                        std::pair{PatchFailure::kUnknownPoint, std::string_view("unknown_point")},
                                        std::pair{PatchFailure::kOutOfImage, std::string_view("out_of_image")},
                                        std::pair{PatchFailure::kMasked, std::string_view("masked")},
                                        std::pair{PatchFailure::kLowTexture, std::string_view("low_texture")},
                                        std::pair{PatchFailure::kDiverged, std::string_view("diverged")},
                                        std::pair{PatchFailure::kGainOutOfRange, std::string_view("gain_out_of_range")},
                                        std::pair{PatchFailure::kLowSimilarity, std::string_view("low_similarity")},
                                        std::pair{PatchFailure::kForwardBackward, std::string_view("forward_backward")},
                                        std::pair{PatchFailure::kOccluded, std::string_view("occluded")}};
};

// Light at the camera shades a patch more on one side after the camera has moved. Without a model of it that gradient
// pulls the patch aside. kPlane lets brightness differ by a plane over the patch, beside gain and bias.
enum class Shading { kNone, kPlane };
template <>
struct EnumNames<Shading> {
  static constexpr std::array kNames = {std::pair{Shading::kNone, std::string_view("none")},
                                        std::pair{Shading::kPlane, std::string_view("plane")}};
};

// What SSIM compares: the reference with the tracked patch as it is, or with alpha * patch + beta. A light at the
// camera makes a patch 2.5 times brighter on the way from 80 to 50 mm: a plain comparison calls that another surface.
enum class SimilarityMode { kPlain, kCompensated };
template <>
struct EnumNames<SimilarityMode> {
  static constexpr std::array kNames = {std::pair{SimilarityMode::kPlain, std::string_view("plain")},
                                        std::pair{SimilarityMode::kCompensated, std::string_view("compensated")}};
};

inline constexpr int kMaxPatchSize = 31;

struct LucasKanadeOptions {
  int patch_size = 15;       // px, odd, at most kMaxPatchSize; side of the square, on every level
  int levels = 4;            // pyramid levels, 1: the image alone
  int max_iterations = 15;   // on each level
  double epsilon_px = 0.01;  // a smaller step ends a level (in pixels of that level)
  Switch gain_bias = Switch::kOn;
  Shading shading = Shading::kPlane;  // with gain_bias only
  double max_gain = 4;                // gains outside [1 / max_gain, max_gain] are refused
  double min_texture = 0.5;           // gray levels / px: root of the smaller eigenvalue of the mean gradient tensor
  double min_valid_support = 0.6;     // share of the patch that must lie on usable pixels
  double max_correction_px = 60;      // farther from its start than this, a patch has run away
  SimilarityMode similarity = SimilarityMode::kCompensated;
  double min_ssim = 0.8;

  void List(OptionTable& table);  // group "LucasKanade"
};

// One pyramid level of a reference patch. Blocks have rows of PatchRowStride(size) floats.
struct PatchLevel {
  std::vector<float> values;   // size + 3 rows: the patch with a margin of one pixel for gradients, and a spare row
  std::vector<float> weights;  // size rows, 0 or 1; empty: all ones
  float support = 1;           // share of the patch that lies on usable pixels
  // 3 blocks of size rows: sum over v of solve(v) * I(v), less `offsets`, is (a dx, a dy, a) of the least-squares
  // solution of I ~ a (I0 + g.d) + b (+ a plane) over the patch, g being the gradient of I0.
  std::vector<float> solve;
  std::array<float, 3> offsets{};
  PatchFailure failure = PatchFailure::kNone;  // kLowTexture, kMasked, kOutOfImage: this level is of no use
};

// A patch of `size` x `size` pixels around `center`, bilinear values, and its solution on each level.
struct ReferencePatch {
  Pixel center;  // pixels of level 0
  int size = 0;
  std::vector<PatchLevel> levels;
  // Level 0 with motion d + M (u, v), u and v from -1 to 1 over the patch: 7 blocks, as PatchLevel::solve, for
  // a (dx, dy, Mxx, Mxy, Myx, Myy, 1). Empty if not asked for.
  std::vector<float> solve_affine;
  std::array<float, 7> offsets_affine{};

  bool empty() const { return levels.empty(); }
  // Level 0 decides: without it the patch cannot be followed.
  PatchFailure failure() const { return empty() ? PatchFailure::kUnknownPoint : levels.front().failure; }
  // What AlignPatch needs: the finest level and the solution with affine motion, which this patch gives away. A patch
  // of 15 px with four levels takes 34 kB, this part of it 16 kB.
  ReferencePatch TakeForAlignment();
};

// Floats from one row of a patch to the next.
constexpr int PatchRowStride(int size) { return (size + 2 + 7) / 8 * 8; }

enum class AffineSolution { kWithout, kWith };

// Cuts a patch out of a pyramid, into `patch`, whose memory is used again. Returns patch->failure(): kNone,
// kOutOfImage, kMasked or kLowTexture.
PatchFailure CutReferencePatch(const ImagePyramid& pyramid, const SupportMask& mask, Pixel center,
                               const LucasKanadeOptions& options, AffineSolution affine, ReferencePatch* patch);

}  // namespace pliant
