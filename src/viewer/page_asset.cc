// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/page_asset.h"

#include <cstddef>

extern "C" {
extern const char pliant_page_begin[];  // page_asset.S
extern const char pliant_page_end[];
}

namespace pliant {

std::string_view PageAsset() {
  return {pliant_page_begin, static_cast<std::size_t>(pliant_page_end - pliant_page_begin)};
}

Status CheckPageAsset() {
  if (!PageAsset().empty()) return Status::Ok();
  return {ErrorCode::kNotFound,
          "this build of Pliant has no report page and no live view (it was configured with PLIANT_BUILD_VIEWER=OFF)"};
}

}  // namespace pliant
