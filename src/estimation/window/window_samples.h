// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Parts of a deforming window's points, which are solved first: faster than all, and a check on one another.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pliant/estimation/window/deforming_window.h"

namespace pliant {

using PointSample = std::vector<int>;  // indices of a window's points, ascending

std::vector<Eigen::Vector3d> DirectionsOf(const std::vector<Eigen::Vector3d>& positions);

// The four of `directions` that are nearest to one, with weights that sum to 1 and fall with the distance.
struct NearPoint {
  std::size_t idx = 0;
  double weight = 0;
};
std::vector<NearPoint> NearestPoints(const std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& direction);

// `count` of the points, of which there are as many, whose directions from the reference are spread evenly (farthest
// point sampling); ascending.
PointSample SpreadPoints(const std::vector<Eigen::Vector3d>& points_in_world, int count);

// Two samples without common points, each of at most `size` points whose directions from the reference are spread
// evenly; one sample of all points where two would have fewer than 60 each.
std::vector<PointSample> SamplePoints(const DeformingWindow& window, int size);

// The window in at most `count` of its views, spread evenly from the first to the last.
DeformingWindow InSomeViews(const DeformingWindow& window, int count);

// The window of a sample's points, with their observations, without coefficients. Point k is sample[k].
DeformingWindow PartOf(const DeformingWindow& window, const PointSample& sample);

// All points of `start`, in the solved views of the sample `part` of it: depths are changed like those of the nearest
// points of the sample, and shapes are theirs.
DeformingWindow ExtendToAll(const DeformingWindow& start, const DeformingWindow& part, const PointSample& sample);

}  // namespace pliant
