// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/patch.h"

namespace pliant {

void LucasKanadeOptions::List(OptionTable& table) {
  table.BeginGroup("LucasKanade", "following one patch from image to image");
  table.Add("patch_size", &patch_size, "px",
            "side of the square patch on every level; an even size is made odd; 1.41 times as large where "
            "Image.working = measured "
            "finds that more points last then",
            7, kMaxPatchSize);
  table.Add("levels", &levels, "-", "pyramid levels: each doubles how far a patch may jump", 1, 8);
  table.Add("max_iterations", &max_iterations, "-", "on each level", 1, 100);
  table.Add("epsilon_px", &epsilon_px, "px", "a smaller step ends a level", 1e-4, 1);
  table.AddChoice("gain_bias", &gain_bias, "estimate a brightness gain and bias for each patch");
  table.AddChoice("shading", &shading, "with gain_bias: let brightness differ by a plane over the patch too");
  table.Add("max_gain", &max_gain, "-", "a larger gain, or one below its inverse, is refused", 1, 100);
  table.Add("min_texture", &min_texture, "gray levels / px", "weakest gradient of a patch that determines its position",
            0, 100);
  table.Add("min_valid_support", &min_valid_support, "-", "share of a patch that must lie on usable pixels", 0.1, 1);
  table.Add("max_correction_px", &max_correction_px, "px", "farther from its start a patch has run away", 0.5, 1000);
  table.AddChoice("similarity", &similarity, "what SSIM compares: brightness as it is, or after gain and bias");
  table.Add("min_ssim", &min_ssim, "-", "a track whose patch is less similar to its reference is refused", -1, 1);
}

}  // namespace pliant
