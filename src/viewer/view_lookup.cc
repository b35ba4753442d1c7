// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/view_lookup.h"

#include <algorithm>

namespace pliant {

double AspectOf(const View& view) {
  constexpr double kUsual = 0.75;
  return view.camera ? static_cast<double>(view.camera->height()) / view.camera->width() : kUsual;
}

bool HasTruth(const View& view) {
  const auto known = [](const ViewedObservation& o) { return o.truth.allFinite(); };
  const auto any = [&](const ViewedFrame& frame) { return std::ranges::any_of(frame.observations, known); };
  return !view.truth.empty() ||
         std::ranges::any_of(view.runs, [&](const ViewedRun& run) { return std::ranges::any_of(run.frames, any); });
}

const ViewedFrame* FindFrame(const ViewedRun& run, int frame_idx) {
  const auto frame = std::lower_bound(run.frames.begin(), run.frames.end(), frame_idx,
                                      [](const ViewedFrame& f, int wanted) { return f.row.frame_idx < wanted; });
  return frame != run.frames.end() && frame->row.frame_idx == frame_idx ? &*frame : nullptr;
}

}  // namespace pliant
