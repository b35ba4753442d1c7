// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One writer at a time: a folder that is being written into is not written into by another process, or twice by one.
#pragma once

#include <filesystem>

#include "pliant/base/files.h"
#include "pliant/base/status.h"

namespace pliant {

class FolderLock {
 public:
  // Of a folder that is there. Leaves no file, and ends with this object, or with the process and the children that it
  // was forked into, however these end. On a file
  // system that knows no locks it always succeeds. Fails with kUnwritable while another one holds it, and where the
  // folder cannot be opened.
  static Result<FolderLock> Take(const std::filesystem::path& folder);

 private:
  explicit FolderLock(int descriptor) : lock_(descriptor) {}

  FileLock lock_;
};

}  // namespace pliant
