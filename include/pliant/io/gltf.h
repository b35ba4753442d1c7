// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A mesh that deforms, and the camera that saw it, as one glTF 2.0 file (.glb), which Blender, browsers and slide
// programs play. Its frame is glTF's: meters, right-handed, Y up. One map unit becomes one millimeter.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/mesh.h"

namespace pliant {

// Where the vertices are at a time.
struct MeshKey {
  int frame_idx = 0;
  double time_s = 0;
  std::vector<Eigen::Vector3f> positions;  // a vertex each, world frame, map units
};

struct CameraKey {
  double time_s = 0;
  Rigid3 world_from_cam;
};

struct MeshAnimation {
  const Mesh& mesh;                 // undeformed, world frame, map units
  std::string_view texture_jpeg;    // a JPEG file's bytes; empty: the vertices' colors
  std::span<const MeshKey> keys;    // times increase; between two of them positions change linearly
  std::span<const CameraKey> path;  // times increase
  // glTF knows neither distortion nor a principal point: the file's camera has the smallest view around the optical
  // axis that shows the whole image, of at most 150 degrees, and the intrinsics in its extras.
  const Camera& camera;
  int submap = 0;  // of the run, whose world this is
};

// Keys are morph targets, of which one at a time has weight 1; all weights 0: the undeformed mesh. A mesh without
// triangles is refused with kInsufficient. Fails with kUnwritable.
Status WriteGlb(const std::string& path, const MeshAnimation& animation);

// What WriteGlb wrote: every vertex is there once for each of its places in the texture.
struct GltfMesh {
  Mesh mesh;                  // undeformed, map units; without colors
  std::string texture_jpeg;   // the file's bytes; empty: none
  std::vector<MeshKey> keys;  // times from that of the first key or camera
  int submap = 0;
};

// Fails with kNotFound or kUnreadable, also for a file that another program wrote.
Result<GltfMesh> ReadGlb(const std::string& path);

}  // namespace pliant
