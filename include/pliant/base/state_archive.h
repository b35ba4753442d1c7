// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The state of a program as bytes, to go on with it in another process: bit for bit, for the same build on the same
// kind of machine. One archive either writes or reads, and the same code does both:
//
//   void Serialize(StateArchive& archive, Landmark& landmark) { archive.Members<12>(landmark); }
//   void Candidates::Serialize(StateArchive& archive) { archive(points_); }
//
// A type is serialized by its member function Serialize, else by a function of that name in namespace pliant, else it
// is one of those below.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace pliant {

class StateArchive {
 public:
  StateArchive() = default;  // writes
  // Reads what another one wrote.
  static StateArchive Reading(std::string bytes);

  bool reads() const { return reads_; }
  // False once there was less to read than was asked for, or it cannot be: what was read since is as good as any.
  bool ok() const { return ok_; }
  void Fail() { ok_ = false; }
  // Nothing is left to read.
  bool AtEnd() const { return at_ == bytes_.size(); }
  // What was written.
  const std::string& bytes() const { return bytes_; }

  // Writes these values, or reads them, in this order.
  template <class... Values>
  void operator()(Values&... values) {
    (Transfer(values), ...);
  }
  // All members of a struct without bases, of which there are so many: another number does not compile.
  template <std::size_t kCount, class Struct>
  void Members(Struct& value) {
    std::apply([this](auto&... members) { (this->Transfer(members), ...); }, Tied<kCount>(value));
  }
  // `size` bytes that lie in a row.
  void Bytes(void* data, std::size_t size);
  // How many elements follow: writes `size`, or reads it and checks that at least as many bytes are left.
  std::size_t Size(std::size_t size);
  // While reading: fails where less than `count` times `size` bytes are left.
  void CheckLeft(std::size_t count, std::size_t size);

 private:
  template <class T>
  static constexpr bool kIsPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

  template <class T>
  void Transfer(T& value) {
    if constexpr (requires { value.Serialize(*this); })
      value.Serialize(*this);
    else if constexpr (requires { Serialize(*this, value); })
      Serialize(*this, value);
    else
      TransferKnown(value);
  }

  template <class T>
  requires kIsPlain<T>
  void TransferKnown(T& value) { Bytes(&value, sizeof value); }
  // Of Eigen, of a fixed size.
  template <class T>
  requires(T::SizeAtCompileTime > 0) void TransferKnown(T& matrix) {
    Bytes(matrix.data(), static_cast<std::size_t>(T::SizeAtCompileTime) * sizeof(typename T::Scalar));
  }
  template <class T>
  requires requires(T& quaternion) { quaternion.coeffs().data(); }
  void TransferKnown(T& quaternion) { Transfer(quaternion.coeffs()); }
  void TransferKnown(std::string& text) {
    text.resize(Size(text.size()));
    Bytes(text.data(), text.size());
  }
  template <class T>
  void TransferKnown(std::vector<T>& values) {
    values.resize(Size(values.size()));
    if constexpr (kIsPlain<T>)
      Bytes(values.data(), values.size() * sizeof(T));
    else
      for (T& value : values) Transfer(value);
  }
  template <class T, std::size_t kSize>
  void TransferKnown(std::array<T, kSize>& values) {
    for (T& value : values) Transfer(value);
  }
  template <class First, class Second>
  void TransferKnown(std::pair<First, Second>& pair) {
    Transfer(pair.first);
    Transfer(pair.second);
  }
  template <class T>
  void TransferKnown(std::optional<T>& value) {
    bool is_there = value.has_value();
    Transfer(is_there);
    if (reads_) value = is_there ? std::optional<T>(std::in_place) : std::nullopt;
    if (value) Transfer(*value);
  }
  template <class Key, class T>
  void TransferKnown(std::map<Key, T>& values) {
    const std::size_t size = Size(values.size());
    if (!reads_) {
      for (auto& [key, value] : values) {
        Key copy = key;
        Transfer(copy);
        Transfer(value);
      }
      return;
    }
    values.clear();
    for (std::size_t k = 0; k < size && ok_; ++k) {
      Key key{};
      Transfer(key);
      Transfer(values[key]);
    }
  }

  template <std::size_t kCount, class Struct>
  static auto Tied(Struct& s);

  bool reads_ = false;
  bool ok_ = true;
  std::string bytes_;
  std::size_t at_ = 0;
};

template <std::size_t kCount, class Struct>
auto StateArchive::Tied(Struct& s) {
  static_assert(kCount >= 1 && kCount <= 15);
  if constexpr (kCount == 1) {
    auto& [a] = s;
    return std::tie(a);
  } else if constexpr (kCount == 2) {
    auto& [a, b] = s;
    return std::tie(a, b);
  } else if constexpr (kCount == 3) {
    auto& [a, b, c] = s;
    return std::tie(a, b, c);
  } else if constexpr (kCount == 4) {
    auto& [a, b, c, d] = s;
    return std::tie(a, b, c, d);
  } else if constexpr (kCount == 5) {
    auto& [a, b, c, d, e] = s;
    return std::tie(a, b, c, d, e);
  } else if constexpr (kCount == 6) {
    auto& [a, b, c, d, e, f] = s;
    return std::tie(a, b, c, d, e, f);
  } else if constexpr (kCount == 7) {
    auto& [a, b, c, d, e, f, g] = s;
    return std::tie(a, b, c, d, e, f, g);
  } else if constexpr (kCount == 8) {
    auto& [a, b, c, d, e, f, g, h] = s;
    return std::tie(a, b, c, d, e, f, g, h);
  } else if constexpr (kCount == 9) {
    auto& [a, b, c, d, e, f, g, h, i] = s;
    return std::tie(a, b, c, d, e, f, g, h, i);
  } else if constexpr (kCount == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (kCount == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (kCount == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (kCount == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (kCount == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  } else {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
  }
}

}  // namespace pliant
