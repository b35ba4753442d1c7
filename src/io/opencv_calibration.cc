// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/opencv_calibration.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "pliant/base/text.h"

namespace pliant {
namespace {

// The first camera of a stereo pair first: a file that has M1 may have other things called M.
constexpr std::array<std::string_view, 9> kMatrixNames = {
    "M1", "K1", "camera_matrix", "cameraMatrix", "Camera_Matrix", "cameraMatrix1", "K", "M", "intrinsic_matrix"};
constexpr std::array<std::string_view, 10> kDistortionNames = {"D1",          "distortion_coefficients",
                                                               "distCoeffs",  "Distortion_Coefficients",
                                                               "distCoeffs1", "dist_coeffs",
                                                               "D",           "dist_coeff",
                                                               "distortion",  "distortionCoefficients"};
constexpr std::array<std::string_view, 4> kSecondMatrixNames = {"M2", "K2", "cameraMatrix2", "camera_matrix2"};
constexpr std::array<std::string_view, 3> kSecondDistortionNames = {"D2", "distCoeffs2", "dist_coeffs2"};
// OpenCV's order of distortion coefficients.
constexpr std::array<std::string_view, 14> kCoefficients = {"k1", "k2", "p1", "p2", "k3", "k4",    "k5",
                                                            "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"};

Status Invalid(const std::string& what) { return {ErrorCode::kInvalidArgument, what}; }

template <std::size_t kCount>
std::vector<double> FirstOf(const CalibrationEntries& entries, const std::array<std::string_view, kCount>& names) {
  for (const std::string_view name : names)
    if (auto values = entries.numbers(name); !values.empty()) return values;
  return {};
}

Result<ImageSize> Size(const CalibrationEntries& entries, const CameraFileOptions& options) {
  std::vector<double> size;
  for (const std::string_view name : {"image_size", "imageSize", "size", "resolution"})
    if (size.size() != 2) size = entries.numbers(name);
  for (const auto& [width, height] :
       {std::pair("image_width", "image_height"), std::pair("image_Width", "image_Height"),
        std::pair("imageWidth", "imageHeight"), std::pair("width", "height")}) {
    if (size.size() == 2) break;
    size = entries.numbers(width);
    const auto second = entries.numbers(height);
    size.insert(size.end(), second.begin(), second.end());
  }
  if (size.size() == 2) {
    if (const auto whole = ToImageSize(size[0], size[1])) return *whole;
    return Invalid("the image size is " + FormatDouble(size[0]) + " x " + FormatDouble(size[1]) +
                   "; give whole numbers of pixels");
  }
  if (options.image_size) return *options.image_size;
  return Invalid("the image size is not in the file; add image_width and image_height");
}

enum class Lens { kPerspective, kFisheye };

Result<Lens> LensOf(const CalibrationEntries& entries) {
  const std::vector<std::string> fisheye = {
      "fisheye", "equidistant", "kannala_brandt",  "kannala-brandt", "kannalabrandt",
      "kb",      "kb4",         "kannala_brandt4", "kannalabrandt8", "opencv_fisheye"};
  const std::vector<std::string> perspective = {
      "pinhole", "plumb_bob", "rational_polynomial", "radtan", "radial-tangential", "brown", "perspective",
      "opencv",  "none"};
  if (const auto flag = entries.numbers("fisheye_model"); !flag.empty() && flag[0] != 0.0) return Lens::kFisheye;
  Lens lens = Lens::kPerspective;
  for (const std::string_view name : {"camera_model", "distortion_model", "model", "cameraModel", "distortionModel"}) {
    std::string value = entries.text(name);
    std::transform(value.begin(), value.end(), value.begin(), [](unsigned char c) { return std::tolower(c); });
    if (value.empty() || std::find(perspective.begin(), perspective.end(), value) != perspective.end()) continue;
    if (std::find(fisheye.begin(), fisheye.end(), value) == fisheye.end()) {
      std::vector<std::string> known = fisheye;
      known.insert(known.end(), perspective.begin(), perspective.end());
      return Invalid("there is no " + std::string(name) + " " + Quoted(value) + "; did you mean " +
                     Quoted(NearestName(value, known)) + "?");
    }
    lens = Lens::kFisheye;
  }
  return lens;
}

// OpenCV's whole distortion of a point at depth 1, without thin prisms and tilts.
Eigen::Vector2d DistortFully(const Eigen::Vector2d& x, const std::vector<double>& d) {
  const double r2 = x.squaredNorm();
  const double radial = (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / (1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  return x * radial + Eigen::Vector2d(2 * d[2] * x.x() * x.y() + d[3] * (r2 + 2 * x.x() * x.x()),
                                      d[2] * (r2 + 2 * x.y() * x.y()) + 2 * d[3] * x.x() * x.y());
}

struct Refit {
  double k1 = 0;
  double k2 = 0;
  double residual_px = 0;
};

// The k1 and k2 that come closest, in least squares over the image, to the whole distortion.
Refit FitOpenCv(const std::vector<double>& k, const std::vector<double>& d, ImageSize size) {
  constexpr int kColumns = 33;
  constexpr int kRows = 25;
  std::vector<cv::Point2d> pixels;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kColumns; ++i)
      pixels.emplace_back((size.width - 1.0) * i / (kColumns - 1), (size.height - 1.0) * j / (kRows - 1));
  std::vector<cv::Point2d> undistorted;
  const cv::Matx33d camera(k[0], 0, k[2], 0, k[4], k[5], 0, 0, 1);
  cv::undistortPoints(pixels, undistorted, camera, d, cv::noArray(), cv::noArray(),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-9));

  const auto offset = [&](const cv::Point2d& p) -> Eigen::Vector2d {  // what k1 r^2 x + k2 r^4 x has to be, px
    const Eigen::Vector2d x(p.x, p.y);
    const Eigen::Vector2d rest = DistortFully(x, {0, 0, d[2], d[3], 0, 0, 0, 0});
    return (DistortFully(x, d) - rest).cwiseProduct(Eigen::Vector2d(k[0], k[4]));
  };
  Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  const auto columns = [&](const cv::Point2d& p) {
    const double r2 = p.x * p.x + p.y * p.y;
    const Eigen::Vector2d x(k[0] * p.x, k[4] * p.y);
    return Eigen::Matrix2d{{x.x() * r2, x.x() * r2 * r2}, {x.y() * r2, x.y() * r2 * r2}};
  };
  for (const cv::Point2d& p : undistorted) {
    a += columns(p).transpose() * columns(p);
    b += columns(p).transpose() * offset(p);
  }
  const Eigen::Vector2d fit = a.fullPivLu().solve(b);
  Refit refit{fit[0], fit[1], 0};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const cv::Point2d& p = undistorted[i];
    // Where the distortion folds over, the point that was found does not lead back to its pixel.
    const Eigen::Vector2d again = DistortFully({p.x, p.y}, d).cwiseProduct(Eigen::Vector2d(k[0], k[4]));
    const Eigen::Vector2d pixel(pixels[i].x - k[2], pixels[i].y - k[5]);
    const double difference =
        std::max((columns(p) * fit - offset(p)).norm(), (again - pixel).norm() > 1.0 ? (again - pixel).norm() : 0.0);
    if (!(difference <= refit.residual_px)) refit.residual_px = difference;
  }
  return refit;
}

Result<CameraFile> Perspective(const std::vector<double>& k, std::vector<double> d, ImageSize size) {
  constexpr std::array<std::size_t, 6> kCounts = {0, 4, 5, 8, 12, 14};
  if (std::find(kCounts.begin(), kCounts.end(), d.size()) == kCounts.end())
    return Invalid("there are " + std::to_string(d.size()) +
                   " distortion coefficients; OpenCV has 4, 5 or 8 (k1 k2 p1 p2 k3 k4 k5 k6)");
  d.resize(kCoefficients.size(), 0.0);
  for (std::size_t i = 8; i < d.size(); ++i)
    if (d[i] != 0.0)
      return Invalid("the distortion coefficient " + std::string(kCoefficients[i]) + " is " + FormatDouble(d[i]) +
                     ", which no camera model of Pliant can represent; calibrate with k1 k2 p1 p2 only");
  d.resize(8);
  double residual_px = 0;
  std::string names;
  for (std::size_t i = 4; i < 8; ++i)
    if (d[i] != 0.0) names += (names.empty() ? "" : ", ") + std::string(kCoefficients[i]) + " = " + FormatDouble(d[i]);
  if (!names.empty()) {
    const Refit refit = FitOpenCv(k, d, size);
    if (!(refit.residual_px <= kLargestRefitPx))
      return Invalid("the distortion coefficients " + names +
                     " are not part of the OPENCV model, and k1 and k2 alone "
                     "miss the distortion by up to " +
                     FormatDouble(std::round(refit.residual_px * 1e3) / 1e3) +
                     " px; calibrate with k1 k2 p1 p2 only, or rectify the images");
    d[0] = refit.k1;
    d[1] = refit.k2;
    residual_px = refit.residual_px;
  }
  const bool distorted = std::any_of(d.begin(), d.end(), [](double c) { return c != 0.0; });
  std::vector<double> params = {k[0], k[4], k[2], k[5]};
  if (distorted) params.insert(params.end(), d.begin(), d.begin() + 4);
  auto camera =
      Camera::Create(distorted ? CameraModelId::kOpenCv : CameraModelId::kPinhole, size.width, size.height, params);
  if (!camera.ok()) return camera.status();
  CameraFile file{std::move(camera).value()};
  file.refit_residual_px = residual_px;
  return file;
}

}  // namespace

bool HasCameraMatrix(const CalibrationEntries& entries) { return !FirstOf(entries, kMatrixNames).empty(); }

namespace {

Status CheckCameraMatrix(const std::vector<double>& k) {
  if (k.size() != 9) return Invalid("the camera matrix has " + std::to_string(k.size()) + " numbers, not 3 x 3");
  for (const double value : k)
    if (!std::isfinite(value)) return Invalid("the camera matrix has an entry that is not a finite number");
  if (k[1] != 0.0)
    return Invalid("the camera matrix has a skew of " + FormatDouble(k[1]) + "; no camera model has one");
  if (k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0)
    return Invalid("the camera matrix is not of the form [fx 0 cx; 0 fy cy; 0 0 1]");
  return Status::Ok();
}

Status CheckDistortion(const std::vector<double>& d) {
  for (std::size_t i = 0; i < d.size(); ++i)
    if (!std::isfinite(d[i]))
      return Invalid("the distortion coefficient number " + std::to_string(i + 1) + " is not a finite number");
  return Status::Ok();
}

Result<StereoCalibration::Eye> EyeOf(const std::vector<double>& k, const std::vector<double>& d) {
  for (const Status& status : {CheckCameraMatrix(k), CheckDistortion(d)})
    if (!status.ok()) return status;
  if (!(k[0] > 0.0 && k[4] > 0.0)) return Invalid("a focal length of the camera matrix is not positive");
  return StereoCalibration::Eye{k[0], k[4], k[2], k[5], d};
}

}  // namespace

Result<std::optional<StereoCalibration>> StereoFromOpenCv(const CalibrationEntries& entries) {
  const std::vector<double> second = FirstOf(entries, kSecondMatrixNames);
  if (second.empty() || !HasCameraMatrix(entries)) return std::optional<StereoCalibration>();
  // Without R and T, and of fisheyes, which cannot be rectified, it is the calibration of its first camera.
  const auto lens = LensOf(entries);
  if (!lens.ok()) return lens.status();
  if (*lens == Lens::kFisheye || (entries.numbers("R").empty() && entries.numbers("T").empty()))
    return std::optional<StereoCalibration>();
  const auto left = EyeOf(FirstOf(entries, kMatrixNames), FirstOf(entries, kDistortionNames));
  if (!left.ok()) return left.status();
  const auto right = EyeOf(second, FirstOf(entries, kSecondDistortionNames));
  if (!right.ok()) return right.status();
  StereoCalibration pair{*left, *right, {}, {}, false};
  const std::vector<double> r = entries.numbers("R");
  const std::vector<double> t = entries.numbers("T");
  if (t.size() != 3 || (r.size() != 9 && r.size() != 3))
    return Invalid("a stereo calibration has R (3 x 3, or a rotation vector) and T (3 numbers); here they have " +
                   std::to_string(r.size()) + " and " + std::to_string(t.size()));
  for (const std::vector<double>& values : {r, t})
    for (const double value : values)
      if (!std::isfinite(value))
        return Invalid("R or T of the stereo calibration has an entry that is not a finite number");
  Eigen::Matrix3d turn;
  if (r.size() == 3)
    turn = RotationExp({r[0], r[1], r[2]}).toRotationMatrix();
  else
    turn << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
  constexpr double kRounding = 1e-3;
  if (!(turn * turn.transpose()).isIdentity(kRounding) || !(turn.determinant() > 0.0))
    return Invalid("R of the stereo calibration is not a rotation");
  Eigen::Vector3d translation(t[0], t[1], t[2]);
  if (translation.norm() < kShortestBaseline_mm) {
    translation *= 1e3;
    pair.was_in_meters = true;
  }
  pair.right_from_left = Rigid3(turn, translation);
  if (const auto size = Size(entries, {}); size.ok()) pair.image_size = *size;
  return std::optional<StereoCalibration>(pair);
}

Result<CameraFile> CameraFromOpenCv(const CalibrationEntries& entries, const CameraFileOptions& options) {
  const std::vector<double> k = FirstOf(entries, kMatrixNames);
  const std::vector<double> d = FirstOf(entries, kDistortionNames);
  for (const Status& status : {CheckCameraMatrix(k), CheckDistortion(d)})
    if (!status.ok()) return status;
  const auto lens = LensOf(entries);
  if (!lens.ok()) return lens.status();
  const auto size = Size(entries, options);
  if (!size.ok()) return size.status();
  if (*lens == Lens::kPerspective) return Perspective(k, d, *size);

  if (d.size() != 4 && !d.empty())
    return Invalid("a fisheye has 4 distortion coefficients (k1 k2 k3 k4), not " + std::to_string(d.size()));
  std::vector<double> params = {k[0], k[4], k[2], k[5]};
  params.insert(params.end(), d.begin(), d.end());
  params.resize(8, 0.0);
  auto camera = Camera::Create(CameraModelId::kOpenCvFisheye, size->width, size->height, params);
  if (!camera.ok()) return camera.status();
  return CameraFile{std::move(camera).value()};
}

}  // namespace pliant
