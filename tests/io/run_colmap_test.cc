// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The model that a run leaves, read once more and independently of the library.
#include <array>
#include <cstring>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "io/run_reports.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using namespace run_reports;

TEST(ColmapModel, OfARunLinksImagesAndPointsBothWays) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  std::istringstream images(folder.Read("run/sparse/images.txt"));
  std::map<int, std::vector<std::array<double, 3>>> keypoints;
  std::string line;
  while (std::getline(images, line)) {
    if (line.starts_with("#")) continue;
    std::istringstream head(line);
    int id = 0;
    int camera = 0;
    std::array<double, 7> pose{};
    std::string name;
    head >> id;
    for (double& value : pose) head >> value;
    head >> camera >> name;
    EXPECT_EQ(camera, 1);
    EXPECT_EQ(name, std::to_string(id - 1) + ".png");
    ASSERT_TRUE(std::getline(images, line));
    EXPECT_FALSE(line.ends_with(' '));
    std::istringstream triples(line);
    for (std::array<double, 3> k{}; triples >> k[0] >> k[1] >> k[2];) keypoints[id].push_back(k);
  }
  ASSERT_EQ(keypoints.size(), 4u);
  const FrameReport second = Report(2);
  ASSERT_EQ(keypoints[second.frame_idx + 1].size(), second.observations.size());
  EXPECT_NEAR(keypoints[second.frame_idx + 1][0][0], second.observations[0].pixel.x() + 0.5, kFilePixel_px);
  EXPECT_NEAR(keypoints[second.frame_idx + 1][0][1], second.observations[0].pixel.y() + 0.5, kFilePixel_px);

  std::istringstream points(folder.Read("run/sparse/points3D.txt"));
  int num_points = 0;
  while (std::getline(points, line)) {
    if (line.starts_with("#")) continue;
    std::istringstream row(line);
    int id = 0;
    std::array<double, 7> rest{};
    row >> id;
    for (double& value : rest) row >> value;
    EXPECT_LT(rest[6], kExactReprojection_px) << "exact observations have no reprojection error";
    int length = 0;
    for (int image = 0, idx = 0; row >> image >> idx; ++length)
      EXPECT_EQ(keypoints.at(image).at(static_cast<std::size_t>(idx))[2], id);
    EXPECT_EQ(length, (id / 3) % 2 == 0 ? 4 : 2);
    ++num_points;
  }
  EXPECT_EQ(num_points, kPoints);
}

class BinaryRows {
 public:
  explicit BinaryRows(std::string bytes) : bytes_(std::move(bytes)) {}
  template <class T>
  T Take() {
    T value{};
    EXPECT_LE(at_ + sizeof(T), bytes_.size());
    if (at_ + sizeof(T) <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string TakeName() {
    std::string name(bytes_.c_str() + at_);
    at_ += name.size() + 1;
    return name;
  }
  bool AtEnd() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

TEST(ColmapModel, HasTheSameInBinary) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  BinaryRows images(folder.Read("run/sparse/images.bin"));
  ASSERT_EQ(images.Take<std::uint64_t>(), 4u);
  for (int i = 1; i < 5; ++i) {
    const FrameReport report = Report(i);
    EXPECT_EQ(images.Take<std::uint32_t>(), static_cast<std::uint32_t>(report.frame_idx + 1));
    EXPECT_EQ(images.Take<double>(), report.cam_from_world->rotation.w());
    for (int k = 0; k < 3; ++k) images.Take<double>();
    EXPECT_EQ(images.Take<double>(), report.cam_from_world->translation.x());
    for (int k = 0; k < 2; ++k) images.Take<double>();
    EXPECT_EQ(images.Take<std::uint32_t>(), 1u);
    EXPECT_EQ(images.TakeName(), report.name);
    ASSERT_EQ(images.Take<std::uint64_t>(), report.observations.size());
    for (const PointObservation& o : report.observations) {
      EXPECT_NEAR(images.Take<double>(), o.pixel.x() + 0.5, kFilePixel_px);
      EXPECT_NEAR(images.Take<double>(), o.pixel.y() + 0.5, kFilePixel_px);
      EXPECT_EQ(images.Take<std::uint64_t>(), static_cast<std::uint64_t>(o.id.value));
    }
  }
  EXPECT_TRUE(images.AtEnd());
  BinaryRows points(folder.Read("run/sparse/points3D.bin"));
  ASSERT_EQ(points.Take<std::uint64_t>(), static_cast<std::uint64_t>(kPoints));
  for (int i = 0; i < kPoints; ++i) {
    EXPECT_EQ(points.Take<std::uint64_t>(), static_cast<std::uint64_t>(3 * i));
    EXPECT_EQ(points.Take<double>(), i - 2);
    for (int k = 0; k < 2; ++k) points.Take<double>();
    EXPECT_EQ(points.Take<std::uint8_t>(), 10);
    for (int k = 0; k < 2; ++k) points.Take<std::uint8_t>();
    EXPECT_LT(points.Take<double>(), kExactReprojection_px);
    const auto length = points.Take<std::uint64_t>();
    EXPECT_EQ(length, i % 2 == 0 ? 4u : 2u);
    for (std::uint64_t k = 0; k < 2 * length; ++k) points.Take<std::uint32_t>();
  }
  EXPECT_TRUE(points.AtEnd());
}

}  // namespace
}  // namespace pliant
