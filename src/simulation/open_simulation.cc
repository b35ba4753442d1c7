// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/open_simulation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "datasets/image_file.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/options_file.h"
#include "pliant/io/trajectory.h"
#include "simulation/sequence_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

Status Foreign(const fs::path& folder, const std::string& what) {
  return {ErrorCode::kMismatch, (folder / simulation::kOptionsFile).string() +
                                    " does not describe the sequence beside it: " + what +
                                    "; was a file exchanged, or did another version of Pliant write it? Simulate the "
                                    "sequence again"};
}

Status CheckCamera(const fs::path& folder, const Simulator& simulator) {
  const Result<CameraFile> file = ReadCameraFile((folder / native::kCameraFile).string());
  if (!file.ok()) return file.status();
  const Camera& there = file->camera;
  const Camera& here = simulator.camera();
  const bool same = there.model_id() == here.model_id() && there.width() == here.width() &&
                    there.height() == here.height() && std::ranges::equal(there.params(), here.params()) &&
                    file->fps == simulator.options().trajectory.fps &&
                    file->baseline_mm.value_or(0.0) == simulator.options().camera.baseline_mm;
  return same ? Status::Ok() : Foreign(folder, "camera.yaml has another camera");
}

Status CheckPoses(const fs::path& folder, const Simulator& simulator) {
  // Half a step of the decimals in the file, each way, of three and four numbers.
  constexpr double kTranslationMm = 2e-6;
  constexpr double kQuaternion = 2e-9;
  const auto poses = ReadTumTrajectory((folder / native::kPosesFile).string());
  if (!poses.ok()) return poses.status();
  if (std::ssize(*poses) > simulator.frame_count())
    return Foreign(folder, "groundtruth.txt has " + std::to_string(poses->size()) + " poses, and the options give " +
                               std::to_string(simulator.frame_count()) + " frames");
  for (int i = 0; i < std::ssize(*poses); ++i) {
    const Rigid3& there = (*poses)[i].world_from_cam;
    const Rigid3 here = simulator.WorldFromCamera(i);
    const bool same = (there.translation - here.translation).norm() < kTranslationMm &&
                      std::min((there.rotation.coeffs() - here.rotation.coeffs()).norm(),
                               (there.rotation.coeffs() + here.rotation.coeffs()).norm()) < kQuaternion;
    if (!same) return Foreign(folder, "the pose of frame " + std::to_string(i) + " differs");
  }
  return Status::Ok();
}

// Poses do not show the walls: a scene of another seed may have the same ones where there is no tremor.
Status CheckDepth(const fs::path& folder, Simulator& simulator) {
  constexpr int kAcross = 16;
  constexpr int kDown = 12;
  const fs::path path = folder / native::kDepthFolder / native::FrameFileName(0);
  std::error_code error;
  if (!fs::exists(path, error)) return Foreign(folder, path.string() + " is not there");
  const auto stored = ReadStoredImage(path);
  if (!stored.ok()) return stored.status();
  const cv::Mat& steps = *stored;
  const Camera& camera = simulator.camera();
  if (steps.type() != CV_16UC1 || steps.cols != camera.width() || steps.rows != camera.height())
    return Foreign(folder, path.string() + " is not a depth image of the camera's size");
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y < kDown; ++y)
    for (int x = 0; x < kAcross; ++x)
      pixels.emplace_back((2 * x + 1) * camera.width() / (2 * kAcross), (2 * y + 1) * camera.height() / (2 * kDown));
  const auto hits = simulator.HitsAt(0, pixels);
  const double scale_mm = simulator.options().sensor.depth_scale_mm;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int there = steps.at<std::uint16_t>(static_cast<int>(pixels[i].y()), static_cast<int>(pixels[i].x()));
    const double here = hits[i] ? hits[i]->depth_mm / scale_mm : 0.0;
    // Half a step of rounding, and that of the float that was rounded; out of range is written as 0.
    const bool same = there == 0 ? here < 1.0 || here > 65535.0 : std::abs(here - there) < 0.51 + 1e-6 * here;
    if (!same) return Foreign(folder, "the depth of frame 0 differs");
  }
  return Status::Ok();
}

}  // namespace

Result<SimulationOptions> ReadSimulationOptions(const fs::path& sequence_folder) {
  const fs::path path = sequence_folder / simulation::kOptionsFile;
  std::error_code error;
  if (!fs::exists(sequence_folder, error))
    return {ErrorCode::kNotFound, "there is no folder " + sequence_folder.string()};
  if (!fs::exists(path, error))
    return {ErrorCode::kNotFound, sequence_folder.string() + " has no " + simulation::kOptionsFile +
                                      ": only a sequence that pliant simulate made has the truth of its material"};
  SimulationOptions options;
  OptionTable table;
  options.List(table);
  if (Status status = LoadOptionsFile(path.string(), table); !status.ok()) return status;
  return options;
}

Result<Simulator> OpenSimulation(const fs::path& sequence_folder) {
  const Result<SimulationOptions> options = ReadSimulationOptions(sequence_folder);
  if (!options.ok()) return options.status();
  Result<Simulator> simulator = Simulator::Create(*options);
  if (!simulator.ok()) return simulator.status();
  if (Status status = CheckCamera(sequence_folder, *simulator); !status.ok()) return status;
  if (Status status = CheckPoses(sequence_folder, *simulator); !status.ok()) return status;
  if (Status status = CheckDepth(sequence_folder, *simulator); !status.ok()) return status;
  return simulator;
}

}  // namespace pliant
