// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is wrong with a COLMAP model. COLMAP's own model_analyzer prints figures of models whose tracks point nowhere
// and whose numbers are none; its other programs end on them half-way, or compute with them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/colmap/model.h"

namespace pliant::colmap {

enum class Severity {
  kError,    // what COLMAP, or a reader of its formats, trips over
  kWarning,  // allowed, but hardly meant
};

struct Finding {
  Severity severity = Severity::kError;
  std::string what;        // one sentence without a full stop, of all the things that have it
  std::int64_t count = 0;  // how many they are
  std::string example;     // the first of them
};

// Errors: numbers that are none; image sizes, focal lengths and quaternions that cannot be; images without their camera
// and names that two of them share; tracks that point to no image or no keypoint, or to one that belongs to another
// point, or twice to one; keypoints that point to no point, or to one whose track does not have them; rigs without
// their camera, frames without their rig or images. Warnings: images without observations, points seen in one image
// alone, points behind a camera that sees them, keypoints outside of their image, quaternions that are not of unit
// length, no points at all, a camera model that Pliant does not have.
std::vector<Finding> CheckModel(const Model& model);

// Whether none of the findings is an error.
bool IsValid(const std::vector<Finding>& findings);

// ReadModel, and kUnreadable with the first error that CheckModel finds.
Result<Model> ReadValidModel(const std::string& folder, const JobProgress& progress = {});

}  // namespace pliant::colmap
