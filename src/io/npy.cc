// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/npy.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr std::size_t kNpyPreamble = 10;  // magic, version, length of the header

template <class Number>
double NumberAt(std::string_view bytes, std::size_t offset) {
  Number value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return static_cast<double>(value);
}

struct NpyType {
  std::string_view name;
  NpyArray::Kind kind;
  std::size_t width;
  double (*at)(std::string_view bytes, std::size_t offset);
};

constexpr std::array kNpyTypes = {
    NpyType{"<f4", NpyArray::Kind::kFloat, 4, NumberAt<float>},
    NpyType{"<f8", NpyArray::Kind::kFloat, 8, NumberAt<double>},
    NpyType{"|b1", NpyArray::Kind::kBool, 1, NumberAt<std::uint8_t>},
    NpyType{"|u1", NpyArray::Kind::kInteger, 1, NumberAt<std::uint8_t>},
    NpyType{"|i1", NpyArray::Kind::kInteger, 1, NumberAt<std::int8_t>},
    NpyType{"<u2", NpyArray::Kind::kInteger, 2, NumberAt<std::uint16_t>},
    NpyType{"<i2", NpyArray::Kind::kInteger, 2, NumberAt<std::int16_t>},
    NpyType{"<u4", NpyArray::Kind::kInteger, 4, NumberAt<std::uint32_t>},
    NpyType{"<i4", NpyArray::Kind::kInteger, 4, NumberAt<std::int32_t>},
    NpyType{"<u8", NpyArray::Kind::kInteger, 8, NumberAt<std::uint64_t>},
    NpyType{"<i8", NpyArray::Kind::kInteger, 8, NumberAt<std::int64_t>},
};

const NpyType* FindType(std::string_view name) {
  const auto* const found = std::ranges::find(kNpyTypes, name, &NpyType::name);
  return found == kNpyTypes.end() ? nullptr : found;
}

Status NpyError(const std::string& name, const std::string& what) {
  return {ErrorCode::kUnreadable, name + " " + what};
}

// The text between `begin` and `end` that follows `key` in a header, which is a Python dict.
std::string HeaderEntry(const std::string& header, const std::string& key, char begin, char end) {
  const std::size_t at = header.find("'" + key + "'");
  if (at == std::string::npos) return {};
  const std::size_t first = header.find(begin, header.find(':', at));
  const std::size_t last = header.find(end, first + 1);
  if (first == std::string::npos || last == std::string::npos) return {};
  return header.substr(first + 1, last - first - 1);
}

std::optional<std::vector<std::size_t>> ShapeOf(const std::string& text) {
  std::vector<std::size_t> shape;
  for (const std::string_view word : Words(text)) {
    std::uint64_t size = 0;
    if (!ParseUint64(word, &size)) return std::nullopt;
    shape.push_back(size);
  }
  return shape;
}

std::string WrongType(const std::string& type) {
  if (type.empty() || type == "|O") return "holds Python objects instead of numbers; save an array of np.float32";
  if (type.starts_with('>')) return "is big-endian (" + type + "); save it with .astype(np.float32)";
  return "has numbers of the type " + type + ", which are not read; save it with .astype(np.float32)";
}

// Of the file's bytes: the header, and where it ends; nothing where it is cut off.
std::optional<std::string> HeaderOf(std::string_view bytes, std::size_t* end) {
  if (bytes.size() < kNpyPreamble) return std::nullopt;
  const bool is_long = static_cast<unsigned char>(bytes[kNpyMagic.size()]) > 1;
  const std::size_t begin = is_long ? kNpyPreamble + 2 : kNpyPreamble;
  if (bytes.size() < begin) return std::nullopt;
  const auto length =
      static_cast<std::size_t>(is_long ? NumberAt<std::uint32_t>(bytes, 8) : NumberAt<std::uint16_t>(bytes, 8));
  if (bytes.size() - begin < length) return std::nullopt;
  *end = begin + length;
  return std::string(bytes.substr(begin, length));
}

}  // namespace

bool IsNpy(std::string_view bytes) { return bytes.starts_with(kNpyMagic); }

std::size_t NpyArray::size() const {
  const NpyType* known = FindType(type);
  return known == nullptr ? 0 : data.size() / known->width;
}

double NpyArray::At(std::size_t i) const {
  const NpyType* known = FindType(type);
  if (columns_first) {
    std::size_t place = 0;
    std::size_t count = size();
    for (auto axis = shape.rbegin(); axis != shape.rend(); ++axis) {
      count /= *axis;
      place += i % *axis * count;
      i /= *axis;
    }
    i = place;
  }
  return known->at(data, i * known->width);
}

std::string ShapeText(std::span<const std::size_t> shape) {
  std::string text = "(";
  for (const std::size_t size : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(size);
  return text + (shape.size() == 1 ? ",)" : ")");
}

Result<NpyArray> ParseNpy(const std::string& name, std::string_view bytes) {
  if (!IsNpy(bytes)) return NpyError(name, "is not an array of NumPy");
  std::size_t end = 0;
  const auto header = HeaderOf(bytes, &end);
  if (!header) return NpyError(name, "is cut off");
  NpyArray array;
  array.type = HeaderEntry(*header, "descr", '\'', '\'');
  const NpyType* type = FindType(array.type);
  if (type == nullptr) return NpyError(name, WrongType(array.type));
  array.kind = type->kind;
  array.columns_first = header->find("'fortran_order': True") != std::string::npos;
  const auto shape = ShapeOf(HeaderEntry(*header, "shape", '(', ')'));
  if (!shape) return NpyError(name, "has a header that is damaged");
  array.shape = *shape;
  array.data = bytes.substr(end);
  std::size_t count = 1;
  for (const std::size_t size : array.shape) {
    if (size != 0 && count > std::numeric_limits<std::size_t>::max() / 16 / size)
      return NpyError(name, "has a header that is damaged: " + ShapeText(array.shape));
    count *= size;
  }
  if (array.data.size() / type->width < count)
    return NpyError(name, "is cut off: its header says " + ShapeText(array.shape) + " numbers");
  array.data = array.data.substr(0, count * type->width);
  return array;
}

std::string NpyBytes(std::string_view type, std::span<const std::size_t> shape, std::string_view data) {
  std::string header =
      "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': " + ShapeText(shape) + ", }";
  header.append(63 - (kNpyPreamble + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes(kNpyMagic);
  AppendBytes(&bytes, 1, 1);
  AppendBytes(&bytes, 0, 1);
  AppendBytes(&bytes, header.size(), 2);
  bytes += header;
  bytes += data;
  return bytes;
}

}  // namespace pliant
