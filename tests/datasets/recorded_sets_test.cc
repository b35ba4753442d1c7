// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Data sets that were recorded.
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/data_set_files.h"

namespace pliant {
namespace {

using namespace data_set_files;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kSameImage = 1.0;  // gray levels in the mean; another frame differs by many

TEST_F(DataSets, ReadsRectifiedHamlyn) {
  for (int k = 0; k < Frames(); ++k) {
    Write("rectified20/image01/" + Numbered("%010d.png", k), Frame(k).image);
    Write("rectified20/image02/" + Numbered("%010d.png", k), Frame(k).right);
    Write("rectified20/depth01/" + Numbered("%010d.png", k), Steps(Frame(k).depth, 1.0));
  }
  const auto& p = Rendered().camera.params();
  Text("rectified20/intrinsics.txt", Line(" ", p[0], 0, p[2], 0) + Line(" ", 0, p[1], p[3], 0) + Line(" ", 0, 0, 1, 0));
  Text("rectified20/extrinsics.txt", "1 0 0 -4.8\n0 1 0 0\n0 0 1 1.4\n");  // 5 mm long
  ExpectTheScene(Path("rectified20"), {.kind = "hamlyn_rectified", .poses = false, .pairs = true, .depth_mm = 0.51});
}

TEST_F(DataSets, ReadsTumRgbd) {
  std::string images = "# color images\n# timestamp filename\n";
  std::string depths = "# depth maps\n";
  std::string poses = "# ground truth trajectory\n";
  for (int k = 0; k < Frames(); ++k) {
    const double time_s = 1305031102.175304 + k / 30.0;
    const std::string image = "rgb/" + Numbered("%06d.png", k);
    const std::string depth = "depth/" + Numbered("%06d.png", k);
    Write("fr1/" + image, Frame(k).image);
    Write("fr1/" + depth, Steps(Frame(k).depth, 0.2));
    std::ostringstream a, b, c;
    a.precision(16);
    b.precision(16);
    c.precision(16);
    a << time_s << " " << image << "\n";
    b << time_s + 0.004 << " " << depth << "\n";
    const Eigen::Vector3d t = Pose(k).translation / 1000.0;
    const auto& q = Pose(k).rotation;
    c << time_s + 0.002 << " " << t.x() << " " << t.y() << " " << t.z() << " " << q.x() << " " << q.y() << " " << q.z()
      << " " << q.w() << "\n";
    images += a.str();
    depths += b.str();
    poses += c.str();
  }
  Text("fr1/rgb.txt", images);
  Text("fr1/depth.txt", depths);
  Text("fr1/groundtruth.txt", poses);
  SceneCamera("fr1/camera.yaml");
  ExpectTheScene(Path("fr1"), {.kind = "tum_rgbd", .depth_mm = 0.11});
}

TEST_F(DataSets, ReadsEuRoCAndLeavesOutImagesWithoutAPair) {
  std::string list = "#timestamp [ns],filename\n";
  std::string poses = "#timestamp, p_RS_R_x [m], ...\n";
  const Rigid3 body_from_cam(RotationExp({0.3, -1.2, 0.4}), Eigen::Vector3d(40, -20, 10));
  for (int k = 0; k < Frames(); ++k) {
    const auto time_ns = std::to_string(1403636579763555584LL + static_cast<long long>(std::llround(k / 30.0 * 1e9)));
    list += time_ns + "," + time_ns + ".png\n";
    Write("mav/mav0/cam0/data/" + time_ns + ".png", Frame(k).image);
    Write("mav/mav0/cam1/data/" + time_ns + ".png", Frame(k).right);
    const Rigid3 pose = Pose(k) * body_from_cam.Inverse();
    const Eigen::Vector3d t = pose.translation / 1000.0;
    const auto& q = pose.rotation;
    poses += time_ns + "," + Line(",", t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z(), 0, 0, 0);
  }
  const Camera& camera = Rendered().camera;
  for (int eye = 0; eye < 2; ++eye) {
    const std::string folder = "mav/mav0/cam" + std::to_string(eye);
    Text(folder + "/data.csv", list);
    const Rigid3 pose =
        body_from_cam * Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(eye * Rendered().baseline_mm, 0, 0));
    const Eigen::Matrix3d r = pose.RotationMatrix();
    const Eigen::Vector3d t = pose.translation / 1000.0;
    const auto& p = camera.params();
    Text(folder + "/sensor.yaml", "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [" +
                                      Line(", ", r(0, 0), r(0, 1), r(0, 2), t.x(), r(1, 0), r(1, 1), r(1, 2), t.y(),
                                           r(2, 0), r(2, 1), r(2, 2), t.z(), 0, 0, 0, 1) +
                                      "  ]\nrate_hz: 30\nresolution: [" + std::to_string(camera.width()) + ", " +
                                      std::to_string(camera.height()) + "]\ncamera_model: pinhole\nintrinsics: [" +
                                      Line(", ", p[0], p[1], p[2], p[3]) + "]\ndistortion_model: radial-tangential\n" +
                                      "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n");
  }
  Text("mav/mav0/state_groundtruth_estimate0/data.csv", poses);
  ExpectTheScene(Path("mav"), {.kind = "euroc", .pairs = true});

  // An image that one of the cameras dropped has no pair; the others keep theirs.
  const std::string first_ns = list.substr(list.find('\n') + 1, 19);
  std::string without_first = list;
  without_first.erase(list.find('\n') + 1, list.find('\n', list.find('\n') + 1) - list.find('\n'));
  Text("mav/mav0/cam1/data.csv", without_first);
  const auto sequence = OpenSequence({.image_path = Path("mav")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_THAT((*sequence)->Warnings(), ElementsAre(HasSubstr("1 images of cam0 or cam1")));
  EXPECT_EQ((*sequence)->size(), Frames() - 1);
  ASSERT_TRUE((*sequence)->Next().ok());
  EXPECT_NE((*sequence)->Name(0), first_ns + ".png");
  const auto right = (*sequence)->Right();
  ASSERT_TRUE(right.ok() && right->has_value());
  EXPECT_LT(cv::norm(**right, Frame(1).right, cv::NORM_L1) / static_cast<double>(right->value().total()) / 3,
            kSameImage);
}

TEST_F(DataSets, ReadsStereoMisWithItsMasks) {
  WriteStackedVideo("P1/IFBS_ENDOSCOPE.mp4");
  const auto& p = Rendered().camera.params();
  std::string calibration;
  for (const char* side : {"StereoLeft", "StereoRight"}) {
    calibration += "[" + std::string(side) + "]\nres_x = 320\nres_y = 240\nfc_x = " + std::to_string(p[0]) +
                   "\nfc_y = " + std::to_string(p[1]) + "\ncc_x = " + std::to_string(p[2]) +
                   "\ncc_y = " + std::to_string(p[3]) + "\n";
    for (int k = 0; k < 8; ++k) calibration += "kc_" + std::to_string(k) + " = 0\n";
    for (int k = 0; k < 9; ++k)
      calibration += "R_" + std::to_string(k) + " = " + std::to_string(k % 4 == 0 ? 1 : 0) + "\n";
    calibration += "T_0 = " + std::string(side == std::string("StereoRight") ? "-5" : "0") + "\nT_1 = 0\nT_2 = 0\n";
  }
  Text("P1/StereoCalibration.ini", calibration);
  std::string poses;
  for (int k = 0; k < Frames(); ++k) {
    const Eigen::Vector3d t = Pose(k).translation / 1000.0;
    const auto& q = Pose(k).rotation;
    poses += std::to_string(k) + " " + Line(" ", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  Text("P1/groundtruth.txt", poses);
  ExpectTheScene(Path("P1"), {.kind = "stereomis", .pairs = true, .gray_levels = 4.0});

  cv::Mat mask(120, 160, CV_8U, cv::Scalar(255));  // of half the size
  mask(cv::Rect(40, 30, 40, 30)) = 0;
  Write("P1/masks/000001l.png", mask);
  const auto sequence = OpenSequence({.image_path = Path("P1")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  for (int k = 0; k < 2; ++k) {
    const auto frame = (*sequence)->Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_EQ((*frame)->mask.at<unsigned char>(90, 120), k == 1 ? 0 : 255);
    EXPECT_EQ((*frame)->mask.at<unsigned char>(90, 220), 255);
  }
}

TEST_F(DataSets, ReadsStirWithTheImagesThatItsLabelsAreOf) {
  constexpr int kShift = 3;  // columns, of the right camera's axis
  const auto write = [&](const std::string& side, double fps, const auto& image_of) {
    const std::filesystem::path folder = Path("0/" + side + "/seq00/frames");
    std::filesystem::create_directories(folder);
    cv::VideoWriter writer((folder / "00000ms-00200ms-visible.mp4").string(), cv::CAP_FFMPEG,
                           cv::VideoWriter::fourcc('m', 'p', '4', 'v'), fps, {320, 240});
    ASSERT_TRUE(writer.isOpened());
    for (int k = 0; k < Frames(); ++k) writer.write(image_of(k));
  };
  write("left", 30, [](int k) { return Frame(k).image; });
  write("right", 30, [](int k) {
    cv::Mat shifted = cv::Mat::zeros(Frame(k).right.size(), CV_8UC3);
    Frame(k).right.colRange(0, 320 - kShift).copyTo(shifted.colRange(kShift, 320));
    return shifted;
  });
  const auto& p = Rendered().camera.params();
  const auto matrix = [&](double shift) {
    return "[[" + Line(", ", p[0], 0, p[2] + shift) + "], [" + Line(", ", 0, p[1], p[3]) + "], [0, 0, 1]]";
  };
  const auto calibration = [&](const std::string& turn) {
    Text("0/calib.json",
         "{\"leftcameramat\": " + matrix(0) + ", \"rightcameramat\": " + matrix(kShift) +
             ", \"leftdistortioncoeffs\": [[0, 0, 0, 0, 0]], \"rightdistortioncoeffs\": [0, 0, 0, 0, 0], "
             "\"rotation\": " +
             turn + ", \"translation\": [-0.005, 0, 0]}");
  };
  calibration("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]");
  const std::filesystem::path left = Path("0/left/seq00");
  ExpectTheScene(left, {.kind = "stir", .poses = false, .pairs = true, .gray_levels = 4.0});
  ExpectTheScene(left / "", {.kind = "stir", .poses = false, .pairs = true, .gray_levels = 4.0});
  const auto right_of = [](const Result<std::unique_ptr<Sequence>>& sequence) {
    EXPECT_TRUE(sequence.ok() && (*sequence)->Next().ok());
    const auto right = (*sequence)->Right();
    EXPECT_TRUE(right.ok() && right->has_value());
    return **right;
  };
  const auto sequence = OpenSequence({.image_path = left});
  const cv::Rect inside(4, 4, 320 - 8 - kShift, 240 - 8);
  EXPECT_LT(cv::norm(right_of(sequence)(inside), Frame(0).right(inside), cv::NORM_L1) / inside.area() / 3, 4.0);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR((*sequence)->camera().params()[k], p[k], kTextNumber);

  write("left", 25, [](int k) { return Frame(k).image; });
  const auto slower = OpenSequence({.image_path = left});
  ASSERT_TRUE(slower.ok());
  EXPECT_NEAR(*(*slower)->TimestampS(2), 2 / 25.0, kTimestamp_s);

  // Pairs that are turned towards each other are rectified, which labels do not know.
  calibration("[0, 0.02, 0]");
  const auto turned = OpenSequence({.image_path = left});
  ASSERT_TRUE(turned.ok()) << turned.status().message();
  EXPECT_THAT((*turned)->Warnings(), ElementsAre(HasSubstr("not those of the labels")));
  EXPECT_NEAR(*(*turned)->BaselineMm(), 5.0, kTextNumber);
}

TEST_F(DataSets, SaysWhatStirLacks) {
  Text("0/left/seq00/frames/00000ms-00200ms-visible.mp4", "");
  Text("0/calib.json", "{}");
  const auto why_not = [&](const std::string& path) {
    return OpenSequence({.image_path = Path(path)}).status().message();
  };
  EXPECT_THAT(why_not("0/left/seq00"), HasSubstr("the right camera's"));
  Text("0/right/seq00/frames/00000ms-00200ms-visible.mp4", "");
  EXPECT_THAT(why_not("0/left/seq00"), HasSubstr("lacks the 9 numbers of leftcameramat"));
  const std::string k = "[[300, 0, 160], [0, 300, 120], [0, 0, 1]]";
  Text("0/calib.json", "{\"leftcameramat\": " + k + ", \"rightcameramat\": " + k +
                           ", \"rightdistortioncoeffs\": [0.1, 0, 0], \"translation\": [-0.005, 0, 0]}");
  EXPECT_THAT(why_not("0/left/seq00"), HasSubstr("14 numbers of rightdistortioncoeffs"));
  EXPECT_THAT(why_not("0/right/seq00"), HasSubstr("which are in left/"));
}

TEST_F(DataSets, ReadsScared) {
  WriteStackedVideo("keyframe_1/data/rgb.mp4");
  Stereo("keyframe_1/endoscope_calibration.yaml", 5);
  for (int k = 0; k < Frames(); ++k) {
    const Rigid3 cam_from_world = Pose(k).Inverse();
    const Eigen::Matrix3d r = cam_from_world.RotationMatrix();
    const Eigen::Vector3d& t = cam_from_world.translation;
    const auto row = [&](int i) {
      std::string text = Line(", ", r(i, 0), r(i, 1), r(i, 2), t[i]);
      text.pop_back();
      return "[" + text + "]";
    };
    Text("keyframe_1/data/frame_data/" + Numbered("frame_data%06d.json", k),
         "{\"camera-pose\": [" + row(0) + ", " + row(1) + ", " + row(2) + ", [0, 0, 0, 1]]}");
    cv::Mat points(2 * 240, 320, CV_32FC3, cv::Scalar::all(std::nan("")));
    for (int v = 0; v < 240; ++v)
      for (int u = 0; u < 320; ++u) {
        const auto ray = Rendered().camera.Unproject(Eigen::Vector2d(u, v));
        const double z = Frame(k).depth.at<float>(v, u);
        if (!ray || !(z > 0)) continue;
        const Eigen::Vector3f x = (z / ray->z() * *ray).cast<float>();
        points.at<cv::Vec3f>(v, u) = {x.z(), x.y(), x.x()};  // stored as RGB
      }
    std::filesystem::create_directories(Path("keyframe_1/data/scene_points"));
    constexpr int kUncompressed = 1;  // else OpenCV writes colors for the eye
    ASSERT_TRUE(cv::imwrite(Path("keyframe_1/data/scene_points/" + Numbered("scene_points%06d.tiff", k)).string(),
                            points, {cv::IMWRITE_TIFF_COMPRESSION, kUncompressed}));
  }
  ExpectTheScene(Path("keyframe_1"), {.kind = "scared", .pairs = true, .depth_mm = 0.01, .gray_levels = 4.0});
}

TEST_F(DataSets, ReadsRecordedEndomapperWithItsLight) {
  const std::string folder = "Sequences/Seq_003";
  std::filesystem::create_directories(Path(folder));
  cv::VideoWriter writer(Path(folder + "/Seq_003.mov").string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30, {320, 240});
  ASSERT_TRUE(writer.isOpened());
  for (int k = 0; k < Frames(); ++k) writer.write(Frame(k).image);
  writer.release();
  Text(folder + "/Seq_003_info.json", "{\"endoscope_number\": \"3\", \"type\": \"colonoscopy\"}");
  Text("Calibrations/Endoscope_03/Endoscope_03_geometrical.xml",
       "<rig>\n  <camera>\n    <camera_model name=\"\" index=\"0\" serialno=\"0\" type=\"calibu_fu_fv_u0_v0_kb4\" "
       "version=\"8\">\n      <width> 320 </width>\n      <height> 240 </height>\n      <right> [ 1; 0; 0 ] </right>\n"
       "      <params> [  230;  230;  159.5;  119.5;  -0.1289632;  -0.006051189;  0.001660961;  -7.847858e-05 ] "
       "</params>\n    </camera_model>\n  </camera>\n</rig>\n");
  ExpectTheScene(Path(folder), {.kind = "endomapper", .poses = false, .gray_levels = 4.0});
  Text("Calibrations/Endoscope_03/Endoscope_03_photometrical.xml",
       "<?xml version=\"1.0\"?>\n<rig>\n <camera>\n  <camera_model index=\"0\" type=\"gamma\">\n   <!-- <gamma> [ 9 ] "
       "</gamma> -->\n   <gamma> [ 2.2 ] </gamma>\n   <vignetting> [ 1.500000 ] </vignetting>\n  </camera_model>\n "
       "</camera>\n <light>\n  <light_model type=\"sls\">\n   <sigma> 1.0 </sigma>\n   <mu> 2.767302 </mu>\n   <P> [ "
       "-6.1e-05; -0.001135; -0.003612 ] </P>\n   <D> [ 0.011092; 0.0; 0.999938 ] </D>\n  </light_model>\n "
       "</light>\n</rig>\n");
  const auto sequence = OpenSequence({.image_path = Path(folder)});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ASSERT_TRUE((*sequence)->Photometric().has_value());
  EXPECT_EQ((*sequence)->Photometric()->gamma, 2.2);
  EXPECT_EQ((*sequence)->Photometric()->vignetting, 1.5);
  EXPECT_EQ((*sequence)->Photometric()->light_spread, 2.767302);
  EXPECT_EQ((*sequence)->Photometric()->light_axis, Eigen::Vector3d(0.011092, 0, 0.999938));
  EXPECT_EQ((*sequence)->camera().model_name(), "OPENCV_FISHEYE");
  EXPECT_THAT((*sequence)->camera().params(),
              ElementsAre(230, 230, 159.5, 119.5, -0.1289632, -0.006051189, 0.001660961, -7.847858e-05));
}

TEST_F(DataSets, ReadsAColmapModelWithItsImages) {
  std::string images = "# images\n";
  for (int k = 0; k < Frames(); ++k) {
    Write("room/images/" + Name(k), Frame(k).image);
    const Rigid3 cam_from_world = Pose(k).Inverse();
    const auto& q = cam_from_world.rotation;
    const auto& t = cam_from_world.translation;
    images += Line(" ", k + 1, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), 1, Name(k)) + "\n";
  }
  const auto& p = Rendered().camera.params();
  Text("room/sparse/0/cameras.txt", Line(" ", 1, "PINHOLE", 320, 240, p[0], p[1], p[2] + 0.5, p[3] + 0.5));
  Text("room/sparse/0/images.txt", images);
  Text("room/sparse/0/points3D.txt", "");
  ExpectTheScene(Path("room"), {.kind = "colmap"});
}

TEST_F(DataSets, ImagesBesideAModelAreNativeWhenTheyHaveTheirOwnCalibration) {
  WriteImages(3, "room/images");
  for (int k = 0; k < 3; ++k)
    Write("room/masks/" + Name(k), cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(k == 1 ? 0 : 255)));
  Text("room/sparse/0/cameras.txt", "1 PINHOLE 64 48 60 60 32 24\n2 PINHOLE 64 48 60 60 32 24\n");
  Text("room/sparse/0/images.txt", "");
  Text("room/sparse/0/points3D.txt", "");
  WriteCamera("camera.yaml");
  const auto sequence = OpenSequence({.image_path = Path("room"), .camera_path = Path("camera.yaml")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ASSERT_TRUE((*sequence)->Next().ok());
  const auto second = (*sequence)->Next();
  ASSERT_TRUE(second.ok() && second->has_value());
  EXPECT_EQ(cv::countNonZero((*second)->mask), 0);
  const auto without = OpenSequence({.image_path = Path("room")});
  ASSERT_FALSE(without.ok());
  EXPECT_THAT(without.status().message(), HasSubstr("has 2 cameras"));
}

}  // namespace
}  // namespace pliant
