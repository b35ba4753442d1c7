// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images and the calibration that belongs to them.
#include <cmath>
#include <string>
#include <utility>

#include "datasets/calibration_files.h"
#include "datasets/data_set.h"
#include "datasets/image_file.h"
#include "datasets/pair_streams.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Calibrations that no endoscope has, degrees of the horizontal field of view.
constexpr double kNarrowestFov_deg = 5;
constexpr double kWidestPerspectiveFov_deg = 160;
constexpr double kMaxFocalRatio = 1.3;  // of fx and fy

// Nothing where the file is of one camera.
Result<std::optional<StereoCalibration>> ReadPairCalibration(const fs::path& file) {
  if (file.extension() != ".ini") return ReadStereoCalibration(file.string());
  const auto calibration = ReadStereoIni(file);
  if (!calibration.ok()) return calibration.status();
  return std::optional(*calibration);
}

Result<fs::path> FindCalibration(const SequenceRequest& request) {
  if (!request.camera_path.empty()) return request.camera_path;
  std::error_code error;
  const fs::path beside =
      fs::is_directory(request.image_path, error) ? request.image_path : request.image_path.parent_path();
  fs::path file = beside / "camera.yaml";
  if (!fs::is_regular_file(file, error))
    return Status(ErrorCode::kNotFound,
                  "there is no calibration for " + request.image_path.string() + ": no file " + file.string() +
                      "; name a calibration file, make one with pliant calibrate, or say --camera unknown");
  return file;
}

Result<DataSet> WithAssumedCamera(const SequenceRequest& request, const fs::path& name,
                                  const std::optional<cv::Size>& size, std::unique_ptr<ImageStream> images) {
  if (!size)
    return Status(ErrorCode::kUnreadable, images->Title(0) + " does not tell its size; give a calibration file");
  const auto camera = MakeAssumedCamera(name.string(), size->width, size->height);
  if (!camera.ok()) return camera.status();
  DataSet data_set{.calibration = {*camera, name}, .images = std::move(images), .mask_path = request.mask_path};
  if (data_set.images->fps()) data_set.calibration.fps = *data_set.images->fps();
  data_set.warnings.push_back(std::string(kAssumedCameraWarning) + " (" + name.string() +
                              " degrees are assumed): if the assumed field of view is wrong, so are depths and motion");
  return data_set;
}

void WarnOfFocalLength(const SourceCalibration& calibration, std::vector<std::string>* warnings) {
  const Camera& camera = calibration.camera;
  const double fx = camera.HorizontalFocalLengthPx();
  const double fy = camera.Visit([](const auto& model) { return model.fy(); });
  const bool is_fisheye = camera.model_id() == CameraModelId::kOpenCvFisheye;
  const double half = 0.5 * camera.width() / fx;
  const double fov_deg = 2.0 * kDegPerRad * (is_fisheye ? half : std::atan(half));
  const std::string whose = "the calibration " + calibration.path.string() + " has ";
  if (fov_deg < kNarrowestFov_deg || (!is_fisheye && fov_deg > kWidestPerspectiveFov_deg))
    warnings->push_back(whose + "a focal length of " + FormatNumber("%.4g", fx) + " for images " +
                        std::to_string(camera.width()) + " px wide, a horizontal field of view of " +
                        FormatNumber("%.3g", fov_deg) +
                        " degrees: is its focal length in millimeters? it is wanted in pixels");
  if (fx > kMaxFocalRatio * fy || fy > kMaxFocalRatio * fx)
    warnings->push_back(whose + "focal lengths that differ by more than 30 %, fx = " + FormatNumber("%.4g", fx) +
                        " and fy = " + FormatNumber("%.4g", fy) +
                        ": are they in pixels of these images, and in the right order?");
}

Result<DataSet> WithItsCalibration(const SequenceRequest& request, std::unique_ptr<ImageStream> images,
                                   const std::optional<SourceCalibration>& published) {
  const Result<fs::path> path = FindCalibration(request);
  std::optional<SourceCalibration> ready = path.ok() ? std::nullopt : published;
  if (path.ok() && path->extension() == ".xml") {
    auto calibu = ReadCalibu(*path);
    if (!calibu.ok()) return calibu.status();
    ready = *std::move(calibu);
  }
  if (ready) {
    DataSet data_set{.calibration = *std::move(ready), .images = std::move(images), .mask_path = request.mask_path};
    if (data_set.images->fps()) data_set.calibration.fps = *data_set.images->fps();
    return data_set;
  }
  if (!path.ok()) return path.status();
  const std::optional<cv::Size> size = images->SizeAt(0);
  if (IsAssumedCamera(path->string())) return WithAssumedCamera(request, *path, size, std::move(images));
  const auto stereo = ReadPairCalibration(*path);
  if (!stereo.ok()) return stereo.status();
  if (stereo->has_value() && size) {
    const auto layout = LayoutOf(**stereo, *size);
    if (!layout.ok()) return Status(layout.status().code(), path->string() + ": " + layout.status().message());
    if (*layout != PairLayout::kApart) {
      auto pairs = RectifiedHalves(**stereo, *path, *layout, std::move(images));
      if (pairs.ok()) pairs->mask_path = request.mask_path;
      return pairs;
    }
    if (path->extension() == ".ini")
      return Status(ErrorCode::kMismatch, path->string() + " is of two cameras, but " + images->Title(0) +
                                              " holds no pair; give a calibration of this one");
  }
  CameraFileOptions options;
  if (size) options.image_size = ImageSize{size->width, size->height};
  const Result<CameraFile> file = ReadCameraFile(path->string(), options);
  if (!file.ok()) return file.status();
  SourceCalibration calibration{file->camera, *path};
  calibration.fps = file->fps;
  if (images->fps()) calibration.fps = *images->fps();
  calibration.depth_scale = file->depth_scale;
  calibration.baseline_mm = file->baseline_mm;
  calibration.unit_mm = file->unit_mm;
  calibration.photometric = file->photometric;
  return DataSet{.calibration = std::move(calibration), .images = std::move(images), .mask_path = request.mask_path};
}

}  // namespace

Result<DataSet> RectifiedPairs(const StereoCalibration& calibration, const fs::path& calibration_path, cv::Size image,
                               PairLayout layout, EyeStreams eyes) {
  const cv::Size eye = EyeSize(layout, image);
  if (calibration.image_size && eye != cv::Size(calibration.image_size->width, calibration.image_size->height))
    return Status(ErrorCode::kMismatch, "the calibration " + calibration_path.string() + " is for images of " +
                                            SizeText(calibration.image_size->width, calibration.image_size->height) +
                                            ", but those of one eye are " + SizeText(eye.width, eye.height) +
                                            "; give the calibration of these images");
  auto pair = RectifyPair(calibration, eye);
  if (!pair.ok()) return Status(pair.status().code(), calibration_path.string() + ": " + pair.status().message());
  DataSet data_set{.calibration = {pair->camera, calibration_path}, .images = nullptr};
  data_set.calibration.baseline_mm = pair->baseline_mm;
  if (calibration.was_in_meters)
    data_set.warnings.push_back("the calibration " + calibration_path.string() + " has no unit and cameras less than " +
                                FormatDouble(kShortestBaseline_mm) + " mm apart: it is read as meters, a baseline of " +
                                FormatDouble(std::round(1000.0 * pair->baseline_mm) / 1000.0) + " mm");
  if (eyes.left->fps()) data_set.calibration.fps = *eyes.left->fps();
  data_set.inside = pair->left.Inside();
  data_set.warp = pair->left;
  data_set.raw_from_given = Rigid3(Eigen::Matrix3d(pair->rectified_from_left.transpose()), Eigen::Vector3d::Zero());
  data_set.images = Warped(std::move(eyes.left), std::move(pair->left));
  data_set.right = Warped(std::move(eyes.right), std::move(pair->right));
  return data_set;
}

Result<DataSet> RectifiedHalves(const StereoCalibration& calibration, const fs::path& calibration_path,
                                PairLayout layout, std::unique_ptr<ImageStream> images) {
  const cv::Size image = images->SizeAt(0).value_or(cv::Size());
  return RectifiedPairs(calibration, calibration_path, image, layout, SplitEyes(std::move(images), layout, image));
}

Result<DataSet> Calibrated(const SequenceRequest& request, std::unique_ptr<ImageStream> images,
                           const std::optional<SourceCalibration>& published) {
  auto data_set = WithItsCalibration(request, std::move(images), published);
  if (data_set.ok()) WarnOfFocalLength(data_set->calibration, &data_set->warnings);
  return data_set;
}

}  // namespace pliant
