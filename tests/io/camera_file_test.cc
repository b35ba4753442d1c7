// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/camera_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "pliant/io/canonical_model.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<double> Params(const Camera& camera) { return {camera.params().begin(), camera.params().end()}; }

TEST(CameraFile, ComesBackAsItWasWritten) {
  const TestFolder folder;
  CameraFile file{
      Camera::Create("OPENCV", 640, 480, std::vector<double>{500.1, 499, 320, 1.0 / 3, -0.1, 0.01, 1e-5, 0}).value()};
  file.fps = 29.97;
  file.depth_scale = 0.1;
  file.baseline_mm = -4.14;
  ASSERT_TRUE(WriteCameraFile(folder.Path("camera.yaml"), file).ok());
  const auto read = ReadCameraFile(folder.Path("camera.yaml"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->camera.model_id(), CameraModelId::kOpenCv);
  EXPECT_EQ(Params(read->camera), Params(file.camera));
  EXPECT_EQ(read->fps, file.fps);
  EXPECT_EQ(read->depth_scale, file.depth_scale);
  EXPECT_EQ(read->baseline_mm, file.baseline_mm);
}

TEST(CameraFile, InMapUnitsNamesNoUnit) {
  const TestFolder folder;
  CameraFile file{Camera::Create("PINHOLE", 64, 48, std::vector<double>{50, 51, 32, 24}).value()};
  file.depth_scale = 0.003;
  ASSERT_TRUE(WriteCameraFile(folder.Path("mm.yaml"), file).ok());
  EXPECT_THAT(folder.Read("mm.yaml"), HasSubstr("depth_scale: 0.003  # mm per step\nunit: mm\n"));
  ASSERT_TRUE(WriteCameraFile(folder.Path("map.yaml"), file, LengthUnit::kMapUnits).ok());
  EXPECT_THAT(folder.Read("map.yaml"), HasSubstr("depth_scale: 0.003  # map units per step\n"));
  EXPECT_THAT(folder.Read("map.yaml"), Not(HasSubstr("mm")));
  const auto read = ReadCameraFile(folder.Path("map.yaml"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->depth_scale, file.depth_scale);
}

TEST(CameraFile, ThePhotometricCalibrationComesBackToo) {
  const TestFolder folder;
  CameraFile file{Camera::Create("PINHOLE", 64, 48, std::vector<double>{50, 51, 32, 24}).value()};
  file.photometric = {1.9, 2.5, 2.767302, {0.011092, 0, 0.999938}};
  ASSERT_TRUE(WriteCameraFile(folder.Path("camera.yaml"), file).ok());
  const auto read = ReadCameraFile(folder.Path("camera.yaml"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_TRUE(read->photometric.has_value());
  EXPECT_EQ(read->photometric->gamma, 1.9);
  EXPECT_EQ(read->photometric->vignetting, 2.5);
  EXPECT_EQ(read->photometric->light_spread, 2.767302);
  EXPECT_EQ(read->photometric->light_axis, file.photometric->light_axis);
}

TEST(CameraFile, LeavesOutWhatIsNotGiven) {
  const TestFolder folder;
  const auto read =
      ReadCameraFile(folder.Write("c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 51, 32, 24]\n"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_FALSE(read->fps || read->depth_scale || read->baseline_mm || read->photometric);
}

TEST(CameraFile, InMetersIsReadInMillimeters) {
  const TestFolder folder;
  const auto read = ReadCameraFile(
      folder.Write("c.yaml",
                   "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 51, 32, 24]\ndepth_scale: 0.0002\nbaseline: "
                   "0.11\nunit: m\n"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_DOUBLE_EQ(read->depth_scale.value(), 0.2);
  EXPECT_DOUBLE_EQ(read->baseline_mm.value(), 110);
  EXPECT_EQ(read->unit_mm, 1000);
}

struct BadFile {
  std::string label;
  std::string name;
  std::string text;
  std::string says;
};
void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.label; }
std::string BadName(const testing::TestParamInfo<BadFile>& bad) { return bad.param.label; }
class BadCameraFile : public testing::TestWithParam<BadFile> {};

TEST_P(BadCameraFile, IsRefusedInOneSentenceThatNamesIt) {
  const TestFolder folder;
  const auto read = ReadCameraFile(folder.Write(GetParam().name, GetParam().text));
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.status().message(), HasSubstr(GetParam().says));
  EXPECT_THAT(read.status().message(), HasSubstr(GetParam().name));
  EXPECT_THAT(read.status().message(), testing::Not(HasSubstr("\n")));
}

const std::string kMatrix =
    "%YAML:1.0\nimage_width: 640\nimage_height: 480\nK: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
    "   dt: d\n   data: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]\n";

INSTANTIATE_TEST_SUITE_P(
    Of, BadCameraFile,
    testing::Values(
        BadFile{"Empty", "c.yaml", " \n", "is empty"}, BadFile{"NoYaml", "c.yaml", "a: [1, 2\n", "not YAML"},
        BadFile{"Other", "c.yaml", "hello: 1\n", "holds no camera"},
        BadFile{"NoParams", "c.yaml", "model: PINHOLE\nwidth: 3\nheight: 4\n", "params is missing"},
        BadFile{"Count", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [1, 2, 3]\n", "takes 4 parameters"},
        BadFile{"NaN", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, .nan, 32, 24]\n", "not a finite"},
        BadFile{"Model", "c.yaml", "model: PINHOL\nwidth: 64\nheight: 48\nparams: [1, 2, 3, 4]\n",
                "did you mean 'PINHOLE'"},
        BadFile{"OpenCvSize", "c.yaml",
                "image_width: 640\nimage_height: 1e57\nM1: [500, 0, 320, 0, 500, 240, 0, 0, 1]\nD1: [0, 0, 0, 0]\n",
                "the image size is 640 x 1e+57"},
        BadFile{"Key", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [1, 2, 3, 4]\nbase: 3\n", ":5: "},
        BadFile{"Twice", "c.yaml", "model: PINHOLE\nwidth: 64\nwidth: 64\nheight: 48\nparams: [1, 2, 3, 4]\n", "twice"},
        BadFile{"Fps", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\nfps: 0\n", "fps"},
        BadFile{"HighFps", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\nfps: 3000000\n",
                "give frames a second, from 0.001 to 100000"},
        BadFile{"LowFps", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\nfps: 1e-300\n",
                "give frames a second, from 0.001 to 100000"},
        BadFile{"Unit", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\nunit: inch\n",
                ":5: unit must be mm or m"},
        BadFile{"Gamma", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\ngamma: 0\n",
                "gamma must be between"},
        BadFile{"NoGamma", "c.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\nvignetting: 2\n",
                "gamma is missing"},
        BadFile{"LightAxis", "c.yaml",
                "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [50, 50, 32, 24]\ngamma: 2\nlight_axis: [0, 1]\n",
                "light_axis must be a direction"},
        BadFile{"ColmapText", "cameras.txt", "# x\n1 PINHOLE 64 48 1 2 nan 4\n",
                "camera 1: the PINHOLE camera has a parameter that is not a finite number: number 3"},
        BadFile{"ColmapModel", "cameras.txt", "1 FOV 64 48 1 2 3 4 5\n", "camera model FOV is not one of Pliant's"},
        BadFile{"ColmapSeveral", "cameras.txt", "3 PINHOLE 64 48 50 50 32 24\n7 PINHOLE 64 48 50 50 32 24\n",
                "2 cameras (3, 7); leave the one of these images"},
        BadFile{"ColmapTruncated", "cameras.bin", std::string("\1\0\0\0\0\0\0\0\1\0\0\0", 12),
                "it says that there are 1 cameras, but has only 4"},
        BadFile{"OpenCvThin", "k.yaml", kMatrix + "D: [0.1, 0, 0, 0, 0, 0, 0, 0, 0.01, 0, 0, 0]\n",
                "coefficient s1 is 0.01"},
        BadFile{"OpenCvCount", "k.yaml", kMatrix + "D: [0.1, 0, 0]\n", "3 distortion coefficients"},
        BadFile{"OpenCvNan", "k.yaml", kMatrix + "D: [0.1, .nan, 0, 0]\n", "coefficient number 2"},
        BadFile{"OpenCvLargeK3", "k.yaml", kMatrix + "D: [0., 0., 0., 0., 2.]\n", "k3 = 2 are not part"},
        BadFile{"OpenCvModel", "k.yaml", kMatrix + "D: [0, 0, 0, 0]\ndistortion_model: equidistan\n",
                "did you mean 'equidistant'"},
        BadFile{"Xml", "k.xml", "<opencv_storage><K>", "not an OpenCV calibration"}),
    BadName);

TEST(CameraFile, ThatIsNotThereIsNotFound) {
  EXPECT_EQ(ReadCamera("/nowhere/camera.yaml").status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(ReadCamera(testing::TempDir()).status().code(), ErrorCode::kUnreadable);
}

TEST(ColmapCameras, AreHalfAPixelOffInTheirFiles) {
  const TestFolder folder;
  const std::string text =
      "# Camera list\n2 SIMPLE_RADIAL 640 480 500.25 320.5 240.5 -0.1\n1 PINHOLE 64 48 50 51 32 24\n";
  const auto two = ReadCameraFile(folder.Write("cameras.txt", text), {.camera_id = 2, .image_size = {}});
  ASSERT_TRUE(two.ok()) << two.status().message();
  EXPECT_EQ(Params(two->camera), (std::vector<double>{500.25, 320, 240, -0.1}));
  const auto one = ReadCameraFile(folder.Path("cameras.txt"), {.camera_id = 1, .image_size = {}});
  ASSERT_TRUE(one.ok());
  EXPECT_EQ(Params(one->camera), (std::vector<double>{50, 51, 31.5, 23.5}));
  EXPECT_FALSE(ReadCameraFile(folder.Path("cameras.txt"), {.camera_id = 5, .image_size = {}}).ok());
}

TEST(ColmapCameras, ComeBackAsTheyWereWrittenInBothFormats) {
  const TestFolder folder;
  const Camera camera =
      Camera::Create("OPENCV_FISHEYE", 800, 600, std::vector<double>{300.125, 301, 399.5, 299.25, 0.01, 0, 0, 1e-4})
          .value();
  folder.Write("observations.csv", "frame,point_id,u_px,v_px,x,y,z,ssim\n");
  ASSERT_TRUE(WriteCanonicalModel(folder.Path(""), colmap::Format::kBoth, camera, {}, {}, folder.Path("")).ok());
  for (const char* name : {"cameras.txt", "cameras.bin"}) {
    const auto read = ReadCamera(folder.Path(name));
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->model_id(), CameraModelId::kOpenCvFisheye);
    EXPECT_EQ(Params(*read), Params(camera));
    EXPECT_EQ(read->width(), 800);
  }
  EXPECT_THAT(folder.Read("cameras.txt"), HasSubstr("1 OPENCV_FISHEYE 800 600 300.125 301 400 299.75"));
}

class OpenCvCalibration : public testing::TestWithParam<std::tuple<const char*, const char*, const char*>> {};

TEST_P(OpenCvCalibration, IsReadAsOpenCvWroteIt) {
  const TestFolder folder;
  const auto [extension, matrix, distortion] = GetParam();
  const std::string path = folder.Path(std::string("calibration.") + extension);
  {
    cv::FileStorage storage(path, cv::FileStorage::WRITE);
    storage << matrix << cv::Mat(cv::Matx33d(510.5, 0, 320.25, 0, 505, 241, 0, 0, 1));
    storage << distortion << (cv::Mat_<double>(1, 5) << -0.2, 0.03, 1e-3, -2e-3, 0.0);
    storage << "image_width" << 640 << "image_height" << 480;
  }
  const auto read = ReadCameraFile(path);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->camera.model_name(), "OPENCV");
  EXPECT_EQ(Params(read->camera), (std::vector<double>{510.5, 505, 320.25, 241, -0.2, 0.03, 1e-3, -2e-3}));
  EXPECT_EQ(read->refit_residual_px, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Names, OpenCvCalibration,
                         testing::Combine(testing::Values("yaml", "xml"),
                                          testing::Values("M1", "K", "camera_matrix", "M"),
                                          testing::Values("D1", "D", "distCoeffs", "distortion_coefficients")));

TEST(OpenCvCalibrationFile, FitsASmallK3AndSaysHowWell) {
  const TestFolder folder;
  // The size is missing, as in stereoCalibrate's example files.
  const std::string path = folder.Write(
      "k.yml",
      "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: f\n"
      "   data: [ 1035., 0., 597., 0., 1035.,\n       520., 0., 0., 1. ]\nD1: !!opencv-matrix\n   rows: 1\n   cols: 5\n"
      "   dt: f\n   data: [ -5.95e-04, -5.47e-04, 0., 0., 1.83e-03 ]\n");
  EXPECT_THAT(ReadCameraFile(path).status().message(), HasSubstr("image size"));
  const auto read = ReadCameraFile(path, {.camera_id = {}, .image_size = ImageSize{1280, 1024}});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_GT(read->refit_residual_px, 0.0);
  EXPECT_LT(read->refit_residual_px, kLargestRefitPx);
  // The residual is honest: OpenCV's own projection differs by no more, over the image.
  constexpr double kMaxRatioAtOtherPixels = 1.2;  // a largest value, sampled more finely
  constexpr double kMinRatioAtOtherPixels = 0.5;
  double largest = 0;
  for (double u = 0; u < 1280; u += 31)
    for (double v = 0; v < 1024; v += 31) {
      const Eigen::Vector3d ray = *read->camera.Unproject({u, v});
      const std::vector<cv::Point3d> point = {{ray.x() / ray.z(), ray.y() / ray.z(), 1}};
      std::vector<cv::Point2d> pixel;
      cv::projectPoints(point, cv::Vec3d(), cv::Vec3d(), cv::Matx33d(1035, 0, 597, 0, 1035, 520, 0, 0, 1),
                        std::vector<double>{-5.95e-04, -5.47e-04, 0, 0, 1.83e-03}, pixel);
      largest = std::max(largest, std::hypot(pixel[0].x - u, pixel[0].y - v));
    }
  EXPECT_LT(largest, kMaxRatioAtOtherPixels * read->refit_residual_px);
  EXPECT_GT(largest, kMinRatioAtOtherPixels * read->refit_residual_px);
}

TEST(OpenCvCalibrationFile, IsAPinholeWithoutDistortionAndAFisheyeWhereItSaysSo) {
  const TestFolder folder;
  const auto pinhole = ReadCamera(folder.Write("a.yaml", kMatrix + "D: [0., 0., 0., 0., 0.]\n"));
  ASSERT_TRUE(pinhole.ok()) << pinhole.status().message();
  EXPECT_EQ(pinhole->model_id(), CameraModelId::kPinhole);
  for (const char* model : {"fisheye", "equidistant", "Kannala_Brandt"}) {
    const auto fisheye =
        ReadCamera(folder.Write("b.yaml", kMatrix + "D: [0.1, 0.01, 0., 0.]\ndistortion_model: " + model + "\n"));
    ASSERT_TRUE(fisheye.ok()) << fisheye.status().message();
    EXPECT_EQ(fisheye->model_id(), CameraModelId::kOpenCvFisheye);
    EXPECT_EQ(Params(*fisheye), (std::vector<double>{500, 500, 320, 240, 0.1, 0.01, 0, 0}));
  }
}

}  // namespace
}  // namespace pliant
