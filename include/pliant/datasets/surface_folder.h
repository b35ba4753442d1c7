// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reads surface folders (docs/formats.md): the depth of every pixel of some frames.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/image/texture.h"
#include "pliant/io/ply.h"

namespace pliant {

namespace surface {
inline constexpr const char* kSummaryFile = "surface.json";
inline constexpr const char* kConfidenceFolder = "confidence";
inline constexpr const char* kFilledFolder = "filled";
inline constexpr const char* kMeshFolder = "mesh";
inline constexpr double kConfidenceUnit = 1.0 / 65535.0;  // of a standard deviation by the depth
}  // namespace surface

struct SurfaceFolder {
  struct Frame {
    int frame_idx = 0;
    std::string file_name;       // in depth/ and confidence/; empty: it has no depth
    std::vector<int> neighbors;  // frames that it was compared with
    bool has_pair = false;       // it was compared with its right image instead
  };

  std::filesystem::path path;
  std::filesystem::path run;  // that it was made of, absolute; empty: it does not say
  Camera camera;
  double depth_scale = 1;                        // map units
  std::vector<Frame> frames;                     // that have a depth
  std::optional<ComparedWindows> windows;        // nothing: it does not say
  std::vector<Frame> frames_without_depth = {};  // that were chosen, too; without files
  std::string trajectory_checksum = {};          // TrajectoryChecksum of the run; empty: an earlier version's
};

struct SurfaceDepth {
  cv::Mat depth;  // CV_32FC1, the camera's size, z along the optical axis, map units; 0 = none
  cv::Mat sigma;  // CV_32FC1, by the depth
  // CV_8UC1, not 0 where the depth was filled from the rim of a hole, and not measured; empty: nowhere.
  cv::Mat filled = {};

  // Takes the depths away that were filled.
  void KeepMeasured();
};

// Fails with kNotFound or kUnreadable, also where two frames have one file.
Result<SurfaceFolder> ReadSurfaceFolder(const std::filesystem::path& path);
// Fails with kMismatch where the surface was made of another run than is in this folder now: of one elsewhere that this
// is no copy of, or of one that was replaced. A surface of an earlier version is only known to be of another run where
// the folder that it names is there.
Status CheckSurfaceOfRun(const SurfaceFolder& surface, const std::string& run_path);
// Fails also with kMismatch where an image has not the camera's size.
Result<SurfaceDepth> ReadSurfaceDepth(const SurfaceFolder& folder, const SurfaceFolder::Frame& frame);
// What the frame shows of the mesh: its vertices in the camera's frame, and the standard deviations of their distances,
// map units; none where there is no mesh. Fails with kUnreadable.
Result<PlyVertices> ReadSurfaceVertices(const SurfaceFolder& folder, const SurfaceFolder::Frame& frame);

// What the files of frames are called: as their images, with the ending .png, and with the frame's number where another
// image of the run would be called the same (a.jpg and a.png, left/1.png and right/1.png).
class SurfaceFileNames {
 public:
  // The names of the run's images by frame. They must outlive this.
  explicit SurfaceFileNames(const std::map<int, std::string>& images);
  std::string Of(int frame_idx) const;

 private:
  const std::map<int, std::string>& images_;
  std::map<std::string, int> images_of_stem_;
};

}  // namespace pliant
