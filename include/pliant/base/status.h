// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a call that may fail returns. An expected failure (an unreadable file, too few inliers) is a value: a code for
// the program and one sentence for the person, which says what failed, where, and what to do. A programming error
// asserts.
#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace pliant {

enum class ErrorCode {
  kOk,
  kInvalidArgument,  // an option, a parameter or a request that cannot be met
  kNotFound,         // a file, folder or name that is not there
  kUnreadable,       // there, but it cannot be opened or decoded
  kMismatch,         // two inputs that do not belong together (sizes, counts, frames)
  kUnwritable,       // an output that cannot be written or whose disk is full
  kInsufficient,     // too little data to answer (too few points, too little parallax)
  kDegenerate,       // enough data, but it does not determine the answer (a plane, a pure rotation)
  kInterrupted,      // stopped on request
};

class [[nodiscard]] Status {
 public:
  Status() = default;  // ok
  Status(ErrorCode code, std::string message) : code_(code), message_(std::move(message)) {
    assert(code != ErrorCode::kOk);
  }
  static Status Ok() { return {}; }

  bool ok() const { return code_ == ErrorCode::kOk; }
  ErrorCode code() const { return code_; }
  const std::string& message() const { return message_; }

 private:
  ErrorCode code_ = ErrorCode::kOk;
  std::string message_;
};

// A value, or the reason why there is none. `value()`, `*` and `->` assert that there is one.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}  // NOLINT(google-explicit-constructor): returned as it is
  Result(Status status) : content_(std::move(status)) { assert(!std::get<Status>(content_).ok()); }  // NOLINT
  Result(ErrorCode code, std::string message) : content_(Status(code, std::move(message))) {}

  bool ok() const { return std::holds_alternative<T>(content_); }
  Status status() const { return ok() ? Status::Ok() : std::get<Status>(content_); }

  T& value() & {
    assert(ok());
    return *std::get_if<T>(&content_);
  }
  const T& value() const& {
    assert(ok());
    return *std::get_if<T>(&content_);
  }
  T&& value() && {
    assert(ok());
    return std::move(*std::get_if<T>(&content_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  std::variant<Status, T> content_;
};

}  // namespace pliant
