// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/point_cloud.h"

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class Number>
std::string Bytes(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

// As NumPy 1.0 writes it.
std::string Npy(const std::string& type, const std::string& shape, const std::string& data) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  header.resize(118, ' ');
  header.back() = '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + Bytes<std::uint16_t>({118}) + header + data;
}

std::string Ply(const std::string& format, const std::string& data, int vertices = 2) {
  return "ply\nformat " + format + " 1.0\ncomment a cloud\nelement vertex " + std::to_string(vertices) +
         "\nproperty uchar red\nproperty float x\nproperty float y\nproperty double z\nelement face 0\nproperty list "
         "uchar int vertex_indices\nend_header\n" +
         data;
}

const Eigen::Vector3d kFirst(1, 2, 3);
const Eigen::Vector3d kSecond(-0.5, 4, 100);

std::string PlyRow(const Eigen::Vector3d& point) {
  return std::string(1, '\x7f') + Bytes<float>({static_cast<float>(point.x()), static_cast<float>(point.y())}) +
         Bytes<double>({point.z()});
}

TEST(PointCloud, OfEveryFormatIsRead) {
  const TestFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::string& path :
       {folder.Write("f4.npy", Npy("<f4", "3, 3", Bytes<float>({1, 2, 3, nan, 0, 0, -0.5F, 4, 100}))),
        folder.Write("f8.npy", Npy("<f8", "2, 4", Bytes<double>({1, 2, 3, 9, -0.5, 4, 100, 9}))),
        folder.Write("binary.ply", Ply("binary_little_endian", PlyRow(kFirst) + PlyRow(kSecond))),
        folder.Write("ascii.ply", Ply("ascii", "255 1 2 3\r\n0 -0.5 4 1e2\n")),
        folder.Write("points.xyz", "# x y z\n1 2 3 0.5\n\n-0.5\t4 100\n"),
        folder.Write("points.csv", "1,2,3\n-0.5,4,100\n")}) {
    const auto points = ReadPointCloud(path);
    ASSERT_TRUE(points.ok()) << points.status().message();
    EXPECT_THAT(*points, ElementsAre(kFirst, kSecond)) << path;
  }
}

struct Damaged {
  std::string label, name, bytes, says;
  ErrorCode code = ErrorCode::kUnreadable;
};

class DamagedCloud : public testing::TestWithParam<Damaged> {};

TEST_P(DamagedCloud, IsRefusedWithItsReason) {
  const TestFolder folder;
  const auto points = ReadPointCloud(folder.Write(GetParam().name, GetParam().bytes));
  ASSERT_FALSE(points.ok());
  EXPECT_EQ(points.status().code(), GetParam().code) << points.status().message();
  EXPECT_THAT(points.status().message(), HasSubstr(GetParam().says));
  EXPECT_THAT(points.status().message(), HasSubstr(GetParam().name));
}

INSTANTIATE_TEST_SUITE_P(
    PointCloud, DamagedCloud,
    testing::Values(
        Damaged{"CutNpy", "a.npy", Npy("<f4", "3, 3", Bytes<float>({1, 2, 3})), "is cut off"},
        Damaged{"HeadOnly", "a.npy", "\x93NUMPY", "is cut off"},
        Damaged{"Integers", "a.npy", Npy("<i4", "1, 3", Bytes<int>({1, 2, 3})), "not an array of N x 3 floats"},
        Damaged{"TwoColumns", "a.npy", Npy("<f4", "1, 2", Bytes<float>({1, 2})), "not an array of N x 3 floats"},
        Damaged{"Absurd", "a.npy", Npy("<f8", "999999999, 3", ""), "is cut off"},
        Damaged{"NoNumberOfColumns", "a.npy", Npy("<f4", "2, nan", ""), "has a header that is damaged"},
        Damaged{"NoNumberOfVertices", "a.ply", "ply\nformat ascii 1.0\nelement vertex nan\nend_header\n",
                "no valid number of vertices"},
        Damaged{"NotWhatItSays", "a.npy", "hello", "is not what its name says"},
        Damaged{"CutPly", "a.ply", Ply("binary_little_endian", PlyRow(kFirst)), "is cut off"},
        Damaged{"BigEndian", "a.ply", Ply("binary_big_endian", ""), "write it little-endian"},
        Damaged{"NoHeaderEnd", "a.ply", "ply\nformat ascii 1.0\n", "without the end of its header"},
        Damaged{"NoZ", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                "has no x, y and z"},
        Damaged{"Letters", "a.ply", Ply("ascii", "1 a b c\n1 2 3 4\n"), "not written as numbers"},
        Damaged{"TwoNumbers", "a.xyz", "1 2 3\n1 2\n", ":2: a point has three numbers"},
        Damaged{"Empty", "a.xyz", "", "has no point", ErrorCode::kInsufficient}),
    [](const auto& test) { return test.param.label; });

TEST(PointCloud, ThatIsNotThereIsNotFound) {
  EXPECT_EQ(ReadPointCloud("nowhere/cloud.ply").status().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace pliant
