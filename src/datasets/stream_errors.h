// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is said of a live source that gives no further image.
#pragma once

#include <string>

#include <opencv2/core/types.hpp>

#include "pliant/base/status.h"

namespace pliant {

// "standard input", or the address in quotes.
std::string SourceName(const std::string& source);

// kUnreadable.
Status StandardInputIsEmpty();
Status CannotBeDecoded(const std::string& source);
Status EndsWithinFirstImage(const std::string& source);
Status SentNothing(const std::string& source, double timeout_s);
// kMismatch.
Status ChangesSize(const std::string& source, cv::Size from, cv::Size to, int images_before);

}  // namespace pliant
