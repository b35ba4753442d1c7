// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/make_initializer.h"

namespace pliant {

void InitOptions::List(OptionTable& table) {
  table.BeginGroup("Init", "the first map");
  table.AddChoice("method", &method,
                  "window: all frames since the reference, the scene deforming; gated: waits until two views can carry "
                  "a map; paper: 3 frames apart, as published; depth: the "
                  "sequence's own depth image; colmap_model: the points of a COLMAP model");
  monocular.List(table);
  depth.List(table);
  model.List(table);
  window.List(table);
}

std::unique_ptr<Initializer> MakeInitializer(const InitOptions& options, Random random) {
  switch (options.method) {
    case InitMethod::kDepth:
      return MakeDepthInitializer(options.depth);
    case InitMethod::kColmapModel:
      return MakeModelInitializer(options.model, options.monocular.nominal_depth_mm);
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
