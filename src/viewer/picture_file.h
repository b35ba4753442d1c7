// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One page that is drawn by cairo, as a file.
#pragma once

#include <functional>
#include <string>

#include <cairo.h>

#include "pliant/base/status.h"

namespace pliant {

// A white page of this size in points of 1/72 inch (png: pixels), drawn on by `draw`; the ending of `output_path` says
// what is written: .png, .svg or .pdf, without a date. Fails as `draw` does, with kInvalidArgument for a page that
// cairo cannot hold, and with kUnwritable.
Status WritePicture(const std::string& output_path, double width, double height,
                    const std::function<Status(cairo_t*)>& draw);

}  // namespace pliant
