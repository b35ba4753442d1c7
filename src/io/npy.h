// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// NumPy's arrays of numbers (.npy, format 1 to 3) and archives of them (.npz: a zip file, stored or deflated). Arrays
// are little-endian, as every machine of today writes them.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/status.h"

namespace pliant {

// Whether bytes begin as such a file does.
bool IsNpy(std::string_view bytes);
bool IsZip(std::string_view bytes);

struct NpyArray {
  enum class Kind { kFloat, kInteger, kBool };

  Kind kind = Kind::kFloat;
  std::string type;  // as NumPy writes it: <f4, <f8, |b1, |u1, <i4, ...
  std::vector<std::size_t> shape;
  bool columns_first =
      false;  // as Fortran has them, and the transpose of an array of NumPy's: the first axis varies fastest
  std::string_view data;  // of the file's bytes, exactly as many as type and shape say

  std::size_t size() const;  // numbers in all
  // The i-th number, rows first. Integers beyond 2^53 are rounded.
  double At(std::size_t i) const;
};

// "(120, 512, 2)".
std::string ShapeText(std::span<const std::size_t> shape);

// `name` begins the sentence of a failure: the file, or the file and its array. `bytes` must outlive the result. Fails
// with kUnreadable: cut off, or an array of something else than 4- or 8-byte floats, integers and bools.
Result<NpyArray> ParseNpy(const std::string& name, std::string_view bytes);

// A file of format 1.0, whose numbers begin at a multiple of 64 bytes; `data` are the array's bytes.
std::string NpyBytes(std::string_view type, std::span<const std::size_t> shape, std::string_view data);

// The names of the .npy files in an archive, without .npy; other files are left out. `path` begins the sentence of a
// failure. Fails with kUnreadable: cut off.
Result<std::set<std::string>> NpzNames(const std::string& path, std::string_view bytes);

// Those of these names that are there. No other one is unpacked: an archive may hold a thousand times its own size.
// Fails with kUnreadable: cut off, damaged, encrypted, compressed by something else than deflate, or larger than 4 GB.
Result<std::map<std::string, std::string>> ParseNpz(const std::string& path, std::string_view bytes,
                                                    std::span<const std::string_view> names);

// An archive of .npy files, which are stored as they are (np.savez); the same input gives the same bytes. At most 4 GB
// in all, else the result is empty.
std::string NpzBytes(const std::map<std::string, std::string>& npy_files);

}  // namespace pliant
