// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Options from a YAML file: groups of `option: value`, as OptionTable::ToYaml prints them.
#pragma once

#include <string>

#include "pliant/base/options.h"
#include "pliant/base/status.h"

namespace pliant {

// Sets every option that the file names. An unknown option is an error that names its nearest neighbor, an earlier name
// one that says the name of today; so are a value that is out of range, an option given twice, and anything but a plain
// value. The sentence has file and line. On failure the table is as it was.
Status LoadOptionsFile(const std::string& path, OptionTable& table);

}  // namespace pliant
