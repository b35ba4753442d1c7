// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether the images contradict the calibration's focal length (docs/method.md, eq. W16).
#pragma once

#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"

namespace pliant {

// The factor by which the focal length would have to be changed so that a rigid scene explains the frames since the
// reference, and explains them clearly better than with the calibration's: from about 0.4 to 2.6, to a few per cent. 1
// where none does: the focal length may be right, or less than about 15 % off, the scene may deform, or the camera may
// have moved too little to tell. Factors at which the distortion folds over within the image are not tried.
double ContradictingFocalLengthFactor(const InitInput& input, const WindowInitOptions& options,
                                      double nominal_depth_mm);

}  // namespace pliant
