// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How estimated points are compared with true ones: the protocols of the literature by name. Each has its own way to
// the scale s, its own error of a point, and its own choice of points that do not count:
//   paper          s minimizes sum |s x - y|^2; the error is |s x - y|; every point counts. The plain figure
//                  (Gomez Rodriguez, Montiel, Tardos, IROS 2022).
//   depth_trimmed  s is the median of y_z / x_z; the error is |s x_z - y_z|, along the optical axis alone; the worst
//                  trim_share of the frame's points is left out.
//   lmeds          s minimizes the median of |s x - y|^2; the error is |s x - y|; points beyond inlier_sigmas robust
//                  standard deviations sigma = 1.4826 (1 + 5 / (n - 1)) median |s x - y| of their frame are left out
//                  (Rousseeuw and Leroy, Robust Regression and Outlier Detection, 1987).
// x is the estimate and y the truth, both in the camera's frame of the moment; truth in millimeters. Figures of
// different protocols cannot be compared with each other: a trimmed one of a failed run may look like a plain one of a
// good run, which is why the plain figure and the share of points left out stand beside every other.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"

namespace pliant {

enum class ErrorProtocol { kPaper, kDepthTrimmed, kLmeds };

template <>
struct EnumNames<ErrorProtocol> {
  static constexpr std::array kNames = {std::pair{ErrorProtocol::kPaper, std::string_view("paper")},
                                        std::pair{ErrorProtocol::kDepthTrimmed, std::string_view("depth_trimmed")},
                                        std::pair{ErrorProtocol::kLmeds, std::string_view("lmeds")}};
};

// What the estimate is multiplied with before it is compared; orthogonal to the protocol, which says how s is found.
enum class ErrorScale {
  kPerFrame,  // the best scale of each frame: the paper's protocol for maps of a monocular start
  kGlobal,    // one best scale for all frames of a submap: drift of the scale counts as error
  kNone,      // 1: for maps that claim millimeters (stereo, depth). The null gets its one best depth all the same
};

template <>
struct EnumNames<ErrorScale> {
  static constexpr std::array kNames = {std::pair{ErrorScale::kPerFrame, std::string_view("per_frame")},
                                        std::pair{ErrorScale::kGlobal, std::string_view("global")},
                                        std::pair{ErrorScale::kNone, std::string_view("none")}};
};

// A point estimated and its truth, both in the camera's frame of the moment, and the ray of the pixel where it was
// observed, at depth 1: the null's estimate, for the scale makes it whatever constant depth is best.
struct PointPair {
  Eigen::Vector3d estimate;
  Eigen::Vector3d truth;
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  double truth_sigma_mm = 0;  // of the truth's z; 0: exact, or not known
  double sigma = 0;           // of the estimate's distance, in its own unit, as the run says; 0: it does not
};

struct ProtocolOptions {
  double trim_share = 0.05;    // depth_trimmed: of each frame's points, rounded down to whole ones
  double inlier_sigmas = 2.5;  // lmeds

  void List(OptionTable& table);
};

// The protocol's scale of the pairs; 1 where they determine none (every estimate zero, or behind the camera).
double ProtocolScale(std::span<const PointPair> pairs, ErrorProtocol protocol);

// The errors of the points that count, in the order of the pairs.
struct ProtocolErrors {
  std::vector<double> errors_mm;
  std::vector<double> relative_depths;  // |s x_z - y_z| / y_z
  int left_out = 0;
};

// Of one frame's pairs at a scale.
ProtocolErrors ApplyProtocol(std::span<const PointPair> pairs, double scale, ErrorProtocol protocol,
                             const ProtocolOptions& options);

}  // namespace pliant
