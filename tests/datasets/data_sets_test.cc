// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Miniatures of other people's data sets, written from a rendered scene in their exact layout, units and handedness,
// and read back.
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "datasets/sequence_files.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "support/rendered_sequence.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kTextNumber = 1e-6;    // calibrations are written with six decimals
constexpr double kTimestamp_s = 1e-4;   // data sets name times with four decimals and more
constexpr double kPose_mm = 1e-3;       // meters with six digits, in the coarsest of the sets
constexpr double kPose_rad = 1e-5;      // matrices and quaternions of the same
constexpr double kSameImage = 1.0;      // gray levels in the mean; another frame differs by many
constexpr double kPublished_px = 1e-3;  // focal lengths as they are published
constexpr double kAtEdges = 0.02;       // of the pixels lie on edges of depth, where a resampled image differs

const SimulatedFrame& Frame(int k) { return Rendered().frames[static_cast<std::size_t>(k)]; }
const Rigid3& Pose(int k) { return Rendered().world_from_cam[static_cast<std::size_t>(k)]; }
int Frames() { return static_cast<int>(Rendered().frames.size()); }

std::string Numbered(const char* format, int k) {
  char text[64];
  std::snprintf(text, sizeof text, format, k);
  return text;
}

template <class... Values>
std::string Line(const char* separator, const Values&... values) {
  std::ostringstream line;
  line.precision(12);
  const char* between = "";
  ((line << between << values, between = separator), ...);
  line << "\n";
  return line.str();
}

// What Unity says of a pose: y turned round, of the world and of the camera.
Rigid3 InUnity(const Rigid3& pose) {
  const Eigen::Vector3d turn(1, -1, 1);
  return {Eigen::Matrix3d(turn.asDiagonal() * pose.RotationMatrix() * turn.asDiagonal()),
          turn.cwiseProduct(pose.translation)};
}

cv::Mat Steps(const cv::Mat& depth_mm, double step_mm) {
  cv::Mat steps;
  depth_mm.convertTo(steps, CV_16U, 1.0 / step_mm);  // saturates
  steps.setTo(0, steps == 65535);
  return steps;
}

struct Expected {
  std::string kind;
  bool poses = true;
  bool pairs = false;
  double depth_mm = -1;      // largest error but for edges; -1: there is no depth
  double gray_levels = 1.0;  // mean difference of the images
};

class DataSets : public SequenceFiles {
 protected:
  void SceneCamera(const std::string& name) const {
    const Camera& camera = Rendered().camera;
    std::string params;
    for (const double value : camera.params()) params += (params.empty() ? "" : ", ") + std::to_string(value);
    Text(name, "model: PINHOLE\nwidth: " + std::to_string(camera.width()) +
                   "\nheight: " + std::to_string(camera.height()) + "\nparams: [" + params + "]\nfps: 30\n");
  }

  void Stereo(const std::string& name, double baseline) const {
    const auto& p = Rendered().camera.params();
    std::ostringstream matrix;
    matrix << "[" << p[0] << ", 0, " << p[2] << ", 0, " << p[1] << ", " << p[3] << ", 0, 0, 1]";
    Text(name, "M1: " + matrix.str() + "\nD1: [0, 0, 0, 0]\nM2: " + matrix.str() +
                   "\nD2: [0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [" + std::to_string(-baseline) +
                   ", 0, 0]\n");
  }

  // Left on top of right.
  void WriteStackedVideo(const std::string& name) const {
    std::filesystem::create_directories(Path(name).parent_path());
    cv::VideoWriter writer(Path(name).string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30,
                           {Rendered().camera.width(), 2 * Rendered().camera.height()});
    ASSERT_TRUE(writer.isOpened());
    for (int k = 0; k < Frames(); ++k) {
      cv::Mat pair;
      cv::vconcat(Frame(k).image, Frame(k).right, pair);
      writer.write(pair);
    }
  }

  void ExpectTheScene(const std::filesystem::path& path, const Expected& expected) const {
    const auto kind = RecognizeDataSet(path);
    ASSERT_TRUE(kind.ok()) << kind.status().message();
    EXPECT_EQ(kind->name, expected.kind);
    auto opened = OpenSequence({.image_path = path});
    ASSERT_TRUE(opened.ok()) << opened.status().message();
    Sequence& sequence = **opened;
    EXPECT_THAT(sequence.Warnings(), IsEmpty());
    EXPECT_EQ(sequence.size(), Frames());
    EXPECT_EQ(sequence.BaselineMm().has_value(), expected.pairs);
    if (expected.pairs) {
      EXPECT_NEAR(*sequence.BaselineMm(), Rendered().baseline_mm, kTextNumber);
    }
    for (int k = 0; k < Frames(); ++k) {
      const auto frame = sequence.Next();
      ASSERT_TRUE(frame.ok() && frame->has_value()) << frame.status().message();
      const cv::Rect inside(4, 4, sequence.camera().width() - 8, sequence.camera().height() - 8);
      EXPECT_LT(cv::norm((*frame)->image(inside), Frame(k).image(inside), cv::NORM_L1) / inside.area() / 3,
                expected.gray_levels);
      EXPECT_NEAR((*frame)->timestamp_s - *sequence.TimestampS(0), k / 30.0, kTimestamp_s);
      const auto depth = sequence.Depth(k);
      ASSERT_TRUE(depth.ok()) << depth.status().message();
      ASSERT_EQ(depth->has_value(), expected.depth_mm >= 0);
      if (depth->has_value()) {
        const cv::Mat has = **depth > 0;
        EXPECT_GT(cv::countNonZero(has), static_cast<int>(has.total()) / 4);
        cv::Mat difference;
        cv::absdiff(**depth, Frame(k).depth, difference);
        // Where a rectified pixel lies half a pixel off, so does the edge of what is in front.
        EXPECT_LT(cv::countNonZero(has & (difference > expected.depth_mm)), kAtEdges * cv::countNonZero(has));
      }
      const auto pose = sequence.WorldFromCamera(k);
      ASSERT_EQ(pose.has_value(), expected.poses);
      if (!pose) continue;
      const Rigid3 step = sequence.WorldFromCamera(0)->Inverse() * *pose;
      const Rigid3 error = step.Inverse() * (Pose(0).Inverse() * Pose(k));
      EXPECT_LT(error.translation.norm(), kPose_mm);
      EXPECT_LT(RotationAngle(error.rotation), kPose_rad);
    }
    auto again = OpenSequence({.image_path = path});
    ASSERT_TRUE(again.ok());
    const auto check = CheckSequence(**again);
    ASSERT_TRUE(check.ok()) << check.status().message();
    EXPECT_THAT(check->wrong, IsEmpty());
    if (expected.poses && expected.depth_mm >= 0) {
      EXPECT_EQ(check->poses->right, true);
    }
  }
};

TEST_F(DataSets, SimCol3D) {
  std::string positions;
  std::string rotations;
  for (int k = 0; k < Frames(); ++k) {
    Write("Frames_S1/" + Numbered("FrameBuffer_%04d.png", k), Frame(k).image);
    Write("Frames_S1/" + Numbered("Depth_%04d.png", k), Steps(Frame(k).depth, 200.0 / 65536.0));
    const Rigid3 pose = InUnity(Pose(k));
    const auto& t = pose.translation;
    const auto& q = pose.rotation;
    positions += Line(" ", t.x() / 10, t.y() / 10, t.z() / 10);
    rotations += Line(" ", q.x(), q.y(), q.z(), q.w());
  }
  Text("SavedPosition_S1.txt", positions);
  Text("SavedRotationQuaternion_S1.txt", rotations);
  SceneCamera("Frames_S1/camera.yaml");
  ExpectTheScene(Path("Frames_S1"), {.kind = "simcol", .depth_mm = 0.01});
}

TEST_F(DataSets, C3vdOfBothVersions) {
  std::string poses;
  for (int k = 0; k < Frames(); ++k) {
    Write("v1/" + std::to_string(k) + "_color.png", Frame(k).image);
    Write("v1/" + Numbered("%04d_depth.tiff", k), Steps(Frame(k).depth, 100.0 / 65535.0));
    Write("v2/rgb/" + Numbered("%04d.png", k), Frame(k).image);
    Write("v2/depth/" + Numbered("%04d.tiff", k), Steps(Frame(k).depth, 100.0 / 65535.0));
    const Eigen::Matrix3d r = Pose(k).RotationMatrix();
    const Eigen::Vector3d& t = Pose(k).translation;
    poses += Line(",", r(0, 0), r(1, 0), r(2, 0), 0, r(0, 1), r(1, 1), r(2, 1), 0, r(0, 2), r(1, 2), r(2, 2), 0, t.x(),
                  t.y(), t.z(), 1);
  }
  for (const char* version : {"v1", "v2"}) {
    Text(std::string(version) + "/pose.txt", poses);
    SceneCamera(std::string(version) + "/camera.yaml");
    ExpectTheScene(Path(version), {.kind = "c3vd", .depth_mm = 0.01});
  }
}

TEST_F(DataSets, EndomapperSimulated) {
  std::string poses = "tX;tY;tZ;rX;rY;rZ;rW;time(s)\n";
  for (int k = 0; k < Frames(); ++k) {
    Write("seq/rgb/" + Numbered("image_%04d.png", k), Frame(k).image);
    cv::Mat buffer(Frame(k).depth.size(), CV_32FC3);
    for (int v = 0; v < buffer.rows; ++v)
      for (int u = 0; u < buffer.cols; ++u) {
        const float depth_dm = Frame(k).depth.at<float>(v, u) / 100.0F;
        const float d = depth_dm > 0 ? (1.0F / depth_dm - 0.25F) / 99.75F : 0.0F;
        buffer.at<cv::Vec3f>(v, u) = {0, 0, d};  // BGR
      }
    Write("seq/depth/" + Numbered("aov_image_%04d.exr", k), buffer);
    const Rigid3 pose = InUnity(Pose(k));
    const Eigen::Vector3d t = pose.translation / 100.0;
    const auto& q = pose.rotation;
    poses += Line(";", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), k / 30.0);
  }
  Text("seq/trajectory.csv", poses);
  SceneCamera("seq/camera.yaml");
  ExpectTheScene(Path("seq"), {.kind = "endomapper_simulated", .depth_mm = 0.3});  // half floats
}

TEST_F(DataSets, EndoSlam) {
  std::string poses = "tX,tY,tZ,rX,rY,rZ,rW,time\n";
  for (int k = 0; k < Frames(); ++k) {
    Write("Colon/Frames/" + Numbered("image_%04d.png", k), Frame(k).image);
    cv::Mat depth_cm;
    Frame(k).depth.convertTo(depth_cm, CV_8U, 0.1);
    cv::Mat rgba;
    cv::merge(std::vector<cv::Mat>{depth_cm, depth_cm, depth_cm, cv::Mat(depth_cm.size(), CV_8U, cv::Scalar(255))},
              rgba);
    Write("Colon/Pixelwise Depths/" + Numbered("aov_image_%04d.png", k), rgba);
    const Rigid3 pose = InUnity(Pose(k));
    const Eigen::Vector3d t = pose.translation / 1000.0;
    const auto& q = pose.rotation;
    poses += Line(",", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), k / 30.0);
  }
  Text("Colon/Poses/colon_position_rotation.csv", poses);
  SceneCamera("Colon/camera.yaml");
  ExpectTheScene(Path("Colon"), {.kind = "endoslam", .depth_mm = 5.1});
}

TEST_F(DataSets, HamlynRectified) {
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

TEST_F(DataSets, TumRgbd) {
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

TEST_F(DataSets, EuRoC) {
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

TEST_F(DataSets, StereoMis) {
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

TEST_F(DataSets, Scared) {
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

TEST_F(DataSets, EndomapperReal) {
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

TEST_F(DataSets, Colmap) {
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

TEST_F(DataSets, CalibrationsThatAreNoneAreRefused) {
  const auto refused = [&](const char* folder, const std::string& what) {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_FALSE(sequence.ok()) << what;
    EXPECT_THAT(sequence.status().message(), HasSubstr(what));
  };
  std::filesystem::create_directories(Path("Seq_001"));
  cv::VideoWriter writer(Path("Seq_001/Seq_001.mov").string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30, {kWidth, kHeight});
  writer.write(Image(0));
  writer.release();
  const auto calibu = [&](const std::string& type, const std::string& width) {
    Text("Seq_001/a_geometrical.xml", "<rig><camera><camera_model type=\"" + type + "\"><width> " + width +
                                          " </width><height> 48 </height><params> [ 60; 60; 31.5; 23.5 ] </params>"
                                          "</camera_model></camera></rig>");
  };
  Text("Seq_001/a_geometrical.xml", "<rig><camera>");
  refused("Seq_001", "is no XML");
  calibu("calibu_fu_fv_u0_v0", "1e300");
  refused("Seq_001", "no width and height");
  calibu("calibu_fu_fv_u0_v0_w", "64");
  refused("Seq_001", "'calibu_fu_fv_u0_v0_w', which is not known");
  calibu("calibu_fu_fv_u0_v0", "64");
  Text("Seq_001/a_photometrical.xml",
       "<rig><camera><camera_model><gamma> [ -1 ] </gamma></camera_model></camera></rig>");
  refused("Seq_001", "gamma must be");

  Text("mav0/cam0/data.csv", "#\n1,1.png\n");
  Write("mav0/cam0/data/1.png", Image(0));
  const auto euroc = [&](const std::string& model, const std::string& size) {
    Text("mav0/cam0/sensor.yaml", "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: " +
                                      size + "\nintrinsics: [60, 60, 32, 24]\ndistortion_model: " + model +
                                      "\ndistortion_coefficients: [0, 0, 0, 0]\n");
  };
  euroc("fov", "[64, 48]");
  refused(".", "the distortion_model 'fov', which is not known");
  euroc("radtan", "[1e300, 48]");
  refused(".", "is not EuRoC's description of a camera");
}

TEST_F(DataSets, APoseThatIsNotTransposedIsRefused) {
  Write("c3vd/0_color.png", Image(0));
  WriteCamera("c3vd/camera.yaml");
  Text("c3vd/pose.txt", "1,0,0,5,0,1,0,6,0,0,1,7,0,0,0,1\n");
  const auto sequence = OpenSequence({.image_path = Path("c3vd")});
  ASSERT_FALSE(sequence.ok());
  EXPECT_THAT(sequence.status().message(), HasSubstr("last row is not 0 0 0 1"));
}

TEST_F(DataSets, FramesMissingInTheMiddleAreSaid) {
  for (int k = 0; k < 10; ++k)
    if (k != 4 && k != 5) Write("seq/" + Numbered("FrameBuffer_%04d.png", k), Image(k));
  for (int k = 0; k < 9; ++k)
    Write("seq/" + Numbered("Depth_%04d.png", k), cv::Mat(kHeight, kWidth, CV_16U, cv::Scalar(100)));
  WriteCamera("seq/camera.yaml");
  const auto sequence = OpenSequence({.image_path = Path("seq")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_EQ((*sequence)->size(), 8);
  EXPECT_THAT((*sequence)->Warnings(),
              ElementsAre(HasSubstr("2 images are missing, the first is number 4"),
                          HasSubstr("1 of 8 images have no depth image, the first is FrameBuffer_0009.png")));
}

TEST_F(DataSets, PublishedCamerasAreTaken) {
  Write("simcol/FrameBuffer_0000.png", Image(0, 475, 475));
  Write("c3vd/0_color.png", Image(0, 1350, 1080));
  Write("c3vd_pinhole/0_color.png", Image(0, 675, 540));
  Write("endomapper/rgb/image_0000.png", Image(0, 960, 720));
  Write("endoslam/Frames/image_0000.png", Image(0, 320, 320));
  std::filesystem::create_directories(Path("endoslam/Pixelwise Depths"));
  for (const auto& [folder, model, focal] :
       {std::tuple("simcol", "PINHOLE", 227.604), std::tuple("c3vd", "OPENCV_FISHEYE", 767.386),
        std::tuple("c3vd_pinhole", "PINHOLE", 401.16), std::tuple("endomapper", "PINHOLE", 472.6496),
        std::tuple("endoslam", "PINHOLE", 156.0418)}) {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    EXPECT_EQ((*sequence)->camera().model_name(), model);
    EXPECT_NEAR((*sequence)->camera().params()[0], focal, kPublished_px);
  }
  Write("wrong/FrameBuffer_0000.png", Image(0, 640, 480));
  const auto wrong = OpenSequence({.image_path = Path("wrong")});
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(wrong.status().message(), HasSubstr("published with SimCol3D is for images of 475x475"));
}

TEST_F(DataSets, WhatIsGarbledIsNamed) {
  for (int k = 0; k < 2; ++k) {
    Write("c3vd/" + std::to_string(k) + "_color.png", Image(k));
    Write("mav/cam0/data/" + std::to_string(k) + ".png", Image(k));
    Write("tum/rgb/" + std::to_string(k) + ".png", Image(k));
  }
  WriteCamera("c3vd/camera.yaml");
  WriteCamera("tum/camera.yaml");
  Text("c3vd/pose.txt", "1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n1,0,0,0,0,1,0,0,0,0\n");
  Text("mav/cam0/data.csv", "#timestamp [ns],filename\n0,0.png\nx,1.png\n");
  Text("tum/rgb.txt", "0.0 rgb/0.png\n0.1\n");
  Write("scared/data/x.png", Image(0));
  Text("scared/data/rgb.mp4", "no video");
  Text("scared/endoscope_calibration.yaml", "M1: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n");
  for (const auto& [folder, said] :
       {std::pair("c3vd", "pose.txt:2: a line has 16 numbers"), std::pair("mav", "data.csv:3: a line has a time in ns"),
        std::pair("tum", "rgb.txt:2: a line has a time and a file"), std::pair("scared", "rgb.mp4 as a video")}) {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_FALSE(sequence.ok()) << folder;
    EXPECT_EQ(sequence.status().code(), ErrorCode::kUnreadable) << sequence.status().message();
    EXPECT_THAT(sequence.status().message(), HasSubstr(said));
  }
  Text("c3vd/pose.txt", "2,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n");
  const auto scaled = OpenSequence({.image_path = Path("c3vd")});
  ASSERT_FALSE(scaled.ok());
  EXPECT_THAT(scaled.status().message(), HasSubstr("the matrix is not a pose"));
}

}  // namespace
}  // namespace pliant
