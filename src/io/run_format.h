// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The run folder's file names and columns, which its writer and its reader share.
#pragma once

#include <array>
#include <string_view>

namespace pliant {

inline constexpr std::string_view kRunProgram = "pliant";
inline constexpr std::string_view kObservationColumns = "frame,point_id,u_px,v_px,x,y,z,ssim";
inline constexpr std::string_view kObservationColumnsWithoutSsim = "frame,point_id,u_px,v_px,x,y,z";
inline constexpr std::string_view kFrameColumns =
    "frame,timestamp,state,tracked,optimized,lost,added,cost_reprojection,cost_spatial,cost_temporal,cost_edge_length,"
    "median_reprojection_error_px";
inline constexpr int kNumFrameColumns = 12;
inline constexpr std::string_view kStagePrefix = "ms_";

// Everything that a run may leave, which the next one in the same folder deletes.
inline constexpr std::array<std::string_view, 14> kRunFiles = {
    "config.yaml",         "run.json",          "run.json.tmp",      "trajectory.txt",
    "frames.csv",          "observations.csv",  "map.ply",           "sparse/cameras.txt",
    "sparse/cameras.bin",  "sparse/images.txt", "sparse/images.bin", "sparse/points3D.txt",
    "sparse/points3D.bin", "config.yaml.tmp"};

}  // namespace pliant
