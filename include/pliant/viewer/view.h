// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is shown of runs, whoever shows it (the page of a report, a live view, a figure, a film): the runs in one world,
// beside their figures and the truth where there is truth.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/io/gltf.h"
#include "pliant/io/run_reader.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

inline constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// A point in a frame; what is not known is not a number.
struct ViewedObservation {
  PointId id;
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // where it was in this frame, world
  float depth = kUnknown;                              // along the optical axis, in the world's unit
  float reprojection_px = kUnknown;
  float ssim = kUnknown;
  float sigma = kUnknown;  // standard deviation of its distance from the camera, in the world's unit
  // What maps the gray levels of the point's first patch onto those of this frame's: gain * first + bias.
  float gain = kUnknown;
  float bias = kUnknown;
  Eigen::Vector3f truth = Eigen::Vector3f::Constant(kUnknown);  // the true surface at its pixel, in the run's scale
  float error_mm = kUnknown;                                    // from it, as the evaluation measures
};

struct ViewedFrame {
  RunFrame row;
  std::string note;
  std::optional<Rigid3> world_from_cam;
  std::vector<ViewedObservation> observations;  // sorted by id
};

// A figure of a table, or an option: group, name, value.
struct NamedText {
  std::string group;
  std::string name;
  std::string value;
};

// A mesh of a run's surface; its normals are those of its own world.
struct ViewedMesh {
  GltfMesh surface;
  // Of every key, the distance of each vertex from the true surface at its pixel; not a number where the frame does not
  // show the vertex, or its truth is not known. Empty: there is no truth.
  std::vector<std::vector<float>> errors_mm = {};
};

struct ViewedRun {
  std::string name;
  std::string status;  // of run.json, and what it says beside it; empty: another system's result
  std::string note;
  bool in_millimeters = false;           // its own unit, as far as options tell; else its map units
  bool has_rows = true;                  // false: counts, costs and stages are not known
  std::optional<Camera> camera;          // where the run or its sequence says it
  std::vector<std::string> stage_names;  // of RunFrame::stage_ms
  std::vector<ViewedFrame> frames;       // every frame read, in order
  std::map<PointId, NewPoint> points;    // undeformed, of every point that is shown
  std::vector<ViewedMesh> meshes;        // of its surface, at most one a submap
  std::vector<std::pair<std::string, std::vector<std::optional<double>>>> errors;  // by name, one value a frame
  std::vector<std::optional<double>> scales;  // mm a unit of the run, one a frame; empty: not known
  std::vector<NamedText> figures;
  std::vector<NamedText> options;
};

struct TruePose {
  int frame_idx = 0;
  Rigid3 world_from_cam;
};

struct View {
  std::vector<ViewedRun> runs;              // in one world
  std::vector<TruePose> truth;              // the true camera path in it; empty: not known
  bool in_millimeters = false;              // else its unit is the first run's map unit
  std::optional<Camera> camera;             // nothing: neither the sequence nor a run says
  std::optional<SequenceRequest> sequence;  // the images; nothing: there are none
  std::vector<std::string> notes;           // what is missing or left out; one sentence each
};

struct ViewOptions {
  int max_observations = 3000000;  // of all runs together; above it every second, third, ... point is shown

  void List(OptionTable& table);  // appended to the group "Report"
};

struct ViewRequest {
  std::vector<std::string> run_paths;
  std::string sequence_path;  // empty: the one that the first run's run.json names, if it is still there
  std::string camera_path;    // of the sequence; may be empty
  std::vector<std::string> surface_paths = {};  // surface folders of some of the runs
  bool figures = true;  // false: no tables, for which the material of a simulated scene must be followed
};

// What a run is called: its folder's name.
std::string RunName(const std::string& run_path);

// Reads the runs, finds their sequence, takes over its truth and brings everything into one world: the truth's where
// there is true motion of the camera, in millimeters, else that of the first run whose unit is the millimeter, else the
// first run's. A run's worlds are turned and scaled onto
// it by the camera's poses and the points' depths in common frames; one without a common frame is a note. Fails with
// what reading a run or its truth fails with, kMismatch where a run is not of the sequence that was named, and
// kInsufficient where no run has a frame. A sequence that was not named, and is missing or not that of a run, is a
// note.
Result<View> OpenView(const ViewRequest& request, const ViewOptions& options, const JobProgress& progress = {});

// The run's world (or that of one of its submaps) into another one.
void Move(const Sim3& world_from_run, int submap, ViewedRun* run);

}  // namespace pliant
