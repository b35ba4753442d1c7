// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What may be wrong with an image in which nothing can be followed, as a clause for a note.
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "pliant/image/masks.h"
#include "pliant/tracking/prepared_frame.h"

namespace pliant {

// That an image shows nothing where it is usable: it is black, white, or of one color; empty where it shows something.
std::string Blankness(const cv::Mat& gray, const SupportMask& mask);

// What is wrong with an image in which nothing can be followed; empty when nothing is. `previous_gray`: the image
// before.
std::string ImageFault(const PreparedFrame& frame, const cv::Mat& previous_gray);

// "note; fault", or the one that is not empty.
std::string WithFault(const std::string& note, const std::string& fault);

}  // namespace pliant
