// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/state_archive.h"

#include <limits>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace pliant {
namespace {

enum class Fruit { kApple, kPear };

struct Basket {
  std::string name;
  std::vector<double> weights;
  std::map<int, std::string> labels;
  std::optional<Fruit> best;
  std::array<std::uint8_t, 3> rgb{};
  std::pair<int, bool> count;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
  std::vector<std::string> words;

  void Serialize(StateArchive& archive) { archive.Members<9>(*this); }
};

Basket Full() {
  return {"basket",
          {1.5, -0.0, std::numeric_limits<double>::infinity()},
          {{3, "three"}, {-1, ""}},
          Fruit::kPear,
          {1, 2, 255},
          {7, true},
          {1, 2, 3},
          Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5),
          {"a", "", "bc"}};
}

TEST(StateArchive, ReadsWhatItWrote) {
  Basket written = Full();
  int last = 42;
  StateArchive out;
  out(written, last);
  StateArchive in = StateArchive::Reading(out.bytes());
  Basket read;
  read.labels[9] = "goes";
  read.words.assign(10, "too");
  int number = 0;
  in(read, number);
  ASSERT_TRUE(in.ok());
  EXPECT_TRUE(in.AtEnd());
  EXPECT_EQ(read.name, written.name);
  EXPECT_EQ(read.weights, written.weights);
  EXPECT_TRUE(std::signbit(read.weights[1]));
  EXPECT_EQ(read.labels, written.labels);
  EXPECT_EQ(read.best, written.best);
  EXPECT_EQ(read.rgb, written.rgb);
  EXPECT_EQ(read.count, written.count);
  EXPECT_EQ(read.at, written.at);
  EXPECT_EQ(read.turned.coeffs(), written.turned.coeffs());
  EXPECT_EQ(read.words, written.words);
  EXPECT_EQ(number, last);
}

TEST(StateArchive, AnOptionalValueMayBeMissing) {
  Basket written = Full();
  written.best.reset();
  StateArchive out;
  out(written);
  StateArchive in = StateArchive::Reading(out.bytes());
  Basket read = Full();
  in(read);
  EXPECT_FALSE(read.best.has_value());
}

// Whatever is read: no crash, no endless memory, and ok() says so where bytes are missing.
TEST(StateArchive, NoticesThatBytesAreMissing) {
  Basket written = Full();
  StateArchive out;
  out(written);
  for (std::size_t size = 0; size < out.bytes().size(); ++size) {
    StateArchive in = StateArchive::Reading(out.bytes().substr(0, size));
    Basket read;
    in(read);
    EXPECT_FALSE(in.ok()) << size;
  }
}

TEST(StateArchive, DoesNotBelieveASizeThatCannotBe) {
  std::uint64_t size = std::numeric_limits<std::uint64_t>::max() / 16;
  StateArchive out;
  out(size);
  StateArchive in = StateArchive::Reading(out.bytes());
  std::vector<double> values;
  in(values);
  EXPECT_FALSE(in.ok());
  EXPECT_TRUE(values.empty());
}

}  // namespace
}  // namespace pliant
