// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run in other programs' formats; ExportFormats lists them. COLMAP has no time axis for points, so a scene that
// deforms can be put into its models in three ways (canonical, spacetime, frames), none of which is consistent with
// bundle adjustment. Units are the run's (map units, mm). Observations are streamed: memory grows with points and
// frames, not with the number of observations. The formats for neural rendering hold the run's images; docs/formats.md
// has their axes, pixels and units.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/colmap/model.h"

namespace pliant {

struct ExportFolder;
struct RunSource;

struct ExportOptions {
  colmap::Format files = colmap::Format::kBinary;  // of COLMAP's models
  int stride = 1;                                  // every Nth tracked frame is exported
  int min_matches = 15;                            // database: pairs of images that share fewer tracks are left out
  // endonerf, with a surface: pixels without a depth are masked, because its readers take a 0 for a depth.
  Switch mask_unknown_depth = Switch::kOn;
  // stir: a file of the labelled points of the run's first frame (io/stir_file.h, px), and the name that the recording
  // has in it. Empty: the run's own points; the one name that there is, or the path of the images.
  std::string start_points = {};
  std::string recording = {};

  void List(OptionTable& table);  // group "Export"
};

struct ExportFormat {
  enum class Needs { kRun, kRunAndImages };

  std::string_view name;
  std::string_view what;  // for people: what it leaves, a sentence
  Status (*write)(const RunSource& source, const ExportOptions& options, const ExportFolder& folder);
  Needs needs = Needs::kRun;  // a format with images takes mask_path and surface_path of a request
};

std::span<const ExportFormat> ExportFormats();

struct ExportRequest {
  std::string run_path;
  // Where images' names and the camera are taken from if the run folder has no sparse/: a killed run, or another
  // program's. Empty: the images that the run was made of.
  std::string sequence_path;
  std::string format = "canonical";  // a name of ExportFormats
  std::string output_path;           // a folder, made if need be
  std::string camera_path = {};      // the calibration of the images; empty: the one that belongs to them
  // Of formats with images:
  std::string mask_path = {};     // as of a SequenceRequest
  std::string surface_path = {};  // a surface folder of the run: frames without a depth are left out; empty: no depths
};

struct ExportSummary {
  int frames = 0;
  int points = 0;
  std::int64_t observations = 0;
  std::vector<std::string> notes;  // what could not be known, a sentence each
};

// Fails with kNotFound, kUnreadable or kMismatch for what cannot be read, and images or a surface that are not the
// run's; kInsufficient if no frame was tracked, or none has a depth; kInvalidArgument if there is no such format, the
// folder holds a run, has a model in another format, or images or files a frame already, or the format has no images to
// mask or to give depths; kUnwritable. `progress` is told of the frames of a format that holds images or reads
// observations (task "export"); where it asks to stop nothing is left. All files of all submaps appear together.
Result<ExportSummary> ExportRun(const ExportRequest& request, const ExportOptions& options,
                                const JobProgress& progress = {});

}  // namespace pliant
