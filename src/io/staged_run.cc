// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/staged_run.h"

#include "io/former_run.h"

namespace pliant {

Result<StagedRun> StagedRun::Create(const std::string& folder) {
  auto staged = StagedFolder::Create(folder, {});
  if (!staged.ok()) return staged.status();
  if (Status status = FormerRun::CheckFolder(folder); !status.ok()) return status;
  return StagedRun(folder, *std::move(staged));
}

Status StagedRun::Commit() {
  auto former = FormerRun::SetAside(folder_);
  if (!former.ok()) return former.status();
  if (Status status = staged_.Commit(); !status.ok()) return status;
  former->Forget();
  return Status::Ok();
}

}  // namespace pliant
