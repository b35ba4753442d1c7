// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/stir_error.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRounding = 1e-12;

StirPoints Points(int dimensions, std::map<std::string, std::vector<Eigen::Vector3d>> of_recording) {
  return {dimensions, std::move(of_recording)};
}

// Labels 100 px apart; "a" has them in another order at its end.
const StirPoints& Start() {
  static const StirPoints points = Points(2, {{"a", {{0, 0, 0}, {100, 0, 0}}}, {"b", {{0, 0, 0}}}, {"c", {{7, 7, 0}}}});
  return points;
}
const StirPoints& End() {
  static const StirPoints points =
      Points(2, {{"a", {{110, 0, 0}, {10, 0, 0}}}, {"b", {{0, 70, 0}}}, {"c", {{7, 7, 0}}}});
  return points;
}

TEST(StirError, CountsPointsOfAllRecordingsWithinTheThresholdsOfTheNearestLabel) {
  const StirPoints tracked = Points(2, {{"a", {{14, 0, 0}, {110, 8.5, 0}}}, {"b", {{3, 74, 0}}}});
  const auto error = ComputeStirError(tracked, Start(), End());
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->recordings, 2);
  EXPECT_THAT(error->thresholds, ElementsAre(4, 8, 16, 32, 64));
  EXPECT_EQ(error->estimate.points, 3);
  // Distances 4 (the threshold itself counts), 8.5 and 5.
  EXPECT_THAT(error->estimate.within, ElementsAre(1.0 / 3, 2.0 / 3, 1, 1, 1));
  EXPECT_NEAR(error->estimate.average_within, 4.0 / 5, kRounding);
  EXPECT_NEAR(error->estimate.end_point_error, ((4 + 8.5) / 2 + 5) / 2, kRounding);
  // Nothing moves: 10, 10 and 70.
  EXPECT_EQ(error->null.points, 3);
  EXPECT_THAT(error->null.within, ElementsAre(0, 0, 2.0 / 3, 2.0 / 3, 2.0 / 3));
  EXPECT_NEAR(error->null.end_point_error, (10 + 70) / 2.0, kRounding);
  EXPECT_THAT(StirTable(*error), HasSubstr("points at the end of 2 recordings"));
  EXPECT_THAT(StirJson(*error), HasSubstr("\"unit\": \"px\""));
}

TEST(StirError, InThreeDimensionsTheThresholdsAreMillimeters) {
  const StirPoints start = Points(3, {{"a", {{0, 0, 50}}}});
  const StirPoints end = Points(3, {{"a", {{0, 0, 60}}}});
  const auto error = ComputeStirError(Points(3, {{"a", {{0, 0, 57}}}}), start, end);
  const StirPoints more = Points(3, {{"a", {{0, 0, 57}, {5, 0, 57}}}});  // of a label that has a pixel alone
  EXPECT_TRUE(ComputeStirError(more, start, end).ok());
  EXPECT_EQ(ComputeStirError(start, more, end).status().code(), ErrorCode::kMismatch);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_THAT(error->thresholds, ElementsAre(2, 4, 8, 16, 32));
  EXPECT_THAT(error->estimate.within, ElementsAre(0, 1, 1, 1, 1));
  EXPECT_THAT(error->null.within, ElementsAre(0, 0, 0, 1, 1));
  EXPECT_THAT(StirJson(*error), HasSubstr("\"unit\": \"mm\""));
}

TEST(StirError, SaysWhatDoesNotGoTogether) {
  const auto sentence = [](const StirPoints& tracked, const StirPoints& start, const StirPoints& end) {
    const auto error = ComputeStirError(tracked, start, end);
    return error.ok() ? std::string("nothing") : error.status().message();
  };
  EXPECT_THAT(sentence(Points(2, {{"d", {{0, 0, 0}}}}), Start(), End()),
              HasSubstr("the recording d has tracked points"));
  EXPECT_THAT(sentence(Points(2, {{"a", {{0, 0, 0}}}}), Start(), Points(2, {{"a", {}}})), HasSubstr("at its end"));
  EXPECT_THAT(sentence(Points(2, {{"a", {{0, 0, 0}}}}), Start(), End()),
              HasSubstr("the recording a has 1 tracked points and 2 labelled ones at its start"));
  EXPECT_THAT(sentence(Points(3, {{"a", {{0, 0, 0}}}}), Start(), End()), HasSubstr("have 3 numbers"));
  EXPECT_THAT(sentence(Points(2, {{"a", {}}}), Start(), End()), HasSubstr("no tracked points"));
}

TEST(StirFile, WhatWasWrittenIsRead) {
  const TestFolder folder;
  for (const int dimensions : {2, 3}) {
    const StirPoints points = Points(
        dimensions, {{"/data/0/left/seq00", {{160.25, 604, dimensions == 3 ? 61.5 : 0}, {0.1, -2, 0}}}, {"empty", {}}});
    ASSERT_TRUE(WriteStirPoints(points, folder.Path("points.json")).ok());
    const auto read = ReadStirPoints(folder.Path("points.json"));
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->dimensions, dimensions);
    EXPECT_EQ(read->of_recording, points.of_recording);
  }
}

TEST(StirFile, SaysWhatIsWrongInOneSentence) {
  const TestFolder folder;
  for (const auto& [text, says] :
       {std::pair("[[1, 2]]", "is not a JSON object"), std::pair("{\"a\": [[1, 2]", "is not a JSON object"),
        std::pair("{\"a\": 5}", "has no list of points for the recording a"),
        std::pair("{\"a\": [[1]]}", "not two or three finite numbers"),
        std::pair("{\"a\": [[1, \"x\"]]}", "not two or three finite numbers"),
        std::pair("{\"a\": [[1, NaN]]}", "is not a JSON object"),
        std::pair("{\"a\": [[1, 2]], \"b\": [[1, 2, 3]]}", "points of two and of three numbers")}) {
    std::ofstream(folder.Path("points.json")) << text;
    const auto read = ReadStirPoints(folder.Path("points.json"));
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_EQ(read.status().code(), ErrorCode::kUnreadable);
    EXPECT_THAT(read.status().message(), HasSubstr(says));
  }
  EXPECT_EQ(ReadStirPoints(folder.Path("none.json")).status().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace pliant
