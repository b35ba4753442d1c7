// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A Status as a Python exception: ValueError for what the caller asked wrongly (kInvalidArgument), else pliant.Error
// with the name of the code. The message is the Status's sentence, in which arguments and
// options have no dashes. The GIL has to be held.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pliant/base/status.h"

namespace pliant::python {

[[noreturn]] void Raise(const Status& status);

// ValueError, TypeError.
[[noreturn]] void RaiseValueError(const std::string& sentence);
[[noreturn]] void RaiseTypeError(const std::string& sentence);

// A UserWarning each, of the caller of the package's function.
void Warn(const std::vector<std::string>& sentences);

inline void RaiseUnlessOk(const Status& status) {
  if (!status.ok()) Raise(status);
}

template <class T>
T ValueOf(Result<T> result) {
  if (!result.ok()) Raise(result.status());
  return *std::move(result);
}

}  // namespace pliant::python
