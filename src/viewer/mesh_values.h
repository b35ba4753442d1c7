// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A mesh of the tissue where it is in a frame, and the figures that it can be colored by: the same as in the page of a
// report (web/src/surface.ts).
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/surface/mesh_geometry.h"
#include "pliant/viewer/figure.h"
#include "pliant/viewer/view.h"

namespace pliant {

// Whether it is known where the mesh is in a frame: from its first key to its last, but not in gaps; and without keys
// in every frame.
bool IsKnownIn(const GltfMesh& mesh, int frame_idx);

// In the mesh's world, in a frame in which it is known. Between two keys a vertex moves evenly, but in no gap.
std::vector<Eigen::Vector3f> PositionsAt(const GltfMesh& mesh, int frame_idx);

// The triangles without the seams of the texture, at which a vertex is there once for each side: of these the first.
std::vector<Triangle> SeamlessTriangles(const Mesh& mesh);

// One a vertex, NaN where it is not known: in the view's unit, of area the change by the undeformed one, of an error
// mm. `positions` are those in the frame, `seamless` the triangles without seams. Not for kImage.
std::vector<float> MeshValues(const ViewedMesh& mesh, SurfaceColor color, int frame_idx,
                              std::span<const Eigen::Vector3f> positions, std::span<const Triangle> seamless);

struct ValueRange {
  double low = 0;
  double high = 1;
};

// The same for all frames and runs: up to the 98th percentile of the magnitudes over the keys of all meshes; of a
// change, as far to both sides. Not for kImage.
ValueRange RangeOfMeshes(const View& view, SurfaceColor color);

}  // namespace pliant
