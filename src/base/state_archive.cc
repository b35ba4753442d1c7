// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/state_archive.h"

#include <cstring>

namespace pliant {

StateArchive StateArchive::Reading(std::string bytes) {
  StateArchive archive;
  archive.reads_ = true;
  archive.bytes_ = std::move(bytes);
  return archive;
}

void StateArchive::Bytes(void* data, std::size_t size) {
  if (!reads_) {
    bytes_.append(static_cast<const char*>(data), size);
    return;
  }
  ok_ = ok_ && size <= bytes_.size() - at_;
  if (!ok_ || size == 0) return;
  std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

std::size_t StateArchive::Size(std::size_t size) {
  std::uint64_t count = size;
  Bytes(&count, sizeof count);
  if (reads_) CheckLeft(count, 1);
  return ok_ ? static_cast<std::size_t>(count) : 0;
}

void StateArchive::CheckLeft(std::size_t count, std::size_t size) {
  ok_ = ok_ && (size == 0 || count <= (bytes_.size() - at_) / size);
}

}  // namespace pliant
