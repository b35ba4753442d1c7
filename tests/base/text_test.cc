// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/text.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(ParseNumbers, ReadsWhatCommasBlanksSemicolonsAndBracketsSeparate) {
  const std::vector<double> expected = {1, 2.5, -3};
  for (const char* text : {"1,2.5,-3", "1, 2.5, -3", "[1; 2.5; -3]", " +1\t2.5\n-3 "})
    EXPECT_EQ(ParseNumbers(text).value_or(std::vector<double>()), expected) << text;
}

TEST(ParseNumbers, RefusesWhatIsNoFiniteNumber) {
  for (const char* text : {"1,two", "1,2px", "nan", "1e999"}) EXPECT_FALSE(ParseNumbers(text)) << text;
  EXPECT_EQ(ParseNumbers("")->size(), 0U);
}

}  // namespace
}  // namespace pliant
