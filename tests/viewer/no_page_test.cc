// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/page_asset.h"

namespace pliant {
namespace {

TEST(NoPage, ABuildWithoutThePageSaysSo) {
  EXPECT_TRUE(PageAsset().empty());
  const Status status = CheckPageAsset();
  EXPECT_EQ(status.code(), ErrorCode::kNotFound);
  EXPECT_THAT(status.message(), testing::HasSubstr("PLIANT_BUILD_VIEWER=OFF"));
}

}  // namespace
}  // namespace pliant
