// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/make_initializer.h"

namespace pliant {

void InitOptions::List(OptionTable& table) {
  table.BeginGroup("Init", "the first map");
  table.AddChoice("method", &method,
                  "window: all frames since the reference, the scene deforming; gated: waits until two views can carry "
                  "a map; paper: 3 frames apart, as published; stereo: a pair of images; depth: the "
                  "sequence's own depth image; colmap_model: the points of a COLMAP model");
  monocular.List(table);
  stereo.List(table);
  depth.List(table);
  model.List(table);
  window.List(table);
}

std::unique_ptr<Initializer> MakeInitializer(const InitOptions& options, Random random) {
  switch (options.method) {
    case InitMethod::kStereo:
      return MakeKnownPointsInitializer(
          {.name = "stereo", .source = "the pair of images", .unit_mm = 1.0, .min_points = options.stereo.min_points},
          options.monocular.nominal_depth_mm);
    case InitMethod::kDepth:
      return MakeDepthInitializer(options.depth);
    case InitMethod::kColmapModel:
      return MakeKnownPointsInitializer({.name = "colmap_model",
                                         .source = "the model",
                                         .unit_mm = options.model.unit_mm,
                                         .min_points = options.model.min_points},
                                        options.monocular.nominal_depth_mm);
    case InitMethod::kPaper:
      return MakeMonocularInitializer(options.monocular, MonocularGates::kPaper, random);
    case InitMethod::kGated:
      return MakeMonocularInitializer(options.monocular, MonocularGates::kGated, random);
    case InitMethod::kWindow:
      break;
  }
  return MakeWindowInitializer(options.window, options.monocular.nominal_depth_mm);
}

}  // namespace pliant
