// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The files of a surface folder that hold meshes (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/vtk.h"
#include "pliant/scene/mesh.h"
#include "pliant/surface/tracked_mesh.h"

namespace pliant {

// A mesh in a frame; what it refers to outlives it.
struct DeformedMesh {
  const Mesh& undeformed;  // world frame, with its texture
  const MeshInFrame& now;
  Rigid3 cam_from_world;
  double timestamp_s = 0;

  std::vector<Eigen::Vector3f> Vertices() const;  // world frame
  Mesh SeenPart() const;                          // camera frame, with ids and views: what the frame shows of it
  Mesh Whole() const;                             // world frame
};

struct MeshFiles {
  bool obj = false;
  bool vtk = true;
};

// Of one submap.
class MeshWriter {
 public:
  // `suffix` distinguishes the files of several submaps.
  MeshWriter(std::filesystem::path folder, std::string suffix, MeshFiles files)
      : folder_(std::move(folder)), suffix_(std::move(suffix)), files_(files) {}

  // Removes the files of an earlier surface. Fails with kUnwritable.
  static Status RemoveEarlier(const std::filesystem::path& folder);

  // Fail with kUnwritable. First the undeformed mesh (world frame) with the texture (a JPEG
  // file's bytes) that obj/ refers to; then the
  // frames: mesh/ and obj/ in the camera's frame, vtp/ in the world's; then the list of these.
  Status WriteUndeformed(const Mesh& mesh, std::string_view texture_jpeg);
  // `name`: of the frame's files, without an ending.
  Status WriteFrame(const std::string& name, const DeformedMesh& mesh);
  Status Finish();

  // A file of the submap: NAME, with the suffix, and the ending.
  std::filesystem::path FileName(const std::string& name, const std::string& ending) const {
    return folder_ / (name + suffix_ + ending);
  }

 private:
  std::filesystem::path folder_;
  std::string suffix_;
  MeshFiles files_;
  std::vector<VtkTime> times_ = {};
};

}  // namespace pliant
