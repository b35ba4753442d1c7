// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/ply.h"

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {

Status WritePly(const std::string& path, std::span<const NewPoint> points) {
  auto file = OutputFile::Create(path);
  if (!file.ok()) return file.status();
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
                    "property uchar green\nproperty uchar blue\nend_header\n";
  for (const NewPoint& point : points) {
    for (const double coordinate : point.position) AppendFloat(&out, static_cast<float>(coordinate));
    for (const std::uint8_t channel : point.rgb) AppendBytes(&out, channel, 1);
    if (Status status = file->AppendWhenLarge(&out); !status.ok()) return status;
  }
  if (Status status = file->Append(out); !status.ok()) return status;
  return file->Close();
}

}  // namespace pliant
