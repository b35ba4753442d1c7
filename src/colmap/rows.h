// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The rows of COLMAP's files, appended to a buffer; for whole models and for those that are written as a stream.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "pliant/colmap/model.h"

namespace pliant::colmap {

// How text has its numbers.
enum class Digits {
  kExact,    // 17 significant ones, as COLMAP has them
  kRounded,  // quaternions to 1e-9, pixels and errors to 1e-4, lengths to 1e-6: half the size
};

void AppendTextCamera(const Camera& camera, std::string* out);
void AppendTextImage(const Image& image, Digits digits, std::string* out);
void AppendTextPoint(const Point3D& point, std::span<const TrackElement> track, Digits digits, std::string* out);
void AppendTextRig(const Rig& rig, std::string* out);
void AppendTextFrame(const Frame& frame, std::string* out);

void AppendBinaryCamera(const Camera& camera, std::string* out);
void AppendBinaryImage(const Image& image, std::string* out);
void AppendBinaryPoint(const Point3D& point, std::span<const TrackElement> track, std::string* out);
void AppendBinaryRig(const Rig& rig, std::string* out);
void AppendBinaryFrame(const Frame& frame, std::string* out);

// The comments at the beginning of a text file, to the number of its rows.
std::string CamerasHeader(std::uint64_t count);
std::string ImagesHeader(std::uint64_t count);
std::string PointsHeader(std::uint64_t count);
std::string RigsHeader(std::uint64_t count);
std::string FramesHeader(std::uint64_t count);

}  // namespace pliant::colmap
