// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// STIR (Schmidt et al., arXiv 2309.16782), a sequence DIR/left/seqNN: frames/*.mp4, with the right eye's beside it in
// DIR/right/seqNN, and DIR/calib.json, as its loader reads them (github.com/athaddius/STIRLoader): leftcameramat,
// rightcameramat, leftdistortioncoeffs, rightdistortioncoeffs, rotation and translation (meters) of OpenCV. Its pairs
// are rectified, but for the column of the axis. Labels are of the left images as they are, so these stay as they are.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/json_numbers.h"
#include "datasets/pair_streams.h"
#include "datasets/rectify.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStirCalibration = "calib.json";
constexpr double kSameCamera_px = 0.05;  // of rectified pairs: focal lengths and the axis' row
constexpr double kSameTurn_rad = 5e-5;   // at a focal length of 1000 px as much

// ".../left/seq00" without a separator at its end.
fs::path SequenceAt(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

fs::path CalibrationOf(const fs::path& path) { return SequenceAt(path).parent_path().parent_path() / kStirCalibration; }

bool IsLeft(const fs::path& path) { return SequenceAt(path).parent_path().filename().string().starts_with("left"); }

// DIR/left/seq00 -> DIR/right/seq00; "left2" -> "right2".
fs::path RightOf(const fs::path& path) {
  const fs::path left = SequenceAt(path);
  const std::string side = left.parent_path().filename().string();
  return left.parent_path().parent_path() / ("right" + side.substr(std::string("left").size())) / left.filename();
}

class StirCalibration {
 public:
  StirCalibration(fs::path file, nlohmann::json json) : file_(std::move(file)), json_(std::move(json)) {}

  // `count` numbers; any number of them where it is 0.
  std::vector<double> Numbers(const char* key, std::size_t count) {
    std::vector<double> numbers = NumbersAt(json_, key);
    if (count > 0 && numbers.size() != count) {
      if (missing_.empty()) missing_ = std::to_string(count) + " numbers of " + key;
      numbers.assign(count, 0.0);
    }
    return numbers;
  }
  StereoCalibration::Eye EyeOf(const std::string& side) {
    const auto k = Numbers((side + "cameramat").c_str(), 9);
    StereoCalibration::Eye eye{k[0], k[4], k[2], k[5], Numbers((side + "distortioncoeffs").c_str(), 0)};
    if (std::ranges::all_of(eye.distortion, [](double value) { return value == 0.0; })) eye.distortion.assign(4, 0.0);
    constexpr std::array<std::size_t, 5> kOpenCvCounts = {4, 5, 8, 12, 14};
    if (std::ranges::find(kOpenCvCounts, eye.distortion.size()) == kOpenCvCounts.end() && missing_.empty())
      missing_ = "4, 5, 8, 12 or 14 numbers of " + side + "distortioncoeffs";
    return eye;
  }
  Status Complete() const {
    if (missing_.empty()) return Status::Ok();
    return {ErrorCode::kUnreadable, file_.string() + " lacks the " + missing_ + "; copy it again"};
  }

 private:
  fs::path file_;
  nlohmann::json json_;
  std::string missing_;
};

Result<StereoCalibration> ReadStirCalibration(const fs::path& file) {
  const auto text = ReadFile(file.string());
  if (!text.ok()) return text.status();
  StirCalibration given(file, nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false));
  StereoCalibration calibration{given.EyeOf("left"), given.EyeOf("right"), {}, {}, false};
  const auto translation = given.Numbers("translation", 3);
  const auto turn = given.Numbers("rotation", 0);  // a matrix, or OpenCV's vector
  if (Status status = given.Complete(); !status.ok()) return status;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (turn.size() == 9) {
    rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn.data());
  } else if (turn.size() == 3) {
    const Eigen::Vector3d axis(turn[0], turn[1], turn[2]);
    if (axis.norm() > 0) rotation = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
  } else {
    return Status(ErrorCode::kUnreadable, file.string() + " lacks the 9 numbers of rotation; copy it again");
  }
  if (!(rotation * rotation.transpose()).isIdentity(1e-3) || !(rotation.determinant() > 0))
    return Status(ErrorCode::kUnreadable, file.string() + ": rotation is not a rotation");
  calibration.right_from_left =
      Rigid3(rotation, kMeter_mm * Eigen::Vector3d(translation[0], translation[1], translation[2]));
  return calibration;
}

bool IsRectified(const StereoCalibration& calibration) {
  const StereoCalibration::Eye& left = calibration.left;
  const StereoCalibration::Eye& right = calibration.right;
  const auto same = [](double a, double b) { return std::abs(a - b) <= kSameCamera_px; };
  const auto plain = [](const StereoCalibration::Eye& eye) {
    return std::all_of(eye.distortion.begin(), eye.distortion.end(), [](double k) { return k == 0.0; });
  };
  const Eigen::AngleAxisd turn(calibration.right_from_left.RotationMatrix());
  const Eigen::Vector3d& t = calibration.right_from_left.translation;
  return plain(left) && plain(right) && same(left.fx, right.fx) && same(left.fy, right.fy) && same(left.cy, right.cy) &&
         std::abs(turn.angle()) <= kSameTurn_rad && t.x() < 0 && std::hypot(t.y(), t.z()) <= 0.01 * -t.x();
}

// The right eye as the left one's camera would see it from there.
ImageWarp Shifted(cv::Size size, double columns) {
  ImageWarp warp{size, cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1)};
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) {
      warp.x.at<float>(v, u) = static_cast<float>(u + columns);
      warp.y.at<float>(v, u) = static_cast<float>(v);
    }
  return warp;
}

Result<DataSet> OpenRectified(const StereoCalibration& calibration, const fs::path& file, cv::Size size,
                              EyeStreams eyes) {
  auto camera = Camera::Create(
      CameraModelId::kPinhole, size.width, size.height,
      std::vector<double>{calibration.left.fx, calibration.left.fy, calibration.left.cx, calibration.left.cy});
  if (!camera.ok()) return Status(camera.status().code(), file.string() + ": " + camera.status().message());
  DataSet data_set{.calibration = {.camera = *std::move(camera), .path = file}, .images = std::move(eyes.left)};
  if (data_set.images->fps()) data_set.calibration.fps = *data_set.images->fps();
  data_set.calibration.baseline_mm = -calibration.right_from_left.translation.x();
  const double columns = calibration.right.cx - calibration.left.cx;
  data_set.right = columns == 0 ? std::move(eyes.right) : Warped(std::move(eyes.right), Shifted(size, columns));
  return data_set;
}

}  // namespace

bool IsStir(const fs::path& path) {
  return !OnlyFile(path / "frames", ".mp4").empty() && IsLeft(path) && IsFile(CalibrationOf(path));
}

std::string StirLacks(const fs::path& path) {
  if (!IsFolder(path / "frames") || !IsFile(CalibrationOf(path))) return "";
  return IsLeft(path) ? "one .mp4 in frames/, and no other" : "the left camera's images, which are in left/";
}

Result<DataSet> OpenStir(const SequenceRequest& request) {
  const fs::path left_file = OnlyFile(request.image_path / "frames", ".mp4");
  if (!request.camera_path.empty()) {
    auto left = StreamVideo(left_file, request.video_index);
    return left.ok() ? Calibrated(request, *std::move(left)) : Result<DataSet>(left.status());
  }
  const fs::path right_folder = RightOf(request.image_path) / "frames";
  const fs::path right_file = OnlyFile(right_folder, ".mp4");
  if (right_file.empty())
    return Status(ErrorCode::kNotFound,
                  "there is not one .mp4 in " + right_folder.string() + ", the right camera's; copy it again");
  const fs::path file = CalibrationOf(request.image_path);
  const auto calibration = ReadStirCalibration(file);
  if (!calibration.ok()) return calibration.status();
  auto left = StreamVideo(left_file, request.video_index);
  if (!left.ok()) return left.status();
  auto right = StreamVideo(right_file);
  if (!right.ok()) return right.status();
  const auto size = (*left)->SizeAt(0);
  if (!size) return Status(ErrorCode::kUnreadable, "the size of " + left_file.string() + " is not known");
  const auto layout = LayoutOf(*calibration, *size);
  if (!layout.ok() || *layout != PairLayout::kApart)
    return Status(ErrorCode::kMismatch, file.string() + " is not the calibration of " + left_file.string() +
                                            ", whose images are " + SizeText(size->width, size->height) +
                                            ": they have been resized, or hold pairs; give the original video");
  EyeStreams eyes{*std::move(left), *std::move(right)};
  const bool is_rectified = IsRectified(*calibration);
  auto data_set = is_rectified ? OpenRectified(*calibration, file, *size, std::move(eyes))
                               : RectifiedPairs(*calibration, file, *size, PairLayout::kApart, std::move(eyes));
  if (!data_set.ok()) return data_set.status();
  if (!is_rectified)
    data_set->warnings.push_back("the pairs of " + request.image_path.string() +
                                 " are rectified: pixels are not those of the labels");
  data_set->mask_path = request.mask_path;
  return data_set;
}

}  // namespace pliant
