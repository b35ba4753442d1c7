// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// SimCol3D (Rau et al., Medical Image Analysis 2024): rendered colonoscopy. FrameBuffer_NNNN.png, Depth_NNNN.png of 16
// bits whose full scale is 20 cm and all beyond, and, beside the folder, SavedPosition_NAME.txt in cm and
// SavedRotationQuaternion_NAME.txt (x y z w), a line a frame, in Unity's left-handed world.
#include "datasets/formats.h"
#include "datasets/image_file.h"
#include "datasets/set_frames.h"
#include "pliant/base/files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr double kSimColFullScale_mm = 200.0;
constexpr double kSimColSteps = 65536.0;  // as its authors divide
constexpr double kMillimeters = 10.0;

// Frames_S1 lies beside SavedPosition_S1.txt.
std::string NameOf(const fs::path& folder) {
  const std::string name = fs::path(folder / ".").parent_path().filename().string();
  constexpr std::string_view kPrefix = "Frames_";
  return name.starts_with(kPrefix) ? name.substr(kPrefix.size()) : name;
}

fs::path FindBeside(const fs::path& folder, const std::string& prefix) {
  const std::string name = prefix + NameOf(folder) + ".txt";
  for (const fs::path& where : {folder, fs::path(folder / ".").parent_path().parent_path()})
    if (Exists((where / name).string())) return where / name;
  return {};
}

// What keeps the poses from being read, where some are there: `positions` and `rotations` are what was found.
std::string WhyNoPoses(const fs::path& folder, const fs::path& positions, const fs::path& rotations) {
  const std::string name = NameOf(folder) + ".txt";
  const auto sentence = [&](const std::string& found, const std::string& missing) {
    return "no poses are read: " + found + " is there, but no " + missing + name;
  };
  if (!positions.empty()) return sentence(positions.string(), "SavedRotationQuaternion_");
  if (!rotations.empty()) return sentence(rotations.string(), "SavedPosition_");
  for (const fs::path& where : {folder, fs::path(folder / ".").parent_path().parent_path()})
    if (const fs::path other = AnyFile(where, "SavedPosition_"); !other.empty())
      return sentence(other.string(), "SavedPosition_");
  return {};
}

Result<std::map<int, Rigid3>> ReadPoses(const fs::path& positions, const fs::path& rotations) {
  const auto translations = ReadNumberRows(positions, 3);
  if (!translations.ok()) return translations.status();
  const auto turns = ReadNumberRows(rotations, 4);
  if (!turns.ok()) return turns.status();
  if (translations->size() != turns->size())
    return Status(ErrorCode::kMismatch, positions.string() + " has " + std::to_string(translations->size()) +
                                            " lines and " + rotations.string() + " has " +
                                            std::to_string(turns->size()));
  std::map<int, Rigid3> poses;
  for (std::size_t k = 0; k < translations->size(); ++k) {
    NumberRow row = (*turns)[k];
    for (int c = 0; c < 3; ++c)
      row.numbers.push_back(kMillimeters * (*translations)[k].numbers[static_cast<std::size_t>(c)]);
    const auto pose = PoseOfRow(rotations, row, {.tx = row.numbers.size() - 3, .qx = 0, .qw = 3});
    if (!pose.ok()) return pose.status();
    poses.emplace(static_cast<int>(k), FromUnity(*pose));
  }
  return poses;
}

}  // namespace

bool IsSimCol(const fs::path& path) { return !NumberedFiles(path, "FrameBuffer_", ".png").empty(); }

Result<DataSet> OpenSimCol(const SequenceRequest& request) {
  const fs::path& folder = request.image_path;
  NumberedSet set{.folder = folder,
                  .images = NumberedFiles(folder, "FrameBuffer_", ".png"),
                  .depth = NumberedFiles(folder, "Depth_", ".png"),
                  .read_depth = [](const fs::path& file) {
                    return ReadClampedDepthImage(file, kSimColFullScale_mm / kSimColSteps);
                  }};
  const fs::path positions = FindBeside(folder, "SavedPosition_");
  const fs::path rotations = FindBeside(folder, "SavedRotationQuaternion_");
  if (!positions.empty() && !rotations.empty()) {
    auto poses = ReadPoses(positions, rotations);
    if (!poses.ok()) return poses.status();
    set.world_from_cam = *std::move(poses);
  }
  const auto camera = PublishedCamera("SimCol3D", CameraModelId::kPinhole, 475, 475, {227.604, 227.604, 237.5, 237.5});
  if (!camera.ok()) return camera.status();
  auto data_set = OpenNumberedSet(request, std::move(set), *camera);
  if (data_set.ok() && (positions.empty() || rotations.empty()))
    if (const std::string why = WhyNoPoses(folder, positions, rotations); !why.empty())
      data_set->warnings.push_back(why);
  return data_set;
}

}  // namespace pliant
