// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/map.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(Map, FindsALandmarkByIdAndSaysWhenThereIsNone) {
  Map map;
  for (const int id : {1, 4, 9}) map.landmarks.push_back({.id = PointId{id}});
  ASSERT_NE(map.Find(PointId{4}), nullptr);
  EXPECT_EQ(map.Find(PointId{4})->id.value, 4);
  EXPECT_EQ(map.Find(PointId{5}), nullptr);
  EXPECT_EQ(map.Find(PointId{10}), nullptr);
}

}  // namespace
}  // namespace pliant
