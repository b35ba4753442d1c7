// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/depth_prior/depth_prior_options.h"

namespace pliant {

void DepthPriorOptions::List(OptionTable& table) {
  table.BeginGroup("DepthPrior", "depth images of another program, such as a network's, as a weak measurement");
  table.Add("path", &path, "DIR",
            "folder with a file an image: PNG, TIFF, EXR or .npy of one channel; relative to the working folder; "
            "empty: none");
  table.AddChoice("kind", &kind, "what the values grow with, up to a scale and a shift of every image");
  table.Add("max_step", &max_step, "-",
            "maximum relative difference among the four pixels around a point: more is a contour, and says nothing",
            1e-6, 10);
  table.AddChoice("window", &window,
                  "use it in first maps and re-estimations, where brightness is no depth cue or is not used");
}

}  // namespace pliant
