// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run folder and its images in, a surface folder out (docs/formats.md): a depth image, its standard deviation and a
// mesh for every chosen frame, by pliant/surface/dense_depth.h.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/image/masks.h"
#include "pliant/image/texture.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

struct SurfaceRunOptions {
  DenseDepthOptions depth;
  MaskOptions masks;
  int neighbors = 6;               // other images that a frame is compared with
  double min_common_points = 0.5;  // of the frame's points, that a neighbor has too
  double max_parallax_deg = 15;    // in the median of these
  int max_frames_apart = 100;      // tracked frames from a frame to its neighbor
  bool pairs = true;               // a frame that has a right image is compared with that alone
  int mesh_columns = 96;           // vertices of the mesh across an image; 0: no mesh
  bool gltf = true;                // which files of it, beside a PLY file a frame
  bool vtk = true;
  bool obj = false;
  int fill = 0;              // pixels of the largest hole of a depth image that is filled from its rim; 0: none
  bool exr = false;          // depths as OpenEXR files too
  bool npy = false;          // and as arrays of NumPy
  bool normals_png = false;  // normals of the depth images
  int animation_keys = 60;   // frames whose mesh the glTF file has
  int threads = 0;           // 0: as many as the machine has

  void List(OptionTable& table);  // groups "Surface", "Masks"
};

struct SurfaceRequest {
  std::string run_path;
  std::string sequence_path;                // the run's images; empty: those that its run.json names
  std::string camera_path;                  // their calibration, the run's; empty: the one that belongs to them
  std::string mask_path;                    // as of a SequenceRequest
  std::string output_path;                  // a folder, made if need be
  std::vector<int> frames = {};             // numbers in the sequence; empty: all that were tracked
  std::vector<std::string> command_line;    // for surface.json
  const std::atomic<bool>* stop = nullptr;  // becomes true when no more frames are wanted; may be null
};

struct SurfaceFrame {
  int frame_idx = 0;
  std::string name = {};            // of its files, with the ending .png
  bool provisional = false;         // its map is (TrackingState)
  std::vector<int> neighbors = {};  // frames
  bool has_pair = false;            // it was compared with its right image, not with neighbors
  double known_share = 0;           // of the image's valid pixels, that have a depth
  double filled_share = 0;          // filled pixels by the number of valid ones; not among `known_share`
  double median_sigma = 0;          // of those that are known, by the depth
  double seconds = 0;
  std::string note = {};  // why it has no depth, one sentence; else empty
};

struct SurfaceSummary {
  ComparedWindows windows;
  std::vector<SurfaceFrame> frames;
  bool stopped = false;
  // Sentences, of chosen frames that are not in the run or were not tracked, of other images, of a provisional map, of
  // points that rest, of a mesh that is not there.
  std::vector<std::string> warnings = {};
};

enum class SurfaceStage {
  kDepth,  // depths of frames
  kMesh,   // frames that the mesh was built from, then those that it was written for
};

// Called when a stage begins and after each of its frames, with how many are done, and are to be. `known_share` is that
// of a SurfaceFrame,
// in stage kDepth.
using SurfaceProgress = std::function<void(SurfaceStage stage, int done, int total, double known_share)>;

// Frames are written as they are done, each whole or not at all; a failure leaves those before it. Fails with
// kNotFound, kUnreadable or kMismatch for a run or images that cannot be read or do not belong together,
// kInvalidArgument where the run has none of the chosen frames, kInsufficient where none was tracked or has a depth,
// kUnwritable.
Result<SurfaceSummary> MakeSurface(const SurfaceRequest& request, const SurfaceRunOptions& options,
                                   const SurfaceProgress& callback);

}  // namespace pliant
