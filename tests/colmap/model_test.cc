// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/model.h"

#include <filesystem>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/sample_model.h"
#include "pliant/base/text.h"
#include "support/test_folder.h"

namespace pliant::colmap {
namespace {

using testing::HasSubstr;

const std::array<std::string, 3> kNames = {"cameras", "images", "points3D"};

// As COLMAP 3.8 writes it: its comments, its 17 digits, its order.
const std::string kCamerasText =
    "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
    "# Number of cameras: 1\n1 PINHOLE 640 480 534.73607615950516 541.45229968438412 320 240\n";
const std::string kImagesText =
    "# Image list with two lines of data per image:\n"
    "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
    "# Number of images: 2, mean observations per image: 1\n"
    "20 0.97010366726758268 -0.010491833012947979 -0.22440933244223263 -0.091810934571255109 5.3747062952537474 "
    "0.90842706293954134 -0.066956787675407581 1 000057.jpg\n"
    "297.232666015625 436.62710571289062 417 1.5 2.5 -1\n"
    "3 1 0 0 0 0 0 1.0000000000000001e-05 1 000060.jpg\n290.2998046875 440.29721069335938 417\n";
const std::string kPointsText =
    "# 3D point list with one line of data per point:\n"
    "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
    "# Number of points: 1, mean track length: 2\n"
    "417 -9.8866023522070527 3.7914496913134199 29.443325957043523 251 255 226 0.058312461635814293 20 0 3 0\n";

void WriteSampleText(const TestFolder& folder) {
  folder.Write("cameras.txt", kCamerasText);
  folder.Write("images.txt", kImagesText);
  folder.Write("points3D.txt", kPointsText);
}

TEST(ColmapModel, TextThatColmapWroteComesBackByteForByte) {
  const TestFolder folder;
  WriteSampleText(folder);
  const auto model = ReadModel(folder.Path(""));
  ASSERT_TRUE(model.ok()) << model.status().message();
  ASSERT_TRUE(WriteModel(folder.Path("again"), *model, Format::kText).ok());
  EXPECT_EQ(folder.Read("again/cameras.txt"), kCamerasText);
  EXPECT_EQ(folder.Read("again/images.txt"), kImagesText);
  EXPECT_EQ(folder.Read("again/points3D.txt"), kPointsText);
}

TEST(ColmapModel, ComesBackFromEitherFormatToTheLastBit) {
  const TestFolder folder;
  Model model = SampleModelWithRigs();
  model.points3D[0].xyz = {std::numeric_limits<double>::infinity(), 5e-324, -1.7976931348623157e308};
  ASSERT_TRUE(WriteModel(folder.Path("text"), model, Format::kText, Rigs::kWritten).ok());
  ASSERT_TRUE(WriteModel(folder.Path("binary"), model, Format::kBinary, Rigs::kWritten).ok());
  const auto from_text = ReadModel(folder.Path("text"));
  const auto from_binary = ReadModel(folder.Path("binary"));
  ASSERT_TRUE(from_text.ok()) << from_text.status().message();
  ASSERT_TRUE(from_binary.ok()) << from_binary.status().message();
  EXPECT_EQ(from_binary->points3D[0].xyz, model.points3D[0].xyz);
  // Each written in the other's format is what the other wrote.
  ASSERT_TRUE(WriteModel(folder.Path("text_to_binary"), *from_text, Format::kBinary, Rigs::kWritten).ok());
  ASSERT_TRUE(WriteModel(folder.Path("binary_to_text"), *from_binary, Format::kText, Rigs::kWritten).ok());
  for (const std::string name : {"cameras", "images", "points3D", "rigs", "frames"}) {
    EXPECT_FALSE(folder.Read("text/" + name + ".txt").empty());
    EXPECT_EQ(folder.Read("text_to_binary/" + name + ".bin"), folder.Read("binary/" + name + ".bin")) << name;
    EXPECT_EQ(folder.Read("binary_to_text/" + name + ".txt"), folder.Read("text/" + name + ".txt")) << name;
  }
}

TEST(ColmapModel, HasRigsOnRequestOnly) {
  const TestFolder folder;
  ASSERT_TRUE(WriteModel(folder.Path("m"), SampleModelWithRigs(), Format::kBoth).ok());
  for (const char* name : {"rigs.txt", "rigs.bin", "frames.txt", "frames.bin"})
    EXPECT_FALSE(std::filesystem::exists(folder.Path("m/" + std::string(name))));
  EXPECT_EQ(FindModel(folder.Path("m")).value(), Format::kBoth);
}

TEST(ColmapModel, TheBinaryLayoutIsColmaps) {
  const TestFolder folder;
  Model model;
  model.cameras = {{1, 0, 4, 3, {2, 1, 1}}};
  model.images = {{5, {{1, 0, 0, 0}, {0, 0, 0}}, 1, "a", {{1, 2, kNoPoint3D}}}};
  ASSERT_TRUE(WriteModel(folder.Path("m"), model, Format::kBinary).ok());
  std::string expected;
  for (const auto& [value, bytes] : std::vector<std::pair<std::uint64_t, int>>{{1, 8}, {1, 4}, {0, 4}, {4, 8}, {3, 8}})
    AppendBytes(&expected, value, bytes);
  for (const double param : {2., 1., 1.}) AppendDouble(&expected, param);
  EXPECT_EQ(folder.Read("m/cameras.bin"), expected);
  expected.clear();
  AppendBytes(&expected, 1, 8);
  AppendBytes(&expected, 5, 4);
  for (const double value : {1., 0., 0., 0., 0., 0., 0.}) AppendDouble(&expected, value);
  AppendBytes(&expected, 1, 4);
  expected += std::string("a\0", 2);
  AppendBytes(&expected, 1, 8);
  AppendDouble(&expected, 1);
  AppendDouble(&expected, 2);
  AppendBytes(&expected, ~std::uint64_t{0}, 8);
  EXPECT_EQ(folder.Read("m/images.bin"), expected);
  EXPECT_EQ(folder.Read("m/points3D.bin"), std::string(8, '\0'));
}

// What COLMAP's own reader ends on.
TEST(ColmapModel, TextMayHaveRepeatedBlanksTabsAndLineEndsOfWindows) {
  const TestFolder folder;
  WriteSampleText(folder);
  std::string images = kImagesText;
  for (std::size_t at = 0; (at = images.find(' ', at)) != std::string::npos; at += 3) images.replace(at, 1, " \t ");
  for (std::size_t at = 0; (at = images.find('\n', at)) != std::string::npos; at += 2) images.replace(at, 1, "\r\n");
  folder.Write("images.txt", images);
  const auto model = ReadModel(folder.Path(""));
  ASSERT_TRUE(model.ok()) << model.status().message();
  EXPECT_EQ(model->images[0].name, "000057.jpg");
  EXPECT_EQ(model->images[0].points2D.size(), 2U);
  EXPECT_EQ(model->images[1].points2D[0].point3D_id, 417U);
}

TEST(ColmapModel, AnImageWithoutKeypointsHasAnEmptyLine) {
  const TestFolder folder;
  WriteSampleText(folder);
  folder.Write("images.txt", "1 1 0 0 0 0 0 0 1 a b.png\n\n2 1 0 0 0 0 0 0 1 c.png\n\n");
  const auto model = ReadModel(folder.Path(""));
  ASSERT_TRUE(model.ok()) << model.status().message();
  ASSERT_EQ(model->images.size(), 2U);
  EXPECT_EQ(model->images[0].name, "a b.png");
  EXPECT_TRUE(model->images[1].points2D.empty());
}

TEST(ColmapModel, BinaryWinsAsInColmap) {
  const TestFolder folder;
  WriteSampleText(folder);
  ASSERT_TRUE(WriteModel(folder.Path("other"), SampleModel(), Format::kBinary).ok());
  for (const std::string& name : kNames)
    std::filesystem::copy(folder.Path("other/" + name + ".bin"), folder.Path(name + ".bin"));
  EXPECT_EQ(ReadModel(folder.Path("")).value().images.size(), 3U);
  EXPECT_EQ(ReadModel(folder.Path(""), Format::kText).value().images.size(), 2U);
}

TEST(ColmapModel, IsNotWrittenBesideOneInAnotherFormat) {
  const TestFolder folder;
  ASSERT_TRUE(WriteModel(folder.Path("m"), SampleModel(), Format::kBinary).ok());
  const Status status = WriteModel(folder.Path("m"), SampleModel(), Format::kText);
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("cameras.bin"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("m/cameras.txt")));
}

TEST(ColmapModel, IsWrittenAsAWholeOrNotAtAll) {
  const TestFolder folder;
  ASSERT_TRUE(WriteModel(folder.Path("m"), SampleModel(), Format::kText).ok());
  const std::string before = folder.Read("m/cameras.txt");
  std::filesystem::create_directories(folder.Path("m/points3D.txt.tmp"));  // where the last file is to be written
  Model changed = SampleModel();
  changed.cameras[0].params[0] = 1;
  EXPECT_EQ(WriteModel(folder.Path("m"), changed, Format::kText).code(), ErrorCode::kUnwritable);
  EXPECT_EQ(folder.Read("m/cameras.txt"), before);
  EXPECT_FALSE(std::filesystem::exists(folder.Path("m/cameras.txt.tmp")));
}

TEST(ColmapModel, WithWhatTheFilesCannotHoldIsRefused) {
  const TestFolder folder;
  Model model = SampleModel();
  model.images[0].name = "a\nb";
  EXPECT_EQ(WriteModel(folder.Path("m"), model, Format::kBinary).code(), ErrorCode::kInvalidArgument);
  model = SampleModel();
  model.cameras[0].params.pop_back();
  EXPECT_EQ(WriteModel(folder.Path("m"), model, Format::kBinary).code(), ErrorCode::kInvalidArgument);
}

TEST(ColmapModel, ThatIsNotThereIsNotFound) {
  const TestFolder folder;
  EXPECT_EQ(ReadModel(folder.Path("nowhere")).status().code(), ErrorCode::kNotFound);
  folder.Write("cameras.txt", kCamerasText);
  folder.Write("points3D.txt", kPointsText);
  const Status status = ReadModel(folder.Path("")).status();
  EXPECT_EQ(status.code(), ErrorCode::kNotFound);
  EXPECT_THAT(status.message(), HasSubstr("images.txt"));
}

struct BadText {
  const char* name;
  const char* file;
  std::string text;
  const char* says;
};

class BadTextModel : public testing::TestWithParam<BadText> {};

TEST_P(BadTextModel, IsRefusedWithTheLine) {
  const TestFolder folder;
  WriteSampleText(folder);
  folder.Write(GetParam().file, GetParam().text);
  const Status status = ReadModel(folder.Path("")).status();
  EXPECT_EQ(status.code(), ErrorCode::kUnreadable);
  EXPECT_THAT(status.message(), HasSubstr(GetParam().file));
  EXPECT_THAT(status.message(), HasSubstr(GetParam().says));
  EXPECT_THAT(status.message(), testing::Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    Of, BadTextModel,
    testing::Values(
        BadText{"CameraModel", "cameras.txt", "1 pinhole 640 480 1 1 1 1\n", ":1: there is no camera model 'pinhole'"},
        BadText{"CameraShort", "cameras.txt", "# c\n1 PINHOLE 640 480 1 1 1\n",
                ":2: there is no parameter 4 of PINHOLE's 4"},
        BadText{"CameraLong", "cameras.txt", "1 PINHOLE 640 480 1 1 1 1 1\n", "more on the line"},
        BadText{"CameraTwice", "cameras.txt", "1 PINHOLE 640 480 1 1 1 1\n1 PINHOLE 640 480 1 1 1 1\n",
                "camera 1 twice"},
        BadText{"NegativeSize", "cameras.txt", "1 PINHOLE -640 480 1 1 1 1\n", "'-640' is no WIDTH"},
        BadText{"ImageId", "images.txt", "4294967296 1 0 0 0 0 0 0 1 a\n\n", "'4294967296' is no IMAGE_ID"},
        BadText{"ImageCut", "images.txt", "1 1 0 0 0 0 0\n", "there is no TZ"},
        BadText{"NoObservations", "images.txt", "1 1 0 0 0 0 0 0 1 a\n2 1 0 0 0 0 0 0 1 b\n\n",
                ":2: 'b' is not a number"},
        BadText{"LastWithoutObservations", "images.txt", "1 1 0 0 0 0 0 0 1 a\n", "of image 1 is missing"},
        BadText{"ObservationCut", "images.txt", "1 1 0 0 0 0 0 0 1 a\n1 2 3 4 5\n", ":2: there is no POINT3D_ID"},
        BadText{"ImageTwice", "images.txt", "1 1 0 0 0 0 0 0 1 a\n\n1 1 0 0 0 0 0 0 1 b\n\n", "image 1 twice"},
        BadText{"PointColor", "points3D.txt", "1 0 0 0 256 0 0 0\n", "'256' is no color"},
        BadText{"PointTrack", "points3D.txt", "1 0 0 0 0 0 0 0 1 0 2\n", "there is no POINT2D_IDX"},
        BadText{"PointNumber", "points3D.txt", "1 0 zero 0 0 0 0 0\n", "'zero' is not a number (Y)"},
        BadText{"PointTwice", "points3D.txt", "1 0 0 0 0 0 0 0\n1 0 0 0 0 0 0 0\n", "point 1 twice"},
        BadText{"Binary", "points3D.txt", std::string("\1\0\0\0\0\0\0\0", 8), ":1: "},
        BadText{"Rig", "rigs.txt", "1 2 CAMERA 1 WHEEL 1 0\n", "'WHEEL' is not a SENSOR_TYPE"},
        BadText{"Frame", "frames.txt", "1 1 1 0 0 0 0 0 0 2 CAMERA 1 1\n", ":1: there is no SENSOR_TYPE"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ColmapModel, EveryTruncationOfItsBinaryFilesIsFound) {
  const TestFolder folder;
  ASSERT_TRUE(WriteModel(folder.Path("m"), SampleModelWithRigs(), Format::kBinary, Rigs::kWritten).ok());
  for (const std::string name : {"cameras", "images", "points3D", "rigs", "frames"}) {
    const std::string file = "m/" + name + ".bin";
    const std::string whole = folder.Read(file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      folder.Write(file, whole.substr(0, size));
      const Status status = ReadModel(folder.Path("m")).status();
      ASSERT_EQ(status.code(), ErrorCode::kUnreadable) << name << " of " << size << " bytes";
      ASSERT_THAT(status.message(), HasSubstr(name + ".bin' is damaged"));
    }
    folder.Write(file, whole + "x");
    EXPECT_THAT(ReadModel(folder.Path("m")).status().message(), HasSubstr("1 bytes follow"));
    folder.Write(file, whole);
  }
  EXPECT_TRUE(ReadModel(folder.Path("m")).ok());
}

TEST(ColmapModel, CountsThatLieTakeNoMemory) {
  const TestFolder folder;
  ASSERT_TRUE(WriteModel(folder.Path("m"), SampleModelWithRigs(), Format::kBinary, Rigs::kWritten).ok());
  for (const std::string name : {"cameras", "images", "points3D", "rigs", "frames"}) {
    const std::string file = "m/" + name + ".bin";
    const std::string whole = folder.Read(file);
    for (const std::uint64_t count : {std::uint64_t{1} << 60, ~std::uint64_t{0}, std::uint64_t{100000}}) {
      std::string lying;
      AppendBytes(&lying, count, 8);
      folder.Write(file, lying + whole.substr(8));
      const Status status = ReadModel(folder.Path("m")).status();
      EXPECT_EQ(status.code(), ErrorCode::kUnreadable);
      EXPECT_THAT(status.message(), HasSubstr("it says that there are " + std::to_string(count)));
    }
    folder.Write(file, whole);
  }
}

TEST(ColmapModel, AnUnknownCameraModelIsNamed) {
  const TestFolder folder;
  ASSERT_TRUE(WriteModel(folder.Path("m"), SampleModel(), Format::kBinary).ok());
  std::string cameras = folder.Read("m/cameras.bin");
  cameras[12] = 99;
  folder.Write("m/cameras.bin", cameras);
  EXPECT_THAT(ReadModel(folder.Path("m")).status().message(), HasSubstr("there is no camera model '99'"));
}

}  // namespace
}  // namespace pliant::colmap
