// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/errors.h"

#include <cctype>
#include <cstddef>
#include <string_view>

#include <pybind11/pybind11.h>

#include "python/bind.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

// Borrowed from the module, which lives as long as the process.
PyObject* error_class = nullptr;

const char* CodeName(ErrorCode code) {
  switch (code) {
    case ErrorCode::kOk:
      return "ok";
    case ErrorCode::kInvalidArgument:
      return "invalid_argument";
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kUnreadable:
      return "unreadable";
    case ErrorCode::kMismatch:
      return "mismatch";
    case ErrorCode::kUnwritable:
      return "unwritable";
    case ErrorCode::kInsufficient:
      return "insufficient";
    case ErrorCode::kDegenerate:
      return "degenerate";
    case ErrorCode::kInterrupted:
      return "interrupted";
  }
  return "unknown";
}

// Arguments and options as Python has them: the sentences are also the program's, where these are flags ("--sequence").
std::string WithoutDashes(std::string_view sentence) {
  std::string text;
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    const bool begins_word = i == 0 || sentence[i - 1] == ' ' || sentence[i - 1] == '(';
    const bool is_flag = begins_word && sentence.substr(i).starts_with("--") && i + 2 < sentence.size() &&
                         std::isalpha(static_cast<unsigned char>(sentence[i + 2])) != 0;
    if (is_flag) i += 2;
    text += sentence[i];
  }
  return text;
}

}  // namespace

void BindErrors(py::module_& module) {
  error_class = PyErr_NewExceptionWithDoc(
      "pliant.Error",
      "What the library could not do, in one sentence: what failed, where, and what to do.\n\n"
      "Attributes:\n"
      "    code (str): not_found, unreadable, mismatch, unwritable, insufficient, degenerate or interrupted.\n\n"
      "Options and arguments that cannot be met are a ValueError instead.",
      PyExc_RuntimeError, nullptr);
  if (error_class == nullptr) throw py::error_already_set();
  module.add_object("Error", error_class);
}

void Raise(const Status& status) {
  const std::string sentence = WithoutDashes(status.message());
  if (status.code() == ErrorCode::kInvalidArgument) RaiseValueError(sentence);
  py::object error = py::reinterpret_borrow<py::object>(error_class)(sentence);
  error.attr("code") = CodeName(status.code());
  PyErr_SetObject(error_class, error.ptr());
  throw py::error_already_set();
}

void Warn(const std::vector<std::string>& sentences) {
  constexpr int kCallerOfPackage = 2;  // 1 is the package's own function
  for (const std::string& sentence : sentences)
    if (PyErr_WarnEx(PyExc_UserWarning, WithoutDashes(sentence).c_str(), kCallerOfPackage) != 0)
      throw py::error_already_set();
}

void RaiseValueError(const std::string& sentence) { throw py::value_error(sentence); }

void RaiseTypeError(const std::string& sentence) { throw py::type_error(sentence); }

}  // namespace pliant::python
