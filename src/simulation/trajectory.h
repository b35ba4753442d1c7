// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the camera is at a time. Every scene has a way that cameras follow; a path, chosen by name, moves on
// it, and the tremor of the hand comes on top. A path from a file needs neither.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/trajectory.h"
#include "pliant/simulation/options.h"
#include "simulation/centerline.h"

namespace pliant::simulation {

// How far along the way the camera comes.
double LastCameraMm(const SimulationOptions::Trajectory& options);

class Path {
 public:
  // Fails with kInvalidArgument for a start pose that is none or that the scene needs and does not have, as
  // ReadTumTrajectory does for the file, with kInsufficient for a file that ends before the last frame, and as
  // BoardViews does.
  static Result<Path> Create(const SimulationOptions& options);

  // The tube's; the path keeps a copy. Needed before any pose is asked for where the scene is a tube.
  void Follow(const Centerline& centerline) { centerline_ = centerline; }

  Rigid3 WorldFromCamera(double time_s) const;
  // Where along the centerline the camera is at a time; nothing for cameras that do not follow it.
  std::optional<double> PositionMm(double time_s) const;
  // How long a tube or sheet has to be so that the camera does not come to its end.
  double ReachMm() const;

 private:
  struct Wave {
    double frequency_hz;
    double phase;
    double weight;
  };
  static constexpr int kWaves = 4;

  explicit Path(const SimulationOptions& options);

  double AdvanceMm(double time_s) const;   // on the way, from the start
  Rigid3 Steady(double advance_mm) const;  // on the way, this far from the start
  Rigid3 Sway(double time_s) const;
  Rigid3 Loop(double time_s) const;
  Rigid3 FromFile(double time_s) const;
  Rigid3 AmongViews(double time_s) const;
  Rigid3 Tremor(double time_s) const;  // steady camera from trembling camera
  double LoopPeriodS() const;
  bool InTube() const;

  SimulationOptions::Trajectory options_;
  SceneKind scene_;
  double radius_mm_;
  std::optional<Centerline> centerline_;
  std::optional<Rigid3> start_;                     // given: the way is straight ahead from there
  std::vector<TimedPose> poses_;                    // of the file, times from 0 on
  std::vector<Rigid3> views_;                       // of the board, one every view_s
  std::array<std::array<Wave, kWaves>, 6> tremor_;  // rotation about x, y, z, then translation
};

}  // namespace pliant::simulation
