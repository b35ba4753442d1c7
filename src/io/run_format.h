// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The run folder's file names and columns, which its writer and its reader share.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace pliant {

inline constexpr std::string_view kRunProgram = "pliant";
inline constexpr std::string_view kObservationColumns = "frame,point_id,u_px,v_px,x,y,z,ssim,sigma_mm";
// Those that every observations.csv begins with; the others may be missing, and ones that nobody knows follow.
inline constexpr std::string_view kNeededObservationColumns = "frame,point_id,u_px,v_px,x,y,z";
inline constexpr std::size_t kNeededObservationColumnCount = 7;
inline constexpr std::string_view kSsimColumn = "ssim";
inline constexpr std::string_view kSigmaColumn = "sigma_mm";
inline constexpr std::string_view kPoseCovarianceFile = "pose_covariance.csv";
// The upper half, row by row.
inline constexpr std::string_view kPoseCovarianceColumns =
    "frame,x_x,x_y,x_z,x_rx,x_ry,x_rz,y_y,y_z,y_rx,y_ry,y_rz,z_z,z_rx,z_ry,z_rz,rx_rx,rx_ry,rx_rz,ry_ry,ry_rz,rz_rz";
// A column of frames.csv for each term of the cost stands between these, and one for each stage after them.
inline constexpr std::string_view kFrameColumnsBeforeCosts = "frame,timestamp,state,tracked,optimized,lost,added";
inline constexpr std::string_view kFrameColumnsAfterCosts = "median_reprojection_error_px,submap";
inline constexpr std::string_view kCostPrefix = "cost_";
inline constexpr std::string_view kStagePrefix = "ms_";
inline constexpr std::string_view kSubmapColumn = "submap";
inline constexpr std::string_view kLatencyColumn = "latency_ms";  // the last one; earlier versions had none

// What earlier versions called otherwise, in state, stages and reasons of losses: their name, and the one of today.
inline constexpr std::array kEarlierNames = {
    std::pair<std::string_view, std::string_view>{"initialising", "initializing"},  // a state
    std::pair<std::string_view, std::string_view>{"initialise", "initialize"},      // a stage
    std::pair<std::string_view, std::string_view>{"slid", "drifted"}};              // a reason of losses
inline std::string_view PresentName(std::string_view name) {
  for (const auto& [earlier, present] : kEarlierNames)
    if (name == earlier) return present;
  return name;
}

// Everything that a run may leave, which the next one in the same folder deletes; of several submaps also map_K.ply and
// models in sparse/K.
inline constexpr std::array<std::string_view, 13> kRunFiles = {"config.yaml",
                                                               "config.yaml.tmp",
                                                               "run.json",
                                                               "run.json.tmp",
                                                               "trajectory.txt",
                                                               "trajectory.txt.tmp",
                                                               "frames.csv",
                                                               "frames.csv.tmp",
                                                               "observations.csv",
                                                               "observations.csv.tmp",
                                                               "map.ply",
                                                               "pose_covariance.csv",
                                                               "pose_covariance.csv.tmp"};
// Of a refined run whose focal length was estimated.
inline constexpr std::string_view kEstimatedCamera = "camera.yaml";
// (pliant/io/checkpoint.h)
inline constexpr std::string_view kCheckpointFolder = "checkpoint";
inline constexpr std::string_view kCheckpointState = "checkpoint/state";
// The files that are written row by row.
inline constexpr std::array<std::string_view, 3> kRowFiles = {"trajectory.txt", "frames.csv", "observations.csv"};
inline constexpr std::array<std::string_view, 6> kModelFiles = {"cameras.txt", "cameras.bin",  "images.txt",
                                                                "images.bin",  "points3D.txt", "points3D.bin"};
inline std::string SubmapPly(int submap) { return submap == 0 ? "map.ply" : "map_" + std::to_string(submap) + ".ply"; }
inline std::string SubmapModel(int submap, int submaps) {
  return submaps > 1 ? "sparse/" + std::to_string(submap) : "sparse";
}

}  // namespace pliant
