// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How many of the pixels have a dense depth in which one can be expected.
#pragma once

#include <optional>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/evaluation/dense_error.h"
#include "pliant/evaluation/material_truth.h"
#include "pliant/image/masks.h"

namespace pliant {

// Every fourth pixel of every fourth row that has a true depth is looked at. A depth can be expected where the pixel is
// usable (`masks`), has texture (V16), and where the tissue that it shows is truly seen by at least two of the images
// that the frame was compared with (by one, where it was compared with one): by the material's truth; of a pair, the
// right image, by the true depth. Means over the frames that have such pixels, also those that were compared with
// others and have no depth. `images` is read from its beginning; `material` may be null. Nothing where the surface does
// not say how its images were compared, no frame has such pixels, or nothing says what other images see. Fails as
// Sequence, ReadSurfaceDepth and MaterialTruth, and with kMismatch where true depth and surface have different sizes,
// or the sequence lacks frames that others were compared with.
Result<std::optional<DenseCompleteness>> ComputeDenseCompleteness(const SurfaceFolder& surface, Sequence* images,
                                                                  MaterialTruth* material, const MaskOptions& masks);

}  // namespace pliant
