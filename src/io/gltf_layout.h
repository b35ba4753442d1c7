// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How our glTF files are laid out: what their writer and their reader have in common.
#pragma once

#include <Eigen/Core>

namespace pliant::gltf {

inline constexpr float kMetersPerUnit = 0.001F;
inline constexpr const char* kGenerator = "Pliant ";
inline constexpr const char* kSigma = "_SIGMA";          // an attribute of our own: standard deviation of the distance
inline constexpr const char* kFrames = "frames";         // extras: of the keys
inline constexpr const char* kSigmaUnit = "sigma_unit";  // extras; earlier versions, which had map units, lack it
inline constexpr const char* kMeters = "m";
inline constexpr const char* kSubmap = "submap";
inline constexpr const char* kTimes = "times_s";  // extras: of the keys; earlier versions have the animation's alone
inline constexpr const char* kGaps = "gaps";      // extras; earlier versions lack them

// From x right, y down, z forward to glTF's x right, y up, z backward, and back.
inline Eigen::Vector3f InGltf(const Eigen::Vector3f& v) { return {v.x(), -v.y(), -v.z()}; }

}  // namespace pliant::gltf
