// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the gray levels of an endoscope's image depend on where its light falls: the response of the camera, the shade of
// the lens towards the border, and the spread of the light, which is taken to be at the camera.
#pragma once

#include <Eigen/Core>

#include "pliant/base/status.h"

namespace pliant {

struct PhotometricCalibration {
  double gamma = 2.2;  // level = light^(1 / gamma), levels and light from 0 to 1
  // Of the light from a direction at an angle a to the optical axis cos(a)^vignetting passes the lens; 0: all.
  double vignetting = 0;
  // In a direction at an angle b to its axis the light is exp(-light_spread (1 - cos(b))) of the brightest (the spot
  // light of Modrzejewski et al., IJCARS 2020, with which Endomapper is calibrated: arXiv 2204.09083); 0: all around.
  double light_spread = 0;
  Eigen::Vector3d light_axis = Eigen::Vector3d::UnitZ();  // in the camera, of any length but 0
};

// kInvalidArgument for gamma outside (0.1, 10), a negative vignetting or light_spread, or no light_axis.
Status CheckPhotometric(const PhotometricCalibration& calibration);

// Log of the share of the light that lens and spread leave of a surface in this direction: 0 or less, by `ray` in the
// camera, of any length. A direction that gets none (90 degrees off the optical axis and more, with vignetting) has
// NaN.
double LogFalloff(const PhotometricCalibration& calibration, const Eigen::Vector3d& ray);

// Log of the distance of a surface whose light has this brightness (gray levels, 0 to 255), up to one constant for an
// image: the light at the camera falls off with the square of the distance. NaN for a brightness that is not above 0.
double LogDistanceFromLight(const PhotometricCalibration& calibration, double brightness, const Eigen::Vector3d& ray);

}  // namespace pliant
