// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Options as a Python dictionary with the names of the command line: {"Init.method": "window", "Growth.grow": False}.
#pragma once

#include <pybind11/pybind11.h>

#include "pliant/base/options.h"

namespace pliant::python {

// Sets the options that the dictionary names, in its order; None sets nothing. Values are booleans, numbers, text, or a
// list of names. Raises ValueError with the table's sentence for a name that it does not have or a value that the
// option does not take, and TypeError for what is no dictionary.
void SetOptions(const pybind11::object& options, OptionTable* table);

// The options of `struct` T with those of the dictionary set.
template <class T>
T OptionsOf(const pybind11::object& options, T defaults = {}) {
  OptionTable table;
  defaults.List(table);
  SetOptions(options, &table);
  return defaults;
}

// The value of an EnumNames enum by its name. Raises ValueError with `what` and the names that there are.
template <class Enum>
Enum EnumOf(const std::string& name, const std::string& what) {
  OptionTable table;
  Enum value{};
  table.BeginGroup(what, "");
  table.AddChoice("name", &value, "");
  const std::string accepts = table.fields().front().unit;
  if (!table.fields().front().set(name).ok())
    throw pybind11::value_error(what + " is '" + name + "'; give one of " + accepts);
  return value;
}

}  // namespace pliant::python
