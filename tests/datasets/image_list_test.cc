// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/image_list.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace pliant {
namespace {

TEST(NaturalLess, ComparesNumbersAsNumbers) {
  EXPECT_TRUE(NaturalLess("frame2.png", "frame10.png"));
  EXPECT_TRUE(NaturalLess("a2b3", "a2b10"));
  EXPECT_TRUE(NaturalLess("a", "a1"));
  EXPECT_TRUE(NaturalLess("9", "10000000000000000000000000"));
  EXPECT_FALSE(NaturalLess("x1", "x1"));
  EXPECT_NE(NaturalLess("x01", "x1"), NaturalLess("x1", "x01"));
}

TEST(ListImages, RefusesNamesThatDoNotFitIntoALine) {
  const TemporaryFolder folder("images");
  for (const char* name : {"a.png", "b\nc.png"}) std::ofstream(folder.Path(name)) << "x";
  const auto images = ListImages(folder.Path(""));
  ASSERT_FALSE(images.ok());
  EXPECT_NE(images.status().message().find("a line break"), std::string::npos) << images.status().message();
  std::filesystem::remove(folder.Path("b\nc.png"));
  EXPECT_TRUE(ListImages(folder.Path("")).ok());
}

TEST(ListImages, RefusesNamesThatAreNotUtf8) {
  const TemporaryFolder folder("images");
  for (const char* name : {"a.png", "b\xE4ld.png"}) std::ofstream(folder.Path(name)) << "x";
  const auto images = ListImages(folder.Path(""));
  ASSERT_FALSE(images.ok());
  EXPECT_NE(images.status().message().find("is not UTF-8; rename it"), std::string::npos) << images.status().message();
}

}  // namespace
}  // namespace pliant
