// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What holds of every COLMAP file that was read, whatever it said: put together again and read again it is the same.
#pragma once

#include <cstdlib>
#include <span>
#include <string>

#include "colmap/readers.h"
#include "colmap/rows.h"
#include "fuzz_input.h"
#include "pliant/base/status.h"

namespace pliant::colmap {

// `begin` starts a file of so many rows, `append` puts a row behind, `read` reads a file at a path.
template <class Read, class Begin, class Append>
void CheckComesBack(const std::string& path, Read read, Begin begin, Append append) {
  const auto rows = read(path);
  if (!rows.ok()) {
    if (rows.status().message().empty()) std::abort();
    return;
  }
  const auto write = [&](const auto& values) {
    std::string file = begin(values.size());
    for (const auto& value : values) append(value, &file);
    return file;
  };
  const std::string once = write(*rows);
  const auto again = read(WriteFuzzFile("again", {reinterpret_cast<const std::uint8_t*>(once.data()), once.size()}));
  if (!again.ok() || write(*again) != once) std::abort();
}

// `Format` has the readers and writers of one of COLMAP's formats.
template <class Format>
void CheckColmapFile(const std::uint8_t* data, std::size_t size) {
  const FuzzInput input(data, size, 5);
  const std::string path = WriteFuzzFile("file", input.bytes);
  switch (input.choice) {
    case 0:
      return CheckComesBack(path, Format::Cameras, Format::Begin, Format::AppendCamera);
    case 1:
      return CheckComesBack(path, Format::Images, Format::Begin, Format::AppendImage);
    case 2:
      return CheckComesBack(path, Format::Points, Format::Begin, Format::AppendPoint);
    case 3:
      return CheckComesBack(path, Format::Rigs, Format::Begin, Format::AppendRig);
    default:
      return CheckComesBack(path, Format::Frames, Format::Begin, Format::AppendFrame);
  }
}

}  // namespace pliant::colmap
