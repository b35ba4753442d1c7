// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// NumPy's files as NumPy writes them, made by hand: what a reader of them has to read.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <zlib.h>

namespace pliant {

template <class Number>
std::string BytesOf(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  if (!numbers.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

// An array of NumPy 1.0; `shape` as in "3, 2" or "3,".
inline std::string NpyFile(const std::string& type, const std::string& shape, const std::string& data,
                           const std::string& fortran_order = "False") {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + fortran_order + ", 'shape': (" + shape + "), }";
  header.resize(118, ' ');
  header.back() = '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + BytesOf<std::uint16_t>({118}) + header + data;
}

enum class ZipMethod { kStored, kDeflated };

inline std::string Deflated(const std::string& content) {
  z_stream stream = {};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, content.size()), '\0');
  std::string input = content;
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

// With a field of 20 bytes in the local headers, as zipfile writes it for files that may become large.
inline std::string ZipFile(const std::vector<std::pair<std::string, std::string>>& files, ZipMethod method) {
  const auto u16 = [](std::size_t n) { return BytesOf<std::uint16_t>({static_cast<std::uint16_t>(n)}); };
  const auto u32 = [](std::size_t n) { return BytesOf<std::uint32_t>({static_cast<std::uint32_t>(n)}); };
  std::string bytes;
  std::string central;
  for (const auto& [name, content] : files) {
    const std::string packed = method == ZipMethod::kDeflated ? Deflated(content) : content;
    const std::string common = u16(20) + u16(0) + u16(method == ZipMethod::kDeflated ? 8 : 0) + u32(0x210000) +
                               u32(crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
    central += "PK\x01\x02" + u16(20) + common + u32(packed.size()) + u32(content.size()) + u16(name.size()) +
               std::string(12, '\0') + u32(bytes.size()) + name;
    bytes += "PK\x03\x04" + common + u32(0xffffffff) + u32(0xffffffff) + u16(name.size()) + u16(20) + name +
             std::string(20, '\0') + packed;
  }
  return bytes + central + "PK\x05\x06" + std::string(4, '\0') + u16(files.size()) + u16(files.size()) +
         u32(central.size()) + u32(bytes.size()) + u16(0);
}

}  // namespace pliant
