// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A deforming scene that can be photographed at any frame and asked for the truth. The surface is a fine triangle mesh;
// its vertices are moved by the deformation's formula, so a material point (a triangle and a position in it) has a
// position at every time. Rays are Embree's; hit positions are recomputed in double precision from the triangle that
// was hit. Frames: world and camera as in options.h and camera.h, millimeters, seconds from frame 0. A frame is one of
// the recording: where the camera's frames are lost (Recording.lost_share) there are fewer, or the one before is there
// again at a later time. Images are those of the camera; WriteSequence compresses them. The same options give the same
// pixels whatever the number of threads. One Simulator serves one caller at a time: it is posed frame by frame.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/simulation/options.h"

namespace pliant {

// A point that belongs to the material: it keeps these coordinates while the surface moves.
struct MaterialPoint {
  std::uint32_t triangle_idx = 0;
  double b1 = 0;  // barycentric weights of the triangle's second and third corner
  double b2 = 0;
};

struct SurfaceHit {
  MaterialPoint point;
  Eigen::Vector3d point_in_world;  // at the frame's time
  double depth_mm = 0;             // z in the camera frame
};

enum class Visibility {
  kVisible,
  kOccluded,      // something else lies before it
  kOutsideImage,  // it projects outside, or not at all
};

struct MaterialObservation {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d pixel = Eigen::Vector2d::Constant(std::nan(""));  // stays so where the point does not project
  double depth_mm = 0;
  Visibility visibility = Visibility::kOutsideImage;
};

// Of a stereo pair (Camera.baseline_mm > 0); the left camera is the one that poses and depth belong to. The right one
// has the same parameters and orientation: the pair is rectified where the model has no distortion.
enum class Eye { kLeft, kRight };

struct SimulatedFrame {
  cv::Mat image;  // CV_8UC3, BGR
  cv::Mat right;  // the same of the right camera; empty where there is none
  cv::Mat depth;  // CV_32FC1, z along the optical axis at the pixel's center, mm; 0: nothing was hit
};

class Simulator {
 public:
  // Builds the scene. Fails with kInvalidArgument for options out of range, or a camera that sees nothing, leaves the
  // lumen, comes nearer to the wall than the clearance or passes through it (the sentence names the frame); and as the
  // readers of a mesh (kNotFound, kUnreadable, kInsufficient) and of a path of poses do.
  static Result<Simulator> Create(const SimulationOptions& options);

  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;
  ~Simulator();

  // As they were given, with the names of files made absolute.
  const SimulationOptions& options() const;
  // What the scene cannot be by its options and is made as all the same, one sentence each: a surface that folds over.
  const std::vector<std::string>& warnings() const;
  const Camera& camera() const;
  int frame_count() const;  // of the recording

  // Truth that needs no rendering. A frame's timestamp; they increase.
  double TimeOf(int frame_idx) const;
  // The moment that a frame shows and that all its truth belongs to: its timestamp, or that of the frame it repeats.
  double ShownTimeOf(int frame_idx) const;
  Rigid3 WorldFromCamera(int frame_idx, Eye eye = Eye::kLeft) const;
  Eigen::Vector3d RestPosition(const MaterialPoint& point) const;
  Eigen::Vector3d Position(const MaterialPoint& point, int frame_idx) const;

  // What the camera of a frame sees at pixels (sub-pixel positions too); nothing where the ray leaves the scene.
  std::vector<std::optional<SurfaceHit>> HitsAt(int frame_idx, std::span<const Eigen::Vector2d> pixels,
                                                Eye eye = Eye::kLeft);
  // Where material points are seen in a frame.
  std::vector<MaterialObservation> Observe(int frame_idx, std::span<const MaterialPoint> points, Eye eye = Eye::kLeft);

  // Makes the texture and meters the light; the first Render does it where nobody asked for it.
  void PrepareRendering();
  SimulatedFrame Render(int frame_idx);

 private:
  struct State;
  explicit Simulator(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pliant
