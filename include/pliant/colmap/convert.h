// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Between COLMAP's values and Pliant's. COLMAP's first pixel has its center at (0.5, 0.5), Pliant's at (0, 0): the half
// pixel is added and taken off here and nowhere else.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/colmap/model.h"
#include "pliant/geometry/rigid3.h"

namespace pliant::colmap {

// Fails with kInvalidArgument for a model that Pliant does not have, or as Camera::Create does.
Result<pliant::Camera> ToPliant(const Camera& camera);
Camera FromPliant(const pliant::Camera& camera, std::uint32_t id);

// Normalizes the quaternion. Fails with kInvalidArgument for numbers that are none and a quaternion of zeros.
Result<Rigid3> ToPliant(const Pose& pose);
Pose FromPliant(const Rigid3& pose);

Eigen::Vector3d ToPliant(const Point3D& point);  // where it is
Eigen::Vector2d ToPliant(const Point2D& point);
Point2D FromPliant(const Eigen::Vector2d& pixel, std::uint64_t point3D_id);

// The camera of the file cameras.txt or cameras.bin that has this id, or the only one. Fails as ReadCameras does, and
// with kInvalidArgument if there is no such camera, or several and no id.
Result<pliant::Camera> ReadCamera(const std::string& path, std::optional<int> camera_id = {});

}  // namespace pliant::colmap
