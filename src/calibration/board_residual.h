// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The error of a board's point in an image, for whatever model of camera.
#pragma once

#include <Eigen/Core>
#include <ceres/rotation.h>

#include "pliant/camera/camera.h"
#include "pliant/camera/models.h"

namespace pliant {

// Calls function.operator()<Model>() with the model of the id.
template <class Function>
auto WithModel(CameraModelId model, Function&& function) {
  switch (model) {
    case CameraModelId::kSimplePinhole:
      return function.template operator()<SimplePinhole>();
    case CameraModelId::kPinhole:
      return function.template operator()<Pinhole>();
    case CameraModelId::kSimpleRadial:
      return function.template operator()<SimpleRadial>();
    case CameraModelId::kRadial:
      return function.template operator()<Radial>();
    case CameraModelId::kOpenCv:
      return function.template operator()<OpenCv>();
    case CameraModelId::kOpenCvFisheye:
      break;
  }
  return function.template operator()<OpenCvFisheye>();
}

// `pose` is a rotation vector and a translation.
template <class T>
void Transform(const T* pose, const T* from, T* to) {
  ceres::AngleAxisRotatePoint(pose, from, to);
  for (int i = 0; i < 3; ++i) to[i] += pose[3 + i];
}

// Projected minus measured pixel of a point in the camera's frame. False where it cannot be projected.
template <class Model, class T>
bool PixelDifference(const T* params, const T* in_cam, const Eigen::Vector2d& pixel, T* residual) {
  if (!Model::ProjectUnbounded(params, in_cam, residual)) return false;
  residual[0] -= pixel.x();
  residual[1] -= pixel.y();
  return true;
}

// Of one point of the board.
template <class Model>
struct BoardResidual {
  Eigen::Vector3d point;
  Eigen::Vector2d pixel;

  template <class T>
  bool operator()(const T* params, const T* pose, T* residual) const {
    const T in_board[3] = {T(point.x()), T(point.y()), T(point.z())};
    T in_cam[3];
    Transform(pose, in_board, in_cam);
    return PixelDifference<Model>(params, in_cam, pixel, residual);
  }
};

// The same in the right camera of a pair.
template <class Model>
struct RightBoardResidual {
  Eigen::Vector3d point;
  Eigen::Vector2d pixel;

  template <class T>
  bool operator()(const T* params, const T* left_from_board, const T* right_from_left, T* residual) const {
    const T in_board[3] = {T(point.x()), T(point.y()), T(point.z())};
    T in_left[3];
    Transform(left_from_board, in_board, in_left);
    T in_right[3];
    Transform(right_from_left, in_left, in_right);
    return PixelDifference<Model>(params, in_right, pixel, residual);
  }
};

}  // namespace pliant
