// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What holds of every COLMAP file that was read, whatever it said: put together again and read again it is the same.
#pragma once

#include <cstdlib>
#include <span>
#include <string>

#include "fuzz_input.h"
#include "pliant/base/status.h"

namespace pliant::colmap {

// `write` puts a whole file together, header and rows; `read` reads a file at a path.
template <class Rows, class Write, class Read>
void CheckComesBack(const Result<Rows>& rows, Write write, Read read) {
  if (!rows.ok()) {
    if (rows.status().message().empty()) std::abort();
    return;
  }
  const std::string once = write(*rows);
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(once.data()), once.size());
  const Result<Rows> again = read(WriteFuzzFile("again", bytes));
  if (!again.ok() || write(*again) != once) std::abort();
}

}  // namespace pliant::colmap
