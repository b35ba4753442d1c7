// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One mesh of all that the frames of a submap show, undeformed, and where its vertices are in every frame
// (docs/method.md, eq. V10 to V12).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/camera/camera.h"
#include "pliant/scene/mesh.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

// Undeformed positions of tracked points, world frame, map units.
using RestPositions = std::map<PointId, Eigen::Vector3d>;

enum class VertexView : std::uint8_t {
  kOutOfView = 0,  // outside of the image, or hidden: it moves as the points nearest to it
  kInView = 1,     // the frame has no depth of its own there
  kMeasured = 2,   // the frame's depth agrees
};

// The vertices of a mesh in a frame, one entry each.
struct MeshInFrame {
  std::vector<Eigen::Vector3d> positions;  // world frame, map units
  std::vector<float> sigmas;               // standard deviation of the distance from the camera, map units
  std::vector<VertexView> views;
};

class TrackedMesh {
 public:
  // A frame adds vertices at `columns` pixels across its image where it shows tissue that the mesh has not yet. The
  // result does not depend on `threads`.
  TrackedMesh(const Camera& camera, RestPositions rest, int columns, int threads);
  TrackedMesh(TrackedMesh&&) noexcept;
  TrackedMesh& operator=(TrackedMesh&&) noexcept;
  ~TrackedMesh();

  // A frame and its depth; frames in the order of time, none after Finish. A frame with fewer than 12 points adds
  // nothing.
  void Add(const SurfaceView& view, const DenseDepth& dense);
  // After the last frame: takes away the vertices that more frames contradict than confirm (they see another surface
  // behind them), and small pieces; gives the others their normals.
  void Finish();

  // World frame, map units; the sigmas are those of the frames that saw the vertices best.
  const Mesh& undeformed() const;

  // Nothing where the frame has fewer than 12 points. `dense` may be empty.
  std::optional<MeshInFrame> InFrame(const SurfaceView& view, const DenseDepth& dense) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pliant
