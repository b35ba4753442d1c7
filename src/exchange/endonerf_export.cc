// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The layout of EndoNeRF's data: LLFF's poses_bounds.npy, whose camera is a pinhole that looks out of the middle of
// the image, with images, depths and masks of that camera, which belong to the poses in the order of their names.

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "datasets/rectify.h"
#include "exchange/exports.h"
#include "exchange/neural_scene.h"
#include "exchange/run_images.h"
#include "io/npy.h"
#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/png_file.h"
#include "pliant/image/depth_lookup.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

constexpr const char* kPosesFile = "poses_bounds.npy";
constexpr const char* kCameraFile = "pinhole.yaml";
constexpr std::size_t kColumns =
    17;  // a 3 x 5 matrix, row by row: axes, center, (height, width, focal length); near, far
// The fewest steps that the typical depth has: rounding then moves it by 0.5 % or less. Not many more than EndoNeRF's
// own depths have, because some of its constants are steps.
constexpr double kStepsOfTypicalDepth = 100;
// Of a frame's depths, those that are its bounds.
constexpr double kNearShare = 0.03;
constexpr double kFarShare = 0.99;

// The camera of the exported images: of the same size and mean focal length, but without distortion, and with the
// principal point in the middle of the image, which is COLMAP's (width / 2, height / 2).
Result<Camera> CenteredPinhole(const Camera& camera) {
  colmap::Camera pinhole = colmap::FromPliant(camera, 1);
  pinhole.model_id = static_cast<int>(CameraModelId::kSimplePinhole);
  pinhole.params = {camera.MeanFocalLengthPx(), 0.5 * camera.width(), 0.5 * camera.height()};
  return colmap::ToPliant(pinhole);
}

// From the images of `raw` to those of `pinhole`, which has the same center and axes: depths stay what they are.
ImageWarp WarpBetween(const Camera& raw, const Camera& pinhole) {
  constexpr float kOutside = -2;
  // Coordinates that are whole numbers but for round-off become whole: then images that need no change have none.
  const auto rounded = [](double value) { return static_cast<float>(std::round(value * 1024.0) / 1024.0); };
  const cv::Size size(pinhole.width(), pinhole.height());
  ImageWarp warp{cv::Size(raw.width(), raw.height()), cv::Mat(size, CV_32FC1, cv::Scalar(kOutside)),
                 cv::Mat(size, CV_32FC1, cv::Scalar(kOutside))};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto pixel = raw.Project(*pinhole.Unproject(Eigen::Vector2d(x, y)));
      if (!pixel) continue;
      warp.x.at<float>(y, x) = rounded(pixel->x());
      warp.y.at<float>(y, x) = rounded(pixel->y());
    }
  }
  return warp;
}

// 255 where a pixel is not to be learned from: it shows nothing, is masked, or has no depth while others have one.
cv::Mat ToolMask(const RunImage& image, const cv::Mat& inside, Switch mask_unknown_depth) {
  cv::Mat use = inside.clone();
  if (!image.mask.empty()) use &= image.mask != 0;
  if (!image.depth.empty() && mask_unknown_depth == Switch::kOn) use &= image.depth > 0;
  return ~use;
}

RunImage Warped(const RunImage& image, const ImageWarp& warp) {
  RunImage result{warp.Apply(image.image), {}, {}};
  if (!image.mask.empty()) result.mask = warp.ApplyNearest(image.mask);
  if (!image.depth.empty()) result.depth = warp.ApplyNearest(image.depth);
  return result;
}

void AppendRow(const SourceFrame& frame, const Camera& camera, double unit, const std::vector<double>& depths,
               std::vector<double>* rows) {
  const Eigen::Matrix<double, 3, 4> pose = OpenGlWorldFromCam(frame.cam_from_world, unit);
  const Eigen::Vector3d size(camera.height(), camera.width(), camera.MeanFocalLengthPx());
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) rows->push_back(pose(r, c));
    rows->push_back(size[r]);
  }
  for (const double share : {kNearShare, kFarShare}) rows->push_back(Quantile(depths, share) / unit);
}

std::string NpyOf(const std::vector<double>& rows) {
  std::string data;
  for (const double value : rows) AppendDouble(&data, value);
  return NpyBytes("<f8", std::array{rows.size() / kColumns, std::size_t{kColumns}}, data);
}

// Writes the images of a source's frames, and collects the rows of the poses.
class EndoNerfWriter {
 public:
  EndoNerfWriter(const Camera& raw, const Camera& pinhole, double typical_depth, const ExportOptions& options,
                 const ExportFolder& folder)
      : pinhole_(pinhole),
        warp_(WarpBetween(raw, pinhole)),
        inside_(warp_.Inside()),
        typical_depth_(typical_depth),
        unit_(PowerOfTenUpTo(typical_depth / kStepsOfTypicalDepth)),
        mask_unknown_depth_(options.mask_unknown_depth),
        folder_(folder) {}

  Status Write(const SourceFrame& frame, const RunImage& raw, const std::vector<PointObservation>& observations) {
    const RunImage image = Warped(raw, warp_);
    std::vector<double> depths =
        image.depth.empty() ? DepthsOf(frame.cam_from_world, observations) : KnownDepths(image.depth);
    if (depths.empty()) depths = {typical_depth_};
    AppendRow(frame, pinhole_, unit_, depths, &rows_);
    Status status = WriteImage(native::kImageFolder, frame, image.image);
    if (status.ok()) status = WriteImage(native::kMaskFolder, frame, ToolMask(image, inside_, mask_unknown_depth_));
    if (!status.ok() || image.depth.empty()) return status;
    return WriteImage(native::kDepthFolder, frame, QuantizeDepth(image.depth, unit_));
  }

  // `of_map_unit`: what a map unit is.
  Status Finish(LengthUnit of_map_unit) const {
    if (Status status = WriteFileAtomically(folder_.Path(kPosesFile), NpyOf(rows_)); !status.ok()) return status;
    return WriteCameraFile(folder_.Path(kCameraFile), {.camera = pinhole_, .depth_scale = unit_}, of_map_unit);
  }

 private:
  Status WriteImage(const char* folder, const SourceFrame& frame, const cv::Mat& image) const {
    if (Status status = folder_.AddFolder(folder); !status.ok()) return status;
    return WritePng(folder_.Path(std::string(folder) + "/" + NumberOf(frame) + ".png"), image);
  }

  const Camera& pinhole_;
  ImageWarp warp_;
  cv::Mat inside_;
  double typical_depth_;
  double unit_;
  Switch mask_unknown_depth_;
  const ExportFolder& folder_;
  std::vector<double> rows_;
};

}  // namespace

Status ExportEndoNerf(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  Status status = CheckAbsent(
      folder.place, {kPosesFile, kCameraFile, native::kImageFolder, native::kDepthFolder, native::kMaskFolder});
  if (!status.ok()) return status;
  auto images = RunImages::Open(source);
  if (!images.ok()) return images.status();
  const auto depth = TypicalDepth(source);
  if (!depth.ok()) return depth.status();
  const auto pinhole = CenteredPinhole(source.camera);
  if (!pinhole.ok()) return pinhole.status();
  EndoNerfWriter writer(source.camera, *pinhole, *depth, options, folder);
  status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    const auto image = images->Read(frame);
    return image.ok() ? writer.Write(frame, *image, observations) : image.status();
  });
  if (!status.ok()) return status;
  return writer.Finish(IsMetric(source) ? LengthUnit::kMillimeters : LengthUnit::kMapUnits);
}

}  // namespace pliant
