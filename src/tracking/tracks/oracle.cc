// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/oracle.h"

namespace pliant {

bool OracleOptions::Any() const { return !Names().empty(); }

std::vector<std::string_view> OracleOptions::Names() const {
  std::vector<std::string_view> names;
  if (first_map == Switch::kOn) names.emplace_back("first_map");
  if (tracks == Switch::kOn) names.emplace_back("tracks");
  if (poses == Switch::kOn) names.emplace_back("poses");
  return names;
}

void OracleOptions::List(OptionTable& table) {
  table.BeginGroup("Oracle",
                   "parts of the method replaced by the truth of a simulated sequence, to see what bounds it");
  table.AddChoice("first_map", &first_map, "on: the first map's points have their true depths");
  table.AddChoice("tracks", &tracks, "on: points are at the pixels of the material points that they started on");
  table.Add("track_noise_px", &track_noise_px, "px",
            "standard deviation of the noise of each coordinate that is added to true tracks", 0, 100);
  table.AddChoice("poses", &poses, "on: the camera's poses are the true ones, and held");
}

}  // namespace pliant
