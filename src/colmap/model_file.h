// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One of a model's files as a stream, in one or both formats.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "pliant/base/files.h"
#include "pliant/base/status.h"
#include "pliant/colmap/model.h"

namespace pliant::colmap {

class ModelFile {
 public:
  // `name` is cameras, images or points3D; the file appears when the group is committed.
  static Result<ModelFile> Create(FileGroup& group, const std::string& folder, const std::string& name, Format format);

  // The file's beginning: a text header's lines without their end, and how many rows will follow.
  void Begin(const std::string& header, std::uint64_t count);
  // A row, rounded in text. A point's track may be elsewhere than in the point.
  Status Add(const Camera& camera);
  Status Add(const Image& image);
  Status Add(const Point3D& point, std::span<const TrackElement> track);
  Status Close();

 private:
  Status Flush();  // hands over what has grown large

  std::optional<OutputFile> text_file_;
  std::optional<OutputFile> binary_file_;
  // Where rows are put together; what is put where no file is wanted is thrown away.
  std::string text_;
  std::string binary_;
};

// The file cameras of a model that has this one.
Status WriteCamera(FileGroup& group, const std::string& folder, Format format, const Camera& camera);

}  // namespace pliant::colmap
