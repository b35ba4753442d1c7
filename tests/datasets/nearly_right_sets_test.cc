// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Data sets that are nearly right: what is there but cannot be used is said, and a folder that is none says what it may
// be meant for.
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/sequence_files.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/run_sequence.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kDepthStep_mm = 0.01;  // 16 bits over up to 200 mm have steps of 0.003

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

class NearlyRightSets : public SequenceFiles {
 protected:
  std::vector<std::string> Warnings(const std::string& folder, const std::string& camera = "") const {
    const auto sequence =
        OpenSequence({.image_path = Path(folder), .camera_path = camera.empty() ? camera : Path(camera).string()});
    EXPECT_TRUE(sequence.ok()) << sequence.status().message();
    return sequence.ok() ? (*sequence)->Warnings() : std::vector<std::string>();
  }

  std::string WhyNot(const std::string& folder) const {
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    EXPECT_FALSE(sequence.ok());
    return sequence.ok() ? "" : sequence.status().message();
  }

  static cv::Mat Depth(int value) { return {kHeight, kWidth, CV_16U, cv::Scalar(value)}; }
};

TEST_F(NearlyRightSets, DepthAtFullScaleIsNone) {
  cv::Mat depth = Depth(65535);
  depth.at<std::uint16_t>(3, 4) = 65534;
  Write("c3vd/0_color.png", Image(0));
  Write("c3vd/0000_depth.tiff", depth);
  Write("simcol/FrameBuffer_0000.png", Image(0));
  Write("simcol/Depth_0000.png", depth);
  for (const auto& [folder, largest_mm] : {std::pair("c3vd", 100.0), std::pair("simcol", 200.0)}) {
    WriteCamera(std::string(folder) + "/camera.yaml");
    const auto sequence = OpenSequence({.image_path = Path(folder)});
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    const auto read = (*sequence)->Depth(0);
    ASSERT_TRUE(read.ok() && read->has_value());
    EXPECT_EQ(cv::countNonZero(**read), 1);
    EXPECT_NEAR((*read)->at<float>(3, 4), largest_mm, kDepthStep_mm);
  }
}

TEST_F(NearlyRightSets, MissingDepthAndPosesOfANativeSequenceAreSaid) {
  WriteNative(4);
  for (const int k : {0, 3}) Write("depth/" + Name(k), Depth(100));
  Text("groundtruth.txt", "0.05 0 0 0 0 0 0 1\n");
  EXPECT_THAT(Warnings(""),
              ElementsAre(HasSubstr("2 of 4 images have no depth image, the first is 000001.png (frame 1)"),
                          HasSubstr("3 of 4 images have no pose, the first is 000000.png (frame 0)")));
}

TEST_F(NearlyRightSets, ImagesMissingInTheMiddleAreSaidUnlessTimesTellThem) {
  WriteCamera();
  for (const int k : {0, 1, 2, 5, 6}) Write("images/" + Name(k), Image(k));
  EXPECT_THAT(Warnings(""), ElementsAre(HasSubstr("2 images are missing, the first is number 3")));
  EXPECT_THAT(Warnings("images", "camera.yaml"), ElementsAre(HasSubstr("2 images are missing")));
  Text("times.txt", "0\n0.05\n0.1\n0.25\n0.3\n");
  EXPECT_THAT(Warnings(""), IsEmpty());
}

TEST_F(NearlyRightSets, EveryFifthImageLeavesNoneOut) {
  WriteCamera();
  for (const int k : {0, 5, 10, 15}) Write("images/frame_" + Name(k), Image(k));
  EXPECT_THAT(Warnings(""), IsEmpty());
}

TEST_F(NearlyRightSets, TimesAndChosenFramesAreNoCounters) {
  WriteCamera();
  for (const char* name : {"frame_1633024800123", "frame_1633024800143", "frame_1633024800188"})
    Write("stamps/" + std::string(name) + ".png", Image(0));
  for (const int k : {120000, 120001, 120059, 120100, 120101}) Write("clock/" + Name(k), Image(0));
  for (const int k : {1, 2, 50, 120, 400}) Write("chosen/" + Name(k), Image(0));
  for (const char* folder : {"stamps", "clock", "chosen"}) EXPECT_THAT(Warnings(folder, "camera.yaml"), IsEmpty());
}

TEST_F(NearlyRightSets, ASpareCalibrationServesWhereTheImagesHaveNoneThatFits) {
  WriteImages(1);
  WriteCamera("spare.yaml");
  const SequenceRequest request{.image_path = Path("images"), .spare_camera_path = Path("spare.yaml")};
  EXPECT_TRUE(OpenSequence(request).ok());
  WriteCamera("images/camera.yaml", 2 * kWidth, 2 * kHeight);
  EXPECT_TRUE(OpenSequence(request).ok()) << "theirs does not fit";
  Text("images/camera.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [70, 70, 31.5, 23.5]\n");
  const auto own = OpenSequence(request);
  ASSERT_TRUE(own.ok());
  EXPECT_EQ((*own)->camera().params()[0], 70) << "the images' own comes first";
  const auto none = OpenSequence({.image_path = Path("images/0"), .spare_camera_path = Path("nowhere.yaml")});
  EXPECT_THAT(none.status().message(), HasSubstr("nothing at the image path"));
}

TEST_F(NearlyRightSets, EurocWithoutItsRightImagesIsOneCamera) {
  for (const char* eye : {"cam0", "cam1"}) {
    Text("mav0/" + std::string(eye) + "/data.csv", "#timestamp [ns],filename\n0,0.png\n50000000,1.png\n");
    Text("mav0/" + std::string(eye) + "/sensor.yaml",
         "T_BS:\n  data: [1, 0, 0, " + std::string(eye == std::string("cam0") ? "0" : "0.1") +
             ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [64, 48]\nintrinsics: [60, 60, 31.5, 23.5]\n"
             "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n");
  }
  for (int k = 0; k < 2; ++k) Write("mav0/cam0/data/" + std::to_string(k) + ".png", Image(k));
  EXPECT_THAT(Warnings(""), ElementsAre(HasSubstr("pairs are not read")));
  Write("mav0/cam1/data/1.png", Image(1));
  EXPECT_THAT(Warnings(""), ElementsAre(HasSubstr("1 images of cam0 or cam1")));
  const auto sequence = OpenSequence({.image_path = Path("")});
  EXPECT_EQ((*sequence)->size(), 1);
  EXPECT_TRUE((*sequence)->BaselineMm().has_value());
}

TEST_F(NearlyRightSets, RightImagesWithoutABaselineAreSaid) {
  WriteNative(2);
  for (int k = 0; k < 2; ++k) {
    Write("right/" + Name(k), Image(k));
    Write("hamlyn/image01/" + Name(k), Image(k));
    Write("hamlyn/image02/" + Name(k), Image(k));
  }
  Text("hamlyn/intrinsics.txt", "60 0 31.5\n0 60 23.5\n0 0 1\n");
  EXPECT_THAT(Warnings(""),
              ElementsAre(AllOf(HasSubstr("right are not read"), EndsWith("camera.yaml says no baseline"))));
  EXPECT_THAT(Warnings("hamlyn"), ElementsAre(AllOf(HasSubstr("image02 are not read"), HasSubstr("extrinsics.txt"))));
}

TEST_F(NearlyRightSets, PosesThatCannotBeReadAreSaid) {
  for (const char* folder : {"Frames_S1", "renamed"}) {
    Write(std::string(folder) + "/FrameBuffer_0000.png", Image(0));
    WriteCamera(std::string(folder) + "/camera.yaml");
  }
  Text("SavedPosition_S1.txt", "0 0 0\n");
  EXPECT_THAT(Warnings("Frames_S1"), ElementsAre(AllOf(HasSubstr("SavedPosition_S1.txt is there"),
                                                       HasSubstr("no SavedRotationQuaternion_S1.txt"))));
  EXPECT_THAT(Warnings("renamed"), ElementsAre(HasSubstr("no SavedPosition_renamed.txt")));
  Write("Colon/Frames/image_0000.png", Image(0));
  std::filesystem::create_directories(Path("Colon/Pixelwise Depths"));
  WriteCamera("Colon/camera.yaml");
  for (const char* name : {"a", "b"}) Text("Colon/Poses/" + std::string(name) + ".csv", "0,0,0,0,0,0,1,0\n");
  EXPECT_THAT(Warnings("Colon"), ElementsAre(HasSubstr("Poses holds not exactly one .csv")));
}

TEST_F(NearlyRightSets, TumsTimesFilesAndUnitAreLookedAt) {
  for (int k = 0; k < 2; ++k) Write("tum/rgb/" + Name(k), Image(k));
  Write("tum/depth/" + Name(0), Depth(100));
  WriteCamera("tum/camera.yaml");  // 0.5 mm a unit
  Text("tum/rgb.txt", "1.0 rgb/000000.png\n1.1 rgb/000001.png\n1.2 rgb/000002.png\n");
  Text("tum/depth.txt", "1.0 depth/000000.png\n");
  Text("tum/groundtruth.txt", "5.0 0 0 0 0 0 0 1\n");
  EXPECT_THAT(Warnings("tum"), ElementsAre(HasSubstr("1 files that"), HasSubstr("1 of 2 images have no depth image"),
                                           HasSubstr("2 of 2 images have no pose")));
  const auto sequence = OpenSequence({.image_path = Path("tum")});
  const auto depth = (*sequence)->Depth(0);
  ASSERT_TRUE(depth.ok() && depth->has_value());
  EXPECT_FLOAT_EQ((*depth)->at<float>(0, 0), 50.0F);
}

TEST_F(NearlyRightSets, AFolderThatLacksAFileSaysWhich) {
  Write("hamlyn/image01/0.png", Image(0));
  Text("scared/endoscope_calibration.yaml", "M1: 0\n");
  Write("scared/Left_Image.png", Image(0));
  Text("mis/StereoCalibration.ini", "");
  std::filesystem::create_directories(Path("tum/rgb"));
  Text("tum/depth.txt", "");
  std::filesystem::create_directories(Path("mav/mav0"));
  WriteVideo("Seq_001.avi", 2);
  std::filesystem::create_directories(Path("Seq_001"));
  std::filesystem::rename(Path("Seq_001.avi"), Path("Seq_001/Seq_001.mov"));
  EXPECT_THAT(WhyNot("hamlyn"), HasSubstr("it looks like hamlyn_rectified, but lacks intrinsics.txt"));
  EXPECT_THAT(WhyNot("scared"), HasSubstr("it looks like scared, but lacks data/rgb.mp4"));
  EXPECT_THAT(WhyNot("mis"), HasSubstr("it looks like stereomis, but lacks one .mp4"));
  EXPECT_THAT(WhyNot("tum"), HasSubstr("it looks like tum_rgbd, but lacks rgb.txt"));
  EXPECT_THAT(WhyNot("mav"), HasSubstr("it looks like euroc, but lacks mav0/cam0/data.csv"));
  EXPECT_THAT(WhyNot("Seq_001"), HasSubstr("it looks like endomapper, but lacks Seq_NNN_info.json"));
}

TEST_F(NearlyRightSets, AFolderBesideADataSetSaysWhereItIs) {
  Write("SyntheticColon_I/Frames_S1/FrameBuffer_0000.png", Image(0));
  EXPECT_THAT(WhyNot("SyntheticColon_I"),
              AllOf(HasSubstr("holds no image"), EndsWith("Frames_S1 is a data set (simcol); give that")));
  Write("sets/SyntheticColon_I/Frames_S1/FrameBuffer_0000.png", Image(0));
  EXPECT_THAT(WhyNot("sets"), EndsWith("SyntheticColon_I/Frames_S1 is a data set (simcol); give that"));
  Text("V1/mav0/cam0/data.csv", "#\n");
  EXPECT_THAT(WhyNot("V1/mav0/cam0"), EndsWith("mav0 is a data set (euroc); give that"));
  std::filesystem::create_directories(Path("clips"));
  WriteVideo("clips/a.avi", 2);
  EXPECT_THAT(WhyNot("clips"), HasSubstr("but the video " + Path("clips/a.avi").string() + "; give that"));
  WriteVideo("clips/b.avi", 2);
  EXPECT_THAT(WhyNot("clips"), HasSubstr("but 2 videos; give one of them"));
  std::filesystem::create_directories(Path("empty"));
  EXPECT_THAT(WhyNot("empty"), HasSubstr("holds no image"));
}

TEST_F(NearlyRightSets, CalibrationsOfOtherToolsServeAnyVideo) {
  WriteVideo("clip.avi", 2);
  Text("endoscope_geometrical.xml",
       "<rig><camera><camera_model type=\"calibu_fu_fv_u0_v0_kb4\"><width> 64 </width><height> 48 </height><params> [ "
       "60; "
       "60; 31.5; 23.5; 0.1; 0; 0; 0 ] </params></camera_model></camera></rig>");
  const auto sequence =
      OpenSequence({.image_path = Path("clip.avi"), .camera_path = Path("endoscope_geometrical.xml")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_EQ((*sequence)->camera().model_name(), "OPENCV_FISHEYE");
  std::string ini;
  for (const char* side : {"StereoLeft", "StereoRight"})
    ini += "[" + std::string(side) + "]\nres_x = 64\nres_y = 24\nfc_x = 60\nfc_y = 60\ncc_x = 31.5\ncc_y = 11.5\n" +
           "kc_0 = 0\nkc_1 = 0\nkc_2 = 0\nkc_3 = 0\n";
  for (int k = 0; k < 9; ++k) ini += "R_" + std::to_string(k) + " = " + (k % 4 == 0 ? "1" : "0") + "\n";
  Text("StereoCalibration.ini", ini + "T_0 = -4\nT_1 = 0\nT_2 = 0\n");
  const auto pairs = OpenSequence({.image_path = Path("clip.avi"), .camera_path = Path("StereoCalibration.ini")});
  ASSERT_TRUE(pairs.ok()) << pairs.status().message();
  EXPECT_NEAR((*pairs)->BaselineMm().value(), 4.0, kRoundOff);
}

TEST_F(NearlyRightSets, ArchivesThatAreNotUnpackedAreSaid) {
  std::filesystem::create_directories(Path("keyframe/data"));
  cv::VideoWriter writer(Path("keyframe/data/rgb.mp4").string(), cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 25, {64, 96});
  ASSERT_TRUE(writer.isOpened());
  for (int k = 0; k < 3; ++k) writer.write(cv::Mat(96, 64, CV_8UC3, cv::Scalar::all(10 * k)));
  writer.release();
  Text("keyframe/endoscope_calibration.yaml",
       "M1: [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]\nD1: [0, 0, 0, 0]\nM2: [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]\n"
       "D2: [0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-4, 0, 0]\n");
  for (const char* name : {"frame_data", "scene_points"})
    Text("keyframe/data/" + std::string(name) + ".tar.gz", "not read");
  EXPECT_THAT(Warnings("keyframe"), ElementsAre(HasSubstr("frame_data.tar.gz is not unpacked; unpack it into"),
                                                HasSubstr("scene_points.tar.gz is not unpacked")));
  // Unpacked where they lie.
  Text("keyframe/data/frame_data000000.json",
       "{\"camera-pose\": [[1, 0, 0, 7], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}");
  const auto sequence = OpenSequence({.image_path = Path("keyframe")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ASSERT_TRUE((*sequence)->WorldFromCamera(0).has_value());
  EXPECT_NEAR((*sequence)->WorldFromCamera(0)->translation.x(), -7, kRoundOff);
  EXPECT_THAT((*sequence)->Warnings(), Contains(HasSubstr("2 of 3 images have no pose")));
}

TEST_F(NearlyRightSets, ARunsImagesKeepTheCalibrationItWasMadeWith) {
  WriteImages(1);
  std::filesystem::create_directories(Path("run"));
  Text("run/run.json",
       "{\"program\": \"pliant\", \"version\": \"0\", \"command_line\": [], \"seed\": 1, \"input\": \"" +
           Path("images").string() + "\", \"camera\": \"lens.yaml\", \"mask\": \"" + Path("run").string() +
           "\", \"frames\": {\"start\": 3, \"end\": 9, \"stride\": 2}, \"status\": \"completed\", \"note\": \"\", "
           "\"counts\": {\"frames_read\": 0, "
           "\"frames_tracked\": 0, \"points\": 0, \"observations\": 0, \"losses\": {}}, \"timings\": {\"total_s\": 0, "
           "\"frames_per_second\": 0, \"mean_ms\": {}}}");
  const std::string run = Path("run").string();
  EXPECT_EQ(SequenceOfRun(run).image_path, Path("images"));
  EXPECT_EQ(SequenceOfRun(run).spare_camera_path, "lens.yaml");
  EXPECT_EQ(SequenceOfRun(run, Path("run/../images")).spare_camera_path, "lens.yaml");
  EXPECT_EQ(SequenceOfRun(run).mask_path, Path("run"));
  EXPECT_EQ(SequenceOfRun(run).start, 3);
  EXPECT_EQ(SequenceOfRun(run).end, 9);
  EXPECT_EQ(SequenceOfRun(run).stride, 2);
  EXPECT_EQ(SequenceOfRun(run).Whole().end, -1);
  EXPECT_EQ(SequenceOfRun(run, "elsewhere").mask_path, "");
  EXPECT_EQ(SequenceOfRun(run, "elsewhere").spare_camera_path, "lens.yaml");
  std::filesystem::create_directories(Path("run/sparse/0"));
  Text("run/sparse/0/cameras.bin", "");
  EXPECT_EQ(SequenceOfRun(run, "elsewhere").spare_camera_path, Path("run/sparse/0/cameras.bin"));
  EXPECT_EQ(SequenceOfRun(run, "elsewhere", "other.yaml").camera_path, "other.yaml");
  EXPECT_EQ(SequenceOfRun(Path("no_run").string()).image_path, "");
}

}  // namespace
}  // namespace pliant
