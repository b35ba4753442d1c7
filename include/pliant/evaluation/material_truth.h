// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the points of the material truly are: what a data set has to answer for a material error to be computed.
// The simulator answers exactly (OpenMaterialTruth); a data set with tracked markers or with corresponding point clouds
// frame by frame may answer with what it has. Camera frames and pixels are those of the true camera; millimeters.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"

namespace pliant {

// A point of the material, by a number that means something to its truth alone.
struct MaterialId {
  std::int64_t value = 0;
};

enum class MaterialVisibility {
  kVisible,
  kOccluded,      // something else lies before it
  kOutsideImage,  // it projects outside, or not at all
};

struct MaterialState {
  Eigen::Vector3d point_in_cam;
  std::optional<Eigen::Vector2d> pixel;  // nothing where it does not project; may lie outside the image
  MaterialVisibility visibility = MaterialVisibility::kVisible;
};

class MaterialTruth {
 public:
  virtual ~MaterialTruth() = default;

  // The points of the material that the camera of a frame sees at pixels (sub-pixel positions too); nothing where it
  // sees none or the truth does not know.
  virtual Result<std::vector<std::optional<MaterialId>>> PointsAt(int frame_idx,
                                                                  std::span<const Eigen::Vector2d> pixels) = 0;

  // Where points are in a frame; nothing where the truth does not know.
  virtual Result<std::vector<std::optional<MaterialState>>> Observe(int frame_idx,
                                                                    std::span<const MaterialId> points) = 0;
};

// The truth of a simulated sequence, from simulation.yaml in its folder. Fails as OpenSimulation does: kNotFound where
// the sequence was not simulated, kMismatch where it is not the one that simulation.yaml describes.
Result<std::unique_ptr<MaterialTruth>> OpenMaterialTruth(const std::string& sequence_path);

}  // namespace pliant
