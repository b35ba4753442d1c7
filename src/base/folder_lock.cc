// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/folder_lock.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>

#include "pliant/base/text.h"

namespace pliant {

Result<FolderLock> FolderLock::Take(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0)
    return Status(ErrorCode::kUnwritable, "cannot open the folder " + Quoted(folder.string()) + ": " +
                                              std::generic_category().message(errno) +
                                              "; choose another folder or change its permissions");
  FolderLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return Status(ErrorCode::kUnwritable, "another program is writing into " + Quoted(folder.string()) +
                                              "; wait for its end, or give another folder");
  return lock;
}

}  // namespace pliant
