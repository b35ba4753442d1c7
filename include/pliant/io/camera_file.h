// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Calibration files. Three kinds are recognized by what they contain, whatever they are called:
// - Pliant's camera.yaml: model, width, height, params, and optionally fps, depth_scale, baseline, unit (mm, or m: of
//   depth_scale, baseline and the poses beside it, which become mm), and the photometric calibration: gamma,
//   vignetting, light_spread, light_axis;
// - COLMAP's cameras.txt and cameras.bin, whose first pixel's center is (0.5, 0.5): the half pixel is taken off here;
// - OpenCV's calibrations, YAML or XML: a camera matrix (M1, K1, K, M, camera_matrix, cameraMatrix, ...), distortion
//   coefficients (D1, D, distortion_coefficients, distCoeffs, ...) and, where they are written, the image size and
//   `camera_model` or `distortion_model` (fisheye, equidistant and kannala_brandt mean OPENCV_FISHEYE). Of a stereo
//   calibration the first camera is read.
// Every failure is one sentence with the file's name: what is wrong, where, and what to do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

struct ImageSize {
  int width = 0;
  int height = 0;
};

// Of numbers that a file says; nothing unless they are whole, from 1 to 10^6.
std::optional<ImageSize> ToImageSize(double width, double height);

// Frames a second, which give times that a run writes and reads again: from 0.001 to 100000. Fails with
// kInvalidArgument.
Status CheckFps(double fps);

struct CameraFileOptions {
  std::optional<int> camera_id;         // which of several cameras in a COLMAP file
  std::optional<ImageSize> image_size;  // used where the file does not say the size, as OpenCV's often do not
};

struct CameraFile {
  Camera camera;
  std::optional<double> fps = std::nullopt;
  std::optional<double> depth_scale = std::nullopt;  // mm per unit of a depth image
  // The right camera's center is at +baseline on the left one's x axis.
  std::optional<double> baseline_mm = std::nullopt;
  double unit_mm = 1.0;  // of the poses beside the file, mm
  std::optional<PhotometricCalibration> photometric = std::nullopt;
  // OpenCV's k3 to k6 are not part of the OPENCV model. Where they are small, k1 and k2 are fitted again to the whole
  // distortion over the image, and this is the largest difference that is left, px; 0: nothing had to be fitted. Above
  // kLargestRefitPx the file is refused.
  double refit_residual_px = 0;
};

inline constexpr double kLargestRefitPx = 0.1;

// A stereo calibration of raw images, as OpenCV writes one: M1, D1, M2, D2, R, T. A point x of the left camera is at
// R x + T in the right one. Where T is shorter than kShortestBaseline_mm it is taken to be in meters.
struct StereoCalibration {
  struct Eye {
    double fx = 0, fy = 0, cx = 0, cy = 0;  // px
    std::vector<double> distortion;         // OpenCV's, any number of coefficients
  };
  Eye left;
  Eye right;
  Rigid3 right_from_left;  // mm
  std::optional<ImageSize> image_size;
  bool was_in_meters = false;
};

inline constexpr double kShortestBaseline_mm = 0.5;

// Nothing where the file is the calibration of one camera, of two without R and T, or of fisheyes, which cannot be
// rectified. Errors as ReadCameraFile.
Result<std::optional<StereoCalibration>> ReadStereoCalibration(const std::string& path);

// Writes it as OpenCV does (YAML: image_width, image_height, M1, D1, M2, D2, R, T), so that ReadStereoCalibration gives
// the same numbers back. Fails with kUnwritable.
Status WriteStereoCalibration(const std::string& path, const StereoCalibration& calibration);

// Fails with kNotFound, kUnreadable (not a calibration, or damaged) or kInvalidArgument (a calibration that cannot be
// meant: a wrong number of parameters, not-a-number, an unknown model, no image size, several cameras).
Result<CameraFile> ReadCameraFile(const std::string& path, const CameraFileOptions& options = {});
Result<Camera> ReadCamera(const std::string& path, const CameraFileOptions& options = {});

// Of the lengths in a camera.yaml that is written beside the depths of a run.
enum class LengthUnit {
  kMillimeters,
  kMapUnits,  // of a run that does not know what one is: the file names no unit, and ReadCameraFile takes 1 for it
};

// Writes a camera.yaml, so that ReadCameraFile gives the same numbers back. Fails with kUnwritable.
Status WriteCameraFile(const std::string& path, const CameraFile& file, LengthUnit unit = LengthUnit::kMillimeters);

}  // namespace pliant
