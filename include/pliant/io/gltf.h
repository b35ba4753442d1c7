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

// Frames in a row without a surface, as where tracking was lost. Until the one before the next frame with a surface the
// mesh and the camera stay where they were last: how they moved is not known.
struct MotionGap {
  int last_frame_idx = 0;  // with a surface, before the gap
  int next_frame_idx = 0;  // and after it
  double last_time_s = 0;
  double held_until_s = 0;
  double next_time_s = 0;
};

struct MeshAnimation {
  const Mesh& mesh;                 // undeformed, world frame, map units
  std::string_view texture_jpeg;    // a JPEG file's bytes; empty: the vertices' colors
  std::span<const MeshKey> keys;    // times increase; in between positions change linearly, but for gaps
  std::span<const CameraKey> path;  // times increase
  // glTF knows neither distortion nor a principal point: the file's camera has the smallest view around the optical
  // axis that shows the whole image, of at most 150 degrees, and the intrinsics in its extras.
  const Camera& camera;
  int submap = 0;                        // of the run, whose world this is
  std::span<const MotionGap> gaps = {};  // in the order of time
};

// Keys are morph targets, of which one at a time has weight 1; all weights 0: the undeformed mesh. A mesh without
// triangles is refused with kInsufficient. Fails with kUnwritable.
Status WriteGlb(const std::string& path, const MeshAnimation& animation);

// What WriteGlb wrote, times from that of the first key or camera: every vertex is there once for each of its places in
// the texture.
struct GltfMesh {
  Mesh mesh;                 // undeformed, map units; without colors
  std::string texture_jpeg;  // the file's bytes; empty: none
  std::vector<MeshKey> keys;
  int submap = 0;
  std::vector<MotionGap> gaps = {};
};

// Fails with kNotFound or kUnreadable, also for a file that another program wrote.
Result<GltfMesh> ReadGlb(const std::string& path);

}  // namespace pliant
