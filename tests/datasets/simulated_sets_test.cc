// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Data sets that were rendered.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/data_set_files.h"

namespace pliant {
namespace {

using namespace data_set_files;

TEST_F(DataSets, ReadsSimCol3D) {
  std::string positions;
  std::string rotations;
  for (int k = 0; k < Frames(); ++k) {
    Write("Frames_S1/" + Numbered("FrameBuffer_%04d.png", k), Frame(k).image);
    Write("Frames_S1/" + Numbered("Depth_%04d.png", k), Steps(Frame(k).depth, 200.0 / 65536.0));
    const Rigid3 pose = InUnity(Pose(k));
    const auto& t = pose.translation;
    const auto& q = pose.rotation;
    positions += Line(" ", t.x() / 10, t.y() / 10, t.z() / 10);
    rotations += Line(" ", q.x(), q.y(), q.z(), q.w());
  }
  Text("SavedPosition_S1.txt", positions);
  Text("SavedRotationQuaternion_S1.txt", rotations);
  SceneCamera("Frames_S1/camera.yaml");
  ExpectTheScene(Path("Frames_S1"), {.kind = "simcol", .depth_mm = 0.01});
}

TEST_F(DataSets, ReadsC3vdInItsThreeLayouts) {
  std::string poses;
  for (int k = 0; k < Frames(); ++k) {
    Write("v1/" + std::to_string(k) + "_color.png", Frame(k).image);
    Write("v1/" + Numbered("%04d_depth.tiff", k), Steps(Frame(k).depth, 100.0 / 65535.0));
    Write("v2/rgb/" + Numbered("%04d.png", k), Frame(k).image);
    Write("v2/depth/" + Numbered("%04d.tiff", k), Steps(Frame(k).depth, 100.0 / 65535.0));
    Write("defcol/rgb/" + Numbered("%04d.png", k), Frame(k).image);
    Write("defcol/depth/" + Numbered("%04d_depth.png", k), Steps(Frame(k).depth, 100.0 / 65535.0));
    Write("defcol/normals/" + Numbered("%04d_normals.png", k), Frame(k).image);
    const Eigen::Matrix3d r = Pose(k).RotationMatrix();
    const Eigen::Vector3d& t = Pose(k).translation;
    poses += Line(",", r(0, 0), r(1, 0), r(2, 0), 0, r(0, 1), r(1, 1), r(2, 1), 0, r(0, 2), r(1, 2), r(2, 2), 0, t.x(),
                  t.y(), t.z(), 1);
  }
  Text("defcol/world_vertex_positions.bin", "vertices");
  for (const char* version : {"v1", "v2", "defcol"}) {
    Text(std::string(version) + "/pose.txt", poses);
    SceneCamera(std::string(version) + "/camera.yaml");
    ExpectTheScene(Path(version), {.kind = "c3vd", .depth_mm = 0.01});
  }
}

TEST_F(DataSets, ReadsSimulatedEndomapper) {
  std::string poses = "tX;tY;tZ;rX;rY;rZ;rW;time(s)\n";
  for (int k = 0; k < Frames(); ++k) {
    Write("seq/rgb/" + Numbered("image_%04d.png", k), Frame(k).image);
    cv::Mat buffer(Frame(k).depth.size(), CV_32FC3);
    for (int v = 0; v < buffer.rows; ++v)
      for (int u = 0; u < buffer.cols; ++u) {
        const float depth_dm = Frame(k).depth.at<float>(v, u) / 100.0F;
        const float d = depth_dm > 0 ? (1.0F / depth_dm - 0.25F) / 99.75F : 0.0F;
        buffer.at<cv::Vec3f>(v, u) = {0, 0, d};  // BGR
      }
    Write("seq/depth/" + Numbered("aov_image_%04d.exr", k), buffer);
    const Rigid3 pose = InUnity(Pose(k));
    const Eigen::Vector3d t = pose.translation / 100.0;
    const auto& q = pose.rotation;
    poses += Line(";", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), k / 30.0);
  }
  Text("seq/trajectory.csv", poses);
  SceneCamera("seq/camera.yaml");
  ExpectTheScene(Path("seq"), {.kind = "endomapper_simulated", .depth_mm = 0.3});  // half floats
}

TEST_F(DataSets, ReadsEndoSlam) {
  std::string poses = "tX,tY,tZ,rX,rY,rZ,rW,time\n";
  for (int k = 0; k < Frames(); ++k) {
    Write("Colon/Frames/" + Numbered("image_%04d.png", k), Frame(k).image);
    cv::Mat depth_cm;
    Frame(k).depth.convertTo(depth_cm, CV_8U, 0.1);
    cv::Mat rgba;
    cv::merge(std::vector<cv::Mat>{depth_cm, depth_cm, depth_cm, cv::Mat(depth_cm.size(), CV_8U, cv::Scalar(255))},
              rgba);
    Write("Colon/Pixelwise Depths/" + Numbered("aov_image_%04d.png", k), rgba);
    const Rigid3 pose = InUnity(Pose(k));
    const Eigen::Vector3d t = pose.translation / 1000.0;
    const auto& q = pose.rotation;
    poses += Line(",", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), k / 30.0);
  }
  Text("Colon/Poses/colon_position_rotation.csv", poses);
  SceneCamera("Colon/camera.yaml");
  ExpectTheScene(Path("Colon"), {.kind = "endoslam", .depth_mm = 5.1});
}

}  // namespace
}  // namespace pliant
