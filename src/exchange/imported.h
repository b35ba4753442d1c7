// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Other programs' results as their readers give them to Import: by the sequence's frames, in the other program's unit.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/ids.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/sequence.h"
#include "pliant/exchange/import.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

struct ImportedFrame {
  Rigid3 cam_from_world;
  std::vector<PointObservation> observations;  // sorted by id
};

struct Imported {
  std::optional<Camera> camera;  // nothing: the sequence's
  std::map<int, ImportedFrame> frames;
  std::map<PointId, std::array<std::uint8_t, 3>> colors;  // of points whose color is known
  std::vector<std::string> notes;
};

// Fails with kInvalidArgument where the model has not one camera; one that cannot be read is ReadColmapModel's to
// report.
Status CheckOneCamera(const std::string& folder);
// Each fails as Import does.
Result<Imported> ReadColmapModel(const std::string& folder, const Sequence& sequence, const JobProgress& progress);
Result<Imported> ReadResult(const std::string& folder, const Sequence& sequence, const ImportOptions& options);
Result<Imported> ReadTrajectory(const std::string& path, ImportFormat format, const Sequence& sequence,
                                const ImportOptions& options);

}  // namespace pliant
