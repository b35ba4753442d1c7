// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A view as the page takes it (web/README.md, DATA), and the page itself.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "pliant/viewer/view.h"
#include "viewer/view_images.h"

namespace pliant {

inline constexpr int kPageFormat = 1;

// Without images where there are none.
nlohmann::ordered_json PageData(const View& view, const ViewImages& images, const std::string& title);

// The page with these data in it.
std::string PageWith(const nlohmann::ordered_json& data);

}  // namespace pliant
