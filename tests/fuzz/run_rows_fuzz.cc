// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run folder of which one file is anything at all.
#include <array>
#include <cstdlib>
#include <string_view>

#include "fuzz_input.h"
#include "pliant/io/run_reader.h"

using namespace pliant;  // NOLINT(google-build-using-namespace): a file that is one function

namespace {

constexpr std::array<std::string_view, 4> kNames = {"observations.csv", "trajectory.txt", "frames.csv", "run.json"};
constexpr std::array<std::string_view, 4> kGood = {
    "frame,point_id,u_px,v_px,x,y,z,ssim\n0,1,10,10,0,0,50,0.9\n", "0.000000 0 0 0 0 0 0 1\n",
    "frame,timestamp,state,tracked,optimized,lost,added,cost_reprojection,cost_spatial,cost_temporal,cost_edge_length,"
    "median_reprojection_error_px\n0,0.000000,tracking,1,1,0,1,0,0,0,0,0\n",
    ""};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FuzzInput input(data, size, static_cast<int>(kNames.size()));
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const std::string name(kNames[i]);
    if (static_cast<int>(i) == input.choice)
      WriteFuzzFile(name, input.bytes);
    else if (kGood[i].empty())
      std::filesystem::remove(FuzzFolder() + "/" + name);
    else
      WriteFuzzFile(name, {reinterpret_cast<const std::uint8_t*>(kGood[i].data()), kGood[i].size()});
  }
  if (const auto run = ReadRun(FuzzFolder()); !run.ok() && run.status().message().empty()) std::abort();
  auto reader = ObservationReader::Open(FuzzFolder());
  if (!reader.ok()) return 0;
  int last_frame_idx = -1;
  while (true) {
    const auto rows = reader->Next();
    if (!rows.ok() || !rows->has_value()) break;
    if ((*rows)->frame_idx <= last_frame_idx) std::abort();
    last_frame_idx = (*rows)->frame_idx;
  }
  return 0;
}
