// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/write_sequence.h"

#include <future>
#include <string>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/native_writer.h"
#include "pliant/io/camera_file.h"
#include "pliant/simulation/simulator.h"
#include "simulation/recorder.h"
#include "simulation/sequence_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

Status WriteOptions(const fs::path& path, const SimulationOptions& options) {
  return WriteFileAtomically(path.string(), ToYaml(options));
}

// A sequence that was filmed is not written over.
Status CheckOwnFolder(const fs::path& output) {
  std::error_code error;
  if (fs::exists(output / simulation::kOptionsFile, error)) return Status::Ok();
  for (const char* name : {native::kImageFolder, native::kRightFolder, native::kDepthFolder, native::kMaskFolder,
                           native::kCameraFile, native::kPosesFile, native::kTimesFile})
    if (fs::exists(output / name, error) && !fs::is_empty(output / name, error))
      return {ErrorCode::kInvalidArgument, (output / name).string() +
                                               " is of a sequence that was not simulated; give a new or an "
                                               "empty folder"};
  return Status::Ok();
}

CameraFile CameraFileOf(const Simulator& simulator) {
  const SimulationOptions& options = simulator.options();
  CameraFile file{
      .camera = simulator.camera(), .fps = options.trajectory.fps, .depth_scale = options.sensor.depth_scale_mm};
  if (options.camera.baseline_mm > 0) file.baseline_mm = options.camera.baseline_mm;
  return file;
}

}  // namespace

Status WriteSequence(const SimulationOptions& options, const fs::path& output, const SimulationProgress& progress) {
  if (Status status = CheckOwnFolder(output); !status.ok()) return status;
  Result<Simulator> simulator = Simulator::Create(options);
  if (!simulator.ok()) return simulator.status();
  return WriteSequence(*simulator, output, progress);
}

Status WriteSequence(Simulator& simulator, const fs::path& output, const SimulationProgress& progress) {
  if (Status status = CheckOwnFolder(output); !status.ok()) return status;
  Result<NativeWriter> writer = NativeWriter::Create(output, CameraFileOf(simulator));
  if (!writer.ok()) return writer.status();
  if (Status status = WriteOptions(output / simulation::kOptionsFile, simulator.options()); !status.ok()) return status;
  simulator.PrepareRendering();
  const auto stopped_after = [&](int frames) {
    return Status(ErrorCode::kInterrupted, "stopped after " + std::to_string(frames) + " of " +
                                               std::to_string(simulator.frame_count()) + " frames; they are in " +
                                               output.string());
  };
  if (progress && progress(0, simulator.frame_count()) == SimulationContinue::kStop) return stopped_after(0);
  simulation::Recorder left(simulator.options().recording);
  simulation::Recorder right(simulator.options().recording);
  SimulatedFrame frame = simulator.Render(0);
  for (int i = 0; i < simulator.frame_count(); ++i) {
    // A frame is compressed, packed and written while the next one is rendered.
    const SimulatedFrame done = std::exchange(frame, {});
    std::future<Status> written = std::async(std::launch::async, [&, i] {
      return writer->Write({.timestamp_s = simulator.TimeOf(i),
                            .image = left.Record(done.image),
                            .right = right.Record(done.right),
                            .depth_mm = done.depth,
                            .world_from_cam = simulator.WorldFromCamera(i)});
    });
    if (i + 1 < simulator.frame_count()) frame = simulator.Render(i + 1);
    if (Status status = written.get(); !status.ok()) return status;
    if (progress && progress(i + 1, simulator.frame_count()) == SimulationContinue::kStop) return stopped_after(i + 1);
  }
  return Status::Ok();
}

}  // namespace pliant
