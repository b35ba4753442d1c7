// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/make_initializer.h"

namespace pliant {

void InitOptions::List(OptionTable& table) {
  table.BeginGroup("Init", "the first map");
  table.AddChoice("method", &method,
                  "gated: waits until two views can carry a map; paper: 3 frames apart, as published; depth: the "
                  "sequence's own depth image");
  monocular.List(table);
  depth.List(table);
}

std::unique_ptr<Initializer> MakeInitializer(const InitOptions& options, Random random) {
  switch (options.method) {
    case InitMethod::kDepth:
      return MakeDepthInitializer(options.depth);
    case InitMethod::kPaper:
      return MakeMonocularInitializer(options.monocular, MonocularGates::kPaper, random);
    case InitMethod::kGated:
      break;
  }
  return MakeMonocularInitializer(options.monocular, MonocularGates::kGated, random);
}

}  // namespace pliant
