// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What fuzz targets share. A target is a file with LLVMFuzzerTestOneInput: under the preset `fuzz` it is linked with
// libFuzzer; everywhere else with corpus_main.cc, which runs it over the cases that were found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace pliant {

// The input's first byte chooses one of `count` readers, the rest is the file.
struct FuzzInput {
  FuzzInput(const std::uint8_t* data, std::size_t size, int count)
      : choice(size == 0 ? 0 : data[0] % count), bytes(data + (size == 0 ? 0 : 1), size == 0 ? 0 : size - 1) {}

  int choice;
  std::span<const std::uint8_t> bytes;
};

// A folder of this process, in memory where there is such a file system.
inline std::string FuzzFolder() {
  static const std::string folder = [] {
    const bool in_memory = std::filesystem::is_directory("/dev/shm");
    std::string path = (in_memory ? "/dev/shm" : std::filesystem::temp_directory_path().string()) + "/pliant_fuzz_" +
                       std::to_string(getpid());
    std::filesystem::create_directories(path);
    return path;
  }();
  return folder;
}

inline std::string WriteFuzzFile(const std::string& name, std::span<const std::uint8_t> bytes) {
  const std::string path = FuzzFolder() + "/" + name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path;
}

}  // namespace pliant
