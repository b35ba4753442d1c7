// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/serialize.h"

#include "photometric/patch_solution.h"

namespace pliant {
namespace {

void Solve(const PatchLevel& level, BasisKind kind, int level_idx, PatchShape shape, const LucasKanadeOptions& options,
           std::vector<float>* solve, float* offsets) {
  const int blocks = kind == BasisKind::kTranslation ? 3 : 7;
  solve->resize(static_cast<std::size_t>(blocks * BlockOf(shape)));
  SolvePatch(level.values.data(), level.weights.empty() ? nullptr : level.weights.data(), kind, level_idx, shape,
             options, solve->data(), offsets);
}

bool HasShape(const PatchLevel& level, PatchShape shape) {
  const auto values = static_cast<std::size_t>((shape.size + 3) * shape.row_stride);
  return level.values.size() == values &&
         (level.weights.empty() || level.weights.size() == static_cast<std::size_t>(BlockOf(shape)));
}

}  // namespace

void Serialize(StateArchive& archive, const LucasKanadeOptions& options, ReferencePatch& patch) {
  archive(patch.center.x, patch.center.y, patch.size);
  if (patch.size < 0 || patch.size > kMaxPatchSize) archive.Fail();
  bool has_affine = !patch.solve_affine.empty();
  archive(has_affine);
  patch.levels.resize(archive.Size(patch.levels.size()));
  for (PatchLevel& level : patch.levels) archive(level.values, level.weights, level.support, level.failure);
  if (!archive.reads() || !archive.ok()) return;
  const PatchShape shape = ShapeOf(patch.size);
  for (int k = 0; k < static_cast<int>(patch.levels.size()); ++k) {
    PatchLevel& level = patch.levels[static_cast<std::size_t>(k)];
    if (level.failure != PatchFailure::kNone) continue;
    if (!HasShape(level, shape)) return archive.Fail();
    Solve(level, BasisKind::kTranslation, k, shape, options, &level.solve, level.offsets.data());
  }
  patch.solve_affine.clear();
  if (!has_affine || patch.failure() != PatchFailure::kNone) return;
  Solve(patch.levels.front(), BasisKind::kAffine, 0, shape, options, &patch.solve_affine, patch.offsets_affine.data());
}

}  // namespace pliant
