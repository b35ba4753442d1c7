// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs as stills and films, drawn without a display: images with the tracked points of all runs, each run's in a color
// of its own, above (in a film: beside) the scene in 3D, as in the paper's figures: the undeformed map in black, each
// point's trail of deformation in red, the camera's path and its frustum in blue; the true surface and path in green
// where they are known. A frame without a pose says why it has none.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/viewer/view.h"

namespace pliant {

// What a mesh of the tissue is colored by; the values have the names that the page of a report uses.
enum class SurfaceColor {
  kImage,         // its texture
  kDisplacement,  // from the undeformed positions
  kAreaChange,    // of the triangles around a vertex, by the undeformed area
  kUncertainty,   // standard deviation of the distance from the camera
  kError,         // distance from the true surface
};
template <>
struct EnumNames<SurfaceColor> {
  static constexpr std::array kNames = {std::pair{SurfaceColor::kImage, std::string_view("image")},
                                        std::pair{SurfaceColor::kDisplacement, std::string_view("displacement")},
                                        std::pair{SurfaceColor::kAreaChange, std::string_view("area_change")},
                                        std::pair{SurfaceColor::kUncertainty, std::string_view("uncertainty")},
                                        std::pair{SurfaceColor::kError, std::string_view("error")}};
};

struct FigureOptions {
  ViewOptions view;
  int panel_width_px = 480;   // of an image; a scene is as large
  int trail_frames = 30;      // of a trail, up to the present frame
  double azimuth_deg = 40;    // from where the scene is seen: round its vertical, from behind the camera to its right
  double elevation_deg = 25;  // and above
  double fps = 0;             // of a film; 0: the sequence's
  SurfaceColor surface_color = SurfaceColor::kImage;

  void List(OptionTable& table);  // group "Figure"; not those of the view
};

// One column a frame: its image (where there are images), and below it the scene, a row a run. The ending of
// `output_path` says what is written: .png, .svg or .pdf. Returns what is missing, a sentence each. Fails as OpenView
// does, with kInvalidArgument for a frame that no run has, and with kUnwritable. `progress` is told of the frames that
// are compared with the truth and drawn; where it asks to stop nothing is written: kInterrupted.
Result<std::vector<std::string>> WriteFigure(const ViewRequest& request, const FigureOptions& options,
                                             const std::vector<int>& frames_idx, const std::string& output_path,
                                             const JobProgress& progress = {});

// Every frame of the runs in order, as H.264 where OpenCV's FFmpeg has an encoder for it, else as MPEG-4. `progress` is
// told how many of how many frames are done, and says whether to go on; a film that ends so is whole up to there, but
// does not replace one that is there: this fails with kInterrupted. Returns and fails likewise.
Result<std::vector<std::string>> WriteFilm(const ViewRequest& request, const FigureOptions& options,
                                           const std::string& output_path,
                                           const std::function<bool(int, int)>& progress);

}  // namespace pliant
