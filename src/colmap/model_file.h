// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One of a model's files as a stream, in one or both formats.
#pragma once

#include <optional>
#include <string>

#include "pliant/base/status.h"
#include "pliant/base/text.h"
#include "pliant/colmap/model.h"

namespace pliant::colmap {

class ModelFile {
 public:
  // `name` is cameras, images or points3D; the file appears when the group is committed.
  static Result<ModelFile> Create(FileGroup& group, const std::string& folder, const std::string& name, Format format);

  // Where rows are put together; what is put where no file is wanted is thrown away.
  std::string text;
  std::string binary;

  // Hands over what has grown large.
  Status Flush();
  Status Close();

 private:
  std::optional<OutputFile> text_file_;
  std::optional<OutputFile> binary_file_;
};

// The file cameras of a model that has this one.
Status WriteCamera(FileGroup& group, const std::string& folder, Format format, const Camera& camera);

}  // namespace pliant::colmap
