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

TEST(IsUtf8, TakesCharactersOfOneToFourBytes) {
  for (const char* text : {"", "frame 01.png", "f\xC3\xA4lle", "\xE2\x82\xAC", "\xF0\x9F\x98\x80", "\xED\x9F\xBF",
                           "\xEE\x80\x80", "\xF4\x8F\xBF\xBF"})
    EXPECT_TRUE(IsUtf8(text)) << text;
}

TEST(IsUtf8, RefusesOtherBytes) {
  const std::vector<const char*> texts = {
      "f\xE4lle",  // ISO 8859-1
      "a\x80",
      "\xC3",
      "\xE2\x82",
      "\xC3(",  // without a first or a following byte
      "\xC0\xAF",
      "\xE0\x80\xAF",
      "\xF0\x80\x80\xAF",  // not the shortest form
      "\xED\xA0\x80",
      "\xED\xBF\xBF",  // surrogates
      "\xF4\x90\x80\x80",
      "\xF8\x88\x80\x80\x80",  // beyond U+10FFFF
  };
  for (const char* text : texts) EXPECT_FALSE(IsUtf8(text)) << text;
}

}  // namespace
}  // namespace pliant
