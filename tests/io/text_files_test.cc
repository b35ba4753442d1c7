// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/io/options_file.h"
#include "pliant/io/ply.h"
#include "pliant/io/trajectory.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kHalfStep_s = 5.1e-7;   // half of the sixth decimal, and round-off
constexpr double kHalfSteps_rad = 4e-9;  // half of the ninth decimal of four numbers; an angle is twice that

std::string Fixed(double value, int decimals) {
  std::string text;
  AppendFixed(&text, value, decimals);
  return text;
}

TEST(AppendFixed, RoundsAndKeepsZerosPositive) {
  EXPECT_EQ(Fixed(1.23456789, 4), "1.2346");
  EXPECT_EQ(Fixed(-0.00001, 4), "0.0000");
  EXPECT_EQ(Fixed(-12.5, 3), "-12.500");
  EXPECT_EQ(Fixed(0.999999, 3), "1.000");
  EXPECT_EQ(Fixed(7, 0), "7");
  EXPECT_EQ(Fixed(1e20, 1), "100000000000000000000.0");
}

TEST(OutputFile, SaysThatTheDiskIsFull) {
  auto file = OutputFile::Create("/dev/full");
  ASSERT_TRUE(file.ok());
  const Status status = file->Append("x");
  EXPECT_EQ(status.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(status.message(), HasSubstr("'/dev/full': No space left"));
  EXPECT_EQ(OutputFile::Create("/nowhere/file").status().code(), ErrorCode::kUnwritable);
}

TEST(WriteFileAtomically, WritesIntoAPipeAndLeavesItOne) {
  const TestFolder folder;
  const std::string path = folder.Path("pipe");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const int reader = open(path.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  EXPECT_TRUE(WriteFileAtomically(path, "x").ok());
  EXPECT_TRUE(std::filesystem::is_fifo(path));
  char read_back = 0;
  EXPECT_EQ(read(reader, &read_back, 1), 1);
  EXPECT_EQ(read_back, 'x');
  close(reader);
}

struct TestOptions {
  int levels = 4;
  double sigma = 15;
  std::string name = "a";
  void List(OptionTable& table) {
    table.BeginGroup("Track", "");
    table.Add("levels", &levels, "-", "", 1, 8);
    table.Add("name", &name, "-", "");
    table.BeginGroup("Graph", "");
    table.Add("sigma", &sigma, "mm", "", 0, 100);
  }
};

TEST(OptionsFile, SetsWhatItNamesAndReadsBackWhatATablePrints) {
  const TestFolder folder;
  TestOptions options;
  OptionTable table;
  options.List(table);
  ASSERT_TRUE(LoadOptionsFile(folder.Write("o.yaml", "# none\n"), table).ok());
  ASSERT_TRUE(
      LoadOptionsFile(folder.Write("o.yaml", "Graph:\n  sigma: 55\nTrack:\n  levels: 2\n  name: \"b c\"\n"), table)
          .ok());
  EXPECT_EQ(options.levels, 2);
  EXPECT_EQ(options.sigma, 55);
  EXPECT_EQ(options.name, "b c");
  TestOptions others;
  OptionTable other_table;
  others.List(other_table);
  ASSERT_TRUE(LoadOptionsFile(folder.Write("o.yaml", table.ToYaml()), other_table).ok());
  EXPECT_EQ(other_table.ToYaml(), table.ToYaml());
}

TEST(OptionsFile, RefusesMistakesWithFileAndLineAndChangesNothing) {
  const TestFolder folder;
  TestOptions options;
  OptionTable table;
  options.List(table);
  const std::pair<std::string, const char*> cases[] = {
      {"Track:\n  levels: 2\n  nam: x\n", "o.yaml:3: there is no option 'Track.nam'; did you mean 'Track.name'?"},
      {"Track:\n  levels: 2\nGraph:\n  sigma: 1000\n", "o.yaml:4: Graph.sigma is '1000'"},
      {"Track:\n  levels: 2\n  levels: 3\n", "o.yaml:3: 'levels' is given twice"},
      {"Track:\n  levels: [2, 3]\n", "takes one value"},
      {"levels: 2\n", "o.yaml:1: 'levels' has no group"},
      {"Track: {levels: 2\n", "not YAML"},
      {"Track: {levels: " + std::string(1'000'000, '2') + "}\n", "more than 1 MB"}};
  for (const auto& [text, says] : cases) {
    const Status status = LoadOptionsFile(folder.Write("o.yaml", text), table);
    EXPECT_THAT(status.message(), HasSubstr(says));
    EXPECT_EQ(options.levels, 4);
  }
  EXPECT_EQ(LoadOptionsFile(folder.Path("none.yaml"), table).code(), ErrorCode::kNotFound);
}

TEST(TumTrajectory, ComesBackAsItWasWritten) {
  const TestFolder folder;
  std::vector<TimedPose> poses;
  for (int i = 0; i < 20; ++i)
    poses.push_back({i / 25.0, Rigid3(RotationExp({0.1 * i, -0.2, 0.3}), Eigen::Vector3d(i, -2.5 * i, 1e-3 * i))});
  ASSERT_TRUE(WriteTumTrajectory(folder.Path("t.txt"), poses).ok());
  const auto read = ReadTumTrajectory(folder.Path("t.txt"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR((*read)[i].timestamp_s, poses[i].timestamp_s, kHalfStep_s);
    EXPECT_LT(((*read)[i].world_from_cam.translation - poses[i].world_from_cam.translation).norm(), kFileLength_mm);
    EXPECT_LT((*read)[i].world_from_cam.rotation.angularDistance(poses[i].world_from_cam.rotation), kHalfSteps_rad);
  }
  EXPECT_THAT(folder.Read("t.txt"), testing::Not(testing::ContainsRegex("  | \n")));
}

TEST(TumTrajectory, NamesTheLineThatIsWrong) {
  const TestFolder folder;
  const std::string good = "# t x y z\n0 1 2 3 0 0 0 1\n";
  for (const auto& [line, says] : {std::pair("1 1 2 3 0 0 0", "t.txt:3: a line has 8 numbers"),
                                   std::pair("1 1 2 nan 0 0 0 1", "t.txt:3: 'nan' is not a finite number"),
                                   std::pair("1 1 2 3 0 0 0 2", "the quaternion has length 2"),
                                   std::pair("0 1 2 3 0 0 0 1", "the time is not after")}) {
    const auto read = ReadTumTrajectory(folder.Write("t.txt", good + line + "\n"));
    ASSERT_FALSE(read.ok());
    EXPECT_THAT(read.status().message(), HasSubstr(says));
  }
  EXPECT_EQ(ReadTumTrajectory(folder.Write("t.txt", good + "1 1 2 3 0 0 0 1"))->size(), 2u);
}

TEST(Ply, HasAHeaderThatDescribesItsBytes) {
  const TestFolder folder;
  const std::vector<NewPoint> points = {{PointId{0}, {1, 2, 3}, {255, 0, 7}}, {PointId{4}, {-1.5, 0, 50}, {1, 2, 3}}};
  ASSERT_TRUE(WritePly(folder.Path("map.ply"), points).ok());
  const std::string ply = folder.Read("map.ply");
  const std::string end = "end_header\n";
  EXPECT_EQ(ply.rfind("ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n", 0), 0u);
  const std::size_t data = ply.find(end) + end.size();
  ASSERT_EQ(ply.size() - data, 2u * 15);
  float second_x = 0;
  std::memcpy(&second_x, ply.data() + data + 15, 4);
  EXPECT_EQ(second_x, -1.5F);
  EXPECT_EQ(static_cast<unsigned char>(ply[data + 12]), 255);
}

}  // namespace
}  // namespace pliant
