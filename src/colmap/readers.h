// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP's files, each read into its part of a model. They fail with kNotFound, or with kUnreadable and a sentence that
// names the file, and the line in text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/colmap/model.h"

namespace pliant::colmap {

// A sentence for a name or number that is no camera model of COLMAP's.
std::string UnknownCameraModel(std::string_view name_or_number);

Result<std::vector<Camera>> ReadTextCameras(const std::string& path);
Result<std::vector<Image>> ReadTextImages(const std::string& path, Observations observations);
Result<std::vector<Point3D>> ReadTextPoints(const std::string& path, Observations observations);
Result<std::vector<Rig>> ReadTextRigs(const std::string& path);
Result<std::vector<Frame>> ReadTextFrames(const std::string& path);

Result<std::vector<Camera>> ReadBinaryCameras(const std::string& path);
Result<std::vector<Image>> ReadBinaryImages(const std::string& path, Observations observations);
Result<std::vector<Point3D>> ReadBinaryPoints(const std::string& path, Observations observations);
Result<std::vector<Rig>> ReadBinaryRigs(const std::string& path);
Result<std::vector<Frame>> ReadBinaryFrames(const std::string& path);

}  // namespace pliant::colmap
