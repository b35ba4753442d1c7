// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Intrinsics of a camera from views of a flat board (Zhang, PAMI 2000): parameters of the camera and pose of the board
// in every view by bundle adjustment (Ceres) with a robust loss whose scale is the residuals' own. It is begun from
// several fields of view, so that no guess is needed, and the pose of a view begins with the homography between its
// rays and the board, so that fisheye lenses are no special case.
// Views whose residuals are clearly larger than the others' are left out. The model is chosen by held-out views: each
// group of views is fitted with the others' parameters, its pose from half of its points, and the error of the other
// half counts; the model with the fewest parameters wins whose error is not larger than the least one by more than a
// standard error, that of the difference or that of the least one itself. A model that contains it and predicts as well
// wins where both differ clearly at the image's border: points in its middle do not tell models apart that differ
// there. Standard deviations are the larger of the covariance's and of those of a grouped jackknife over the views,
// which also knows of errors that the points of a view share; both are widened for few views (Student's t).
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/board/board.h"
#include "pliant/board/find_board.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

enum class ModelChoice { kAuto, kSimplePinhole, kPinhole, kSimpleRadial, kRadial, kOpenCv, kOpenCvFisheye };
template <>
struct EnumNames<ModelChoice> {
  static constexpr std::array kNames = {std::pair{ModelChoice::kAuto, std::string_view("auto")},
                                        std::pair{ModelChoice::kSimplePinhole, std::string_view("SIMPLE_PINHOLE")},
                                        std::pair{ModelChoice::kPinhole, std::string_view("PINHOLE")},
                                        std::pair{ModelChoice::kSimpleRadial, std::string_view("SIMPLE_RADIAL")},
                                        std::pair{ModelChoice::kRadial, std::string_view("RADIAL")},
                                        std::pair{ModelChoice::kOpenCv, std::string_view("OPENCV")},
                                        std::pair{ModelChoice::kOpenCvFisheye, std::string_view("OPENCV_FISHEYE")}};
};

// Among which ModelChoice::kAuto chooses.
enum class Lenses { kAll, kPerspective };

// Of one view, in the order of the input.
struct FittedView {
  bool is_outlier = false;                         // left out: its residuals are larger than the others' by far
  Rigid3 cam_from_board;                           // mm
  double rms_px = 0;                               // of the residuals' lengths
  double tilt_deg = 0;                             // of the board against the image plane
  std::vector<Eigen::Vector2d> residuals_px = {};  // by point: measured minus projected
};

// How well views are predicted by the parameters of the others.
struct HeldOutError {
  CameraModelId model = CameraModelId::kPinhole;
  int num_params = 0;    // that are estimated; fewer than the model has: its last coefficients of distortion are 0
  double rms_px = 0;     // mean over the views
  double excess_px = 0;  // over the model with the least error, mean over the views
  double excess_sigma_px = 0;  // standard error of that mean
};

// How well it is known where the ray of a pixel is seen.
struct PixelAccuracy {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double sigma_px = 0;  // standard deviation: the covariance of the parameters carried to this pixel
  double model_gap_px =
      0;  // how far away another model sees the ray that predicts held-out views as well; 0: none does
  CameraModelId gap_model = CameraModelId::kPinhole;  // that model
};

// By views whose other parameters are held at those of all views.
struct FocalLengthEstimate {
  double px = 0;
  double sigma_px = 0;
};

struct CameraCalibration {
  Camera camera;
  std::vector<double> sigmas = {};  // standard deviation of each parameter, in Camera::params' order and units
  std::vector<FittedView> views = {};
  double rms_px = 0;                        // of the residuals' lengths, over the views that are not left out
  std::vector<HeldOutError> held_out = {};  // a model each, in EnumNames' order; where one was given, of that one
  // The image's corners and the middles of its sides, in which the extrapolation is largest. CalibrateImages
  // leaves out those where all images are dark.
  std::vector<PixelAccuracy> border = {};
  // Of the first and the second half of the views that are used, in their order; empty where they are too few.
  std::vector<FocalLengthEstimate> half_focal_lengths = {};

  double FocalLengthSigmaPx() const { return sigmas.front(); }
};

inline constexpr int kFewestCalibrationViews = 3;
// Standard deviation of the focal length, by the focal length, from which on views do not determine it.
inline constexpr double kLargestFocalLengthSigma = 0.05;

// Fails with kInsufficient for fewer than kFewestCalibrationViews views, for views that do not determine the focal
// length (all of one pose, or all parallel to the image), and where no model fits. The tasks of `progress`, of which
// one may take a second with hundreds of views, are "start", "fit" and "check"; what it counts are models.
Result<CameraCalibration> CalibrateCamera(const CalibrationBoard& board, std::span<const BoardView> views, int width,
                                          int height, ModelChoice model, int threads, Lenses lenses = Lenses::kAll,
                                          const JobProgress& progress = {});

}  // namespace pliant
