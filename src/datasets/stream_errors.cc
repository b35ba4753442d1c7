// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/stream_errors.h"

#include "datasets/image_file.h"
#include "pliant/base/text.h"

namespace pliant {

std::string SourceName(const std::string& source) { return source == "-" ? "standard input" : Quoted(source); }

Status StandardInputIsEmpty() {
  return {ErrorCode::kUnreadable,
          "standard input is closed or empty; pipe a video into the program, and check the one that sends it"};
}

Status CannotBeDecoded(const std::string& source) {
  if (source == "-")
    return {ErrorCode::kUnreadable,
            "standard input is no video that can be decoded, or ends before its first image; pipe one into the "
            "program, as in ffmpeg -i VIDEO -f yuv4mpegpipe - | pliant track -"};
  if (source.starts_with("device:"))
    return {ErrorCode::kUnreadable,
            "the camera " + Quoted(source) + " cannot be read; check that no other program uses it"};
  return {ErrorCode::kUnreadable,
          "the stream " + Quoted(source) + " cannot be opened; check its address, and that it is being sent"};
}

Status EndsWithinFirstImage(const std::string& source) {
  return {ErrorCode::kUnreadable, SourceName(source) + " ends within its first image; check the program that sends it"};
}

Status SentNothing(const std::string& source, double timeout_s) {
  return {ErrorCode::kUnreadable, SourceName(source) + " has sent no image for " + Digits(timeout_s, 0) +
                                      " s; check it, or wait longer with LiveInput.timeout_s"};
}

Status ChangesSize(const std::string& source, cv::Size from, cv::Size to, int images_before) {
  return {ErrorCode::kMismatch, "the images of " + SourceName(source) + " change their size from " +
                                    SizeText(from.width, from.height) + " to " + SizeText(to.width, to.height) +
                                    " after " + std::to_string(images_before) +
                                    " images; bring them all to the size of the calibration before they are sent"};
}

}  // namespace pliant
