// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One calibrated camera. Frame: x right, y down, z forward. Pixel (0, 0) is the CENTER of the first pixel (OpenCV's
// convention; COLMAP's files differ by half a pixel, which only io knows). Models and parameter orders are COLMAP's:
//   SIMPLE_PINHOLE f,cx,cy   PINHOLE fx,fy,cx,cy   SIMPLE_RADIAL f,cx,cy,k   RADIAL f,cx,cy,k1,k2
//   OPENCV fx,fy,cx,cy,k1,k2,p1,p2   OPENCV_FISHEYE fx,fy,cx,cy,k1,k2,k3,k4 (Kannala and Brandt, PAMI 2006)
// The model is dispatched once a call: for many points use the batch functions or Visit.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/models.h"

namespace pliant {

enum class CameraModelId : int {  // COLMAP's numbers
  kSimplePinhole = 0,
  kPinhole = 1,
  kSimpleRadial = 2,
  kRadial = 3,
  kOpenCv = 4,
  kOpenCvFisheye = 5,
};

template <>
struct EnumNames<CameraModelId> {
  static constexpr std::array kNames = {std::pair{CameraModelId::kSimplePinhole, std::string_view("SIMPLE_PINHOLE")},
                                        std::pair{CameraModelId::kPinhole, std::string_view("PINHOLE")},
                                        std::pair{CameraModelId::kSimpleRadial, std::string_view("SIMPLE_RADIAL")},
                                        std::pair{CameraModelId::kRadial, std::string_view("RADIAL")},
                                        std::pair{CameraModelId::kOpenCv, std::string_view("OPENCV")},
                                        std::pair{CameraModelId::kOpenCvFisheye, std::string_view("OPENCV_FISHEYE")}};
};

struct Projection {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> d_pixel_d_point;  // by the point in the camera frame, px per mm
};

class Camera {
 public:
  using Model = std::variant<SimplePinhole, Pinhole, SimpleRadial, Radial, OpenCv, OpenCvFisheye>;

  // Fails with kInvalidArgument for a wrong parameter count, numbers that are not finite, focal lengths or sizes that
  // are not positive, a focal length or principal point that no lens for this image has, or a distortion that folds
  // over within the circle inscribed in the image; the sentence says which. (Only that circle: endoscopes show a disc,
  // and their calibrations often fold in the black corners. Unproject answers nothing there.)
  static Result<Camera> Create(CameraModelId model, int width, int height, std::span<const double> params);
  static Result<Camera> Create(std::string_view model_name, int width, int height, std::span<const double> params);

  // The camera of the same image resized by `scale` > 0, its sides rounded to whole pixels. Fails as Create.
  Result<Camera> Resized(double scale) const;
  // The camera of a lens whose focal lengths are `factor` > 0 times as long, with the same distortion. Fails as Create.
  Result<Camera> WithFocalLengthTimes(double factor) const;

  CameraModelId model_id() const;
  std::string_view model_name() const { return EnumName(model_id()); }
  int width() const { return width_; }
  int height() const { return height_; }
  std::span<const double> params() const;  // in COLMAP's order, pixel origin as above
  double MeanFocalLengthPx() const;
  double HorizontalFocalLengthPx() const;  // fx: of a rectified pair, disparity = fx * baseline / depth

  // Calls `function(model)` with the concrete model; the way to write a loop that dispatches once.
  template <class Function>
  decltype(auto) Visit(Function&& function) const {
    return std::visit(std::forward<Function>(function), model_);
  }

  // The pixel of a point, or nothing where the model is not defined (behind a pinhole, beyond the angle at which the
  // distortion stops growing, not a number). The pixel may lie outside the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_cam) const;
  std::optional<Projection> ProjectWithJacobian(const Eigen::Vector3d& point_in_cam) const;
  // The unit ray through a pixel, in the camera frame, or nothing where no ray projects there.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  // The same for many: one result an input.
  std::vector<std::optional<Eigen::Vector2d>> Project(std::span<const Eigen::Vector3d> points_in_cam) const;
  std::vector<std::optional<Eigen::Vector3d>> Unproject(std::span<const Eigen::Vector2d> pixels) const;

  // Whether a pixel lies inside the image, at least `border_px` from the centers of its outermost pixels.
  bool Contains(const Eigen::Vector2d& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px && pixel.x() <= width_ - 1 - border_px &&
           pixel.y() <= height_ - 1 - border_px;
  }

 private:
  Camera(Model model, int width, int height) : model_(std::move(model)), width_(width), height_(height) {}

  Model model_;
  int width_;
  int height_;
};

}  // namespace pliant
