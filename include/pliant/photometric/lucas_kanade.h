// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Lucas-Kanade with gain and bias, coarse to fine (docs/method.md, eq. P1 to P3): the d, alpha and beta of
//   argmin sum over v in the patch of ( I0(v) - alpha It(v + d) - beta )^2
// (Gomez Rodriguez et al., IROS 2022), solved inverse-compositionally (Baker and Matthews, IJCV 2004): the patch is
// linearized once, gain and bias are eliminated in closed form, and a step costs one bilinear pass over the patch.
// Pixels masked in either image carry no weight. Vector code is chosen at run time (Highway); results do not depend on
// the number of threads.
#pragma once

#include <span>
#include <vector>

#include "pliant/photometric/patch.h"

namespace pliant {

struct PatchMatch {
  Pixel pixel;                                 // where the patch's center is, pixels of level 0
  Affine2 affine;                              // current neighborhood from the patch's
  PatchFailure failure = PatchFailure::kNone;  // the rest is set as far as it was computed
  double ssim = 0;                             // of the reference and the patch found, at most 1
  double gain = 1;                             // alpha
  double bias = 0;                             // beta, gray levels
  int iterations = 0;                          // over all levels
};

// Follows a patch from `start`, coarse to fine, by translation.
PatchMatch TrackPatch(const ReferencePatch& patch, const ImagePyramid& pyramid, const SupportMask& mask, Pixel start,
                      const LucasKanadeOptions& options);

enum class AlignmentModel { kTranslation, kAffine };
template <>
struct EnumNames<AlignmentModel> {
  static constexpr std::array kNames = {std::pair{AlignmentModel::kTranslation, std::string_view("translation")},
                                        std::pair{AlignmentModel::kAffine, std::string_view("affine")}};
};

// Aligns a patch on the finest level only, seen through the 2x2 `affine` (current from reference neighborhood), from a
// start within about two pixels. kTranslation keeps `affine`; kAffine refines it too, and needs a patch made with
// AffineSolution::kWith.
PatchMatch AlignPatch(const ReferencePatch& patch, const ImagePyramid& pyramid, const SupportMask& mask, Pixel start,
                      const Affine2& affine, AlignmentModel model, const LucasKanadeOptions& options);

struct TrackRequest {
  const ReferencePatch* patch = nullptr;
  Pixel start;
};

// TrackPatch for every request, on at most `threads` threads.
std::vector<PatchMatch> TrackBatch(std::span<const TrackRequest> requests, const ImagePyramid& pyramid,
                                   const SupportMask& mask, const LucasKanadeOptions& options, int threads);

}  // namespace pliant
