// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A data set whose images carry numbers that its depth images and poses go by.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "datasets/data_set.h"
#include "datasets/set_files.h"

namespace pliant {

struct NumberedSet {
  std::filesystem::path folder;
  std::map<int, std::filesystem::path> images;  // by number
  std::map<int, std::filesystem::path> right = {};
  std::string baseline_hint = {};  // where right images want one: what says it
  std::map<int, std::filesystem::path> depth = {};
  ReadDepth read_depth = nullptr;
  std::map<int, Rigid3> world_from_cam = {};  // mm
};

// In the order of their numbers. Warns of numbers that are left out, and of right images without a baseline; with one
// every image must have its right image (kNotFound).
Result<DataSet> OpenNumberedSet(const SequenceRequest& request, NumberedSet set,
                                const std::optional<SourceCalibration>& published);

// The camera of all recordings of a data set.
Result<SourceCalibration> PublishedCamera(const std::string& data_set, CameraModelId model, int width, int height,
                                          const std::vector<double>& params, double fps = 30.0);

}  // namespace pliant
