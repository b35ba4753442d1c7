// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/write_sequence.h"

#include <fstream>
#include <future>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "pliant/io/camera_file.h"
#include "pliant/io/trajectory.h"
#include "pliant/simulation/simulator.h"
#include "simulation/sensor.h"
#include "simulation/sequence_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using simulation::FrameFileName;

Status Unwritable(const fs::path& path) {
  return {ErrorCode::kUnwritable,
          "cannot write " + path.string() + "; is the folder writable and is there room on the disk?"};
}

Status WriteBytes(const fs::path& path, const char* data, std::size_t size) {
  std::ofstream file(path, std::ios::binary);
  file.write(data, static_cast<std::streamsize>(size));
  file.close();
  if (file) return Status::Ok();
  std::error_code error;
  fs::remove(path, error);  // half a file would be read as a damaged one
  return Unwritable(path);
}

Status WriteText(const fs::path& path, const std::string& text) { return WriteBytes(path, text.data(), text.size()); }

// Little compression: noise does not compress, and time is better spent on rays.
Status WritePng(const fs::path& path, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1})) return Unwritable(path);
  return WriteBytes(path, reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// A sequence that was filmed is not written over.
Status CheckOwnFolder(const fs::path& output) {
  std::error_code error;
  if (fs::exists(output / simulation::kOptionsFile, error)) return Status::Ok();
  for (const char* name : {simulation::kImageFolder, simulation::kRightFolder, simulation::kDepthFolder})
    if (fs::exists(output / name, error) && !fs::is_empty(output / name, error))
      return {ErrorCode::kInvalidArgument, "the folder " + (output / name).string() +
                                               " holds files of a sequence that was not simulated; give a new or an "
                                               "empty folder"};
  return Status::Ok();
}

// Frames that an earlier, longer sequence left would be read as part of this one.
Status RemoveLeftovers(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".png" && !fs::remove(entry.path(), error)) return Unwritable(entry.path());
  }
  return error ? Unwritable(folder) : Status::Ok();
}

Status PrepareFolder(const fs::path& output, const Simulator& simulator) {
  const bool stereo = simulator.options().camera.baseline_mm > 0;
  std::error_code error;
  for (const std::string_view name : {simulation::kImageFolder, simulation::kRightFolder, simulation::kDepthFolder}) {
    if (name == simulation::kRightFolder && !stereo && !fs::exists(output / name, error)) continue;
    fs::create_directories(output / name, error);
    if (error) return Unwritable(output / name);
    if (Status status = RemoveLeftovers(output / name); !status.ok()) return status;
  }
  if (!stereo) fs::remove(output / simulation::kRightFolder, error);  // stays where it holds anything else
  CameraFile camera{.camera = simulator.camera(),
                    .fps = simulator.options().trajectory.fps,
                    .depth_scale = simulator.options().sensor.depth_scale_mm};
  if (stereo) camera.baseline_mm = simulator.options().camera.baseline_mm;
  if (Status status = WriteCameraFile((output / simulation::kCameraFile).string(), camera); !status.ok()) return status;
  return WriteText(output / simulation::kOptionsFile, ToYaml(simulator.options()));
}

Status WriteFrame(const fs::path& output, int frame_idx, const SimulatedFrame& frame, double depth_scale_mm) {
  if (Status status = WritePng(output / simulation::kImageFolder / FrameFileName(frame_idx), frame.image); !status.ok())
    return status;
  if (!frame.right.empty())
    if (Status status = WritePng(output / simulation::kRightFolder / FrameFileName(frame_idx), frame.right);
        !status.ok())
      return status;
  return WritePng(output / simulation::kDepthFolder / FrameFileName(frame_idx),
                  simulation::QuantiseDepth(frame.depth, depth_scale_mm));
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
  if (Status status = PrepareFolder(output, simulator); !status.ok()) return status;
  std::ofstream poses(output / simulation::kPosesFile);
  std::ofstream times(output / simulation::kTimesFile);
  simulator.PrepareRendering();
  const auto stopped_after = [&](int frames) {
    return Status(ErrorCode::kInterrupted, "stopped after " + std::to_string(frames) + " of " +
                                               std::to_string(simulator.frame_count()) + " frames; they are in " +
                                               output.string());
  };
  if (progress && progress(0, simulator.frame_count()) == SimulationContinue::kStop) return stopped_after(0);
  SimulatedFrame frame = simulator.Render(0);
  for (int i = 0; i < simulator.frame_count(); ++i) {
    // A frame is packed and written while the next one is rendered.
    std::future<Status> written = std::async(std::launch::async, [&output, &simulator, i, done = std::move(frame)] {
      return WriteFrame(output, i, done, simulator.options().sensor.depth_scale_mm);
    });
    if (i + 1 < simulator.frame_count()) frame = simulator.Render(i + 1);
    if (Status status = written.get(); !status.ok()) return status;
    std::string pose;
    AppendTumLine(&pose, simulator.TimeOf(i), simulator.WorldFromCamera(i));
    poses << pose << std::flush;
    times << FormatDouble(simulator.TimeOf(i)) << std::endl;
    if (!poses) return Unwritable(output / simulation::kPosesFile);
    if (!times) return Unwritable(output / simulation::kTimesFile);
    if (progress && progress(i + 1, simulator.frame_count()) == SimulationContinue::kStop) return stopped_after(i + 1);
  }
  return Status::Ok();
}

}  // namespace pliant
