// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <string_view>

#include <gtest/gtest.h>

#include "exchange/neural_run.h"
#include "pliant/exchange/export.h"

namespace pliant {
namespace {

TEST(Export, EndsOnRequestAndLeavesNothing) {
  const TestFolder folder;
  WriteNeuralRun(folder, TestCamera());
  int stopped = 0;
  for (const ExportFormat& format : ExportFormats()) {
    ExportRequest request;
    request.run_path = folder.Path("run");
    request.format = format.name;
    request.output_path = folder.Path("out_" + request.format);
    bool told = false;
    const auto summary = ExportRun(request, {}, [&](std::string_view task, int done, int total) {
      EXPECT_EQ(task, "export");
      told = told || done == total;
      return done < total;
    });
    if (!told) continue;  // it goes through no frames
    ++stopped;
    EXPECT_EQ(summary.status().code(), ErrorCode::kInterrupted) << format.name;
    if (!std::filesystem::exists(request.output_path)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(request.output_path))
      EXPECT_TRUE(!entry.is_regular_file() || entry.path().extension() == ".log") << entry.path();  // of COLMAP
  }
  EXPECT_GE(stopped, 8);
}

}  // namespace
}  // namespace pliant
