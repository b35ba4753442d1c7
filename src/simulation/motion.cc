// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/motion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "simulation/surface.h"

namespace pliant::simulation {
namespace {

// The upper lobe's direction of the wave.
Eigen::Vector3d LobeDirection(const SimulationOptions::Deformation& options) {
  const double rad = options.lobe_direction_deg * std::numbers::pi / 180.0;
  return {std::sin(rad), std::cos(rad), 0.0};
}

std::string Rounded(double value) { return FormatDouble(std::round(100.0 * value) / 100.0); }

}  // namespace

Motion::Motion(const SimulationOptions::Deformation& options, double swell_radius_mm, const Poke& poke)
    : omega_rad_s_(options.omega_rad_s),
      wavenumber_rad_mm_(2.0 * std::numbers::pi / options.wavelength_mm),
      breathing_rad_s_(2.0 * std::numbers::pi / options.breathing_period_s),
      poke_mm_(options.poke_mm),
      poke_radius_mm_(options.poke_radius_mm),
      poke_rad_s_(std::numbers::pi / options.poke_period_s),
      poke_(poke) {
  parts_[0] = {options.amplitude_mm, Eigen::Vector3d::UnitY(), options.breathing_mm / swell_radius_mm, 0.0};
  parts_[1] = {options.lobe_share * parts_[0].wave_mm, LobeDirection(options),
               options.lobe_share * parts_[0].swell_share, options.lobe_phase_deg * std::numbers::pi / 180.0};
}

bool Motion::rigid() const { return parts_[0].wave_mm == 0.0 && parts_[0].swell_share == 0.0 && poke_mm_ == 0.0; }

double Motion::SwellShare(const Part& part, double time_s) const {
  return part.swell_share * std::sin(breathing_rad_s_ * time_s + part.phase_rad);
}

double Motion::PokeMm(const RestPoint& point, double time_s) const {
  const double push = std::sin(poke_rad_s_ * time_s);
  const double distance_sq = (point.position - poke_.position).squaredNorm();
  return poke_mm_ * push * push * std::exp(-0.5 * distance_sq / (poke_radius_mm_ * poke_radius_mm_));
}

Eigen::Vector3d Motion::Position(const RestPoint& point, double time_s) const {
  if (rigid()) return point.position;
  const Part& part = parts_[point.part];
  Eigen::Vector3d moved = point.position;
  moved += part.wave_mm * std::sin(omega_rad_s_ * time_s + wavenumber_rad_mm_ * point.position.sum() + part.phase_rad) *
           part.wave_direction;
  if (part.swell_share != 0) moved += SwellShare(part, time_s) * (point.position - point.swell_center);
  if (poke_mm_ != 0) moved += PokeMm(point, time_s) * poke_.direction;
  return moved;
}

Eigen::Matrix3d Motion::Gradient(const RestPoint& point, double time_s) const {
  const Part& part = parts_[point.part];
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
  const double slope = part.wave_mm * wavenumber_rad_mm_ *
                       std::cos(omega_rad_s_ * time_s + wavenumber_rad_mm_ * point.position.sum() + part.phase_rad);
  gradient += slope * part.wave_direction * Eigen::RowVector3d::Ones();
  if (part.swell_share != 0) {
    gradient +=
        SwellShare(part, time_s) * (Eigen::Matrix3d::Identity() - point.swell_along * point.swell_along.transpose());
  }
  if (poke_mm_ != 0) {
    gradient -= PokeMm(point, time_s) / (poke_radius_mm_ * poke_radius_mm_) * poke_.direction *
                (point.position - poke_.position).transpose();
  }
  return gradient;
}

Eigen::Vector3d Motion::Normal(const Eigen::Vector3d& normal_at_rest, const RestPoint& point, double time_s) const {
  if (rigid()) return normal_at_rest;
  // The matrix of cofactors is det(F) F^-T and needs no division.
  const Eigen::Matrix3d f = Gradient(point, time_s);
  return (normal_at_rest.x() * f.col(1).cross(f.col(2)) + normal_at_rest.y() * f.col(2).cross(f.col(0)) +
          normal_at_rest.z() * f.col(0).cross(f.col(1)))
      .normalized();
}

double Motion::LargestDisplacementMm(double swell_reach_mm) const {
  double largest = 0;
  for (const Part& part : parts_) largest = std::max(largest, part.wave_mm + part.swell_share * swell_reach_mm);
  return largest + std::abs(poke_mm_);
}

double Motion::LargestStepMm(double swell_reach_mm, double duration_s) const {
  // An oscillation's speed is at most its amplitude times its angular frequency; sin^2 turns at twice that of sin.
  const auto step = [duration_s](double rad_s) { return std::min(2.0, rad_s * duration_s); };
  double largest = 0;
  for (const Part& part : parts_)
    largest = std::max(largest,
                       part.wave_mm * step(omega_rad_s_) + part.swell_share * swell_reach_mm * step(breathing_rad_s_));
  return largest + std::abs(poke_mm_) * step(poke_rad_s_);
}

std::vector<std::string> DeformationWarnings(const SimulationOptions& options, const Motion& motion,
                                             std::span<const RestPoint> points, std::span<const double> times_s) {
  std::vector<std::string> warnings;
  if (motion.rigid()) return warnings;
  const SimulationOptions::Deformation& deformation = options.deformation;
  const double amplitude_times_k = deformation.amplitude_mm * 2.0 * std::numbers::pi / deformation.wavelength_mm;
  const double lobe_times_k = options.scene.kind == SceneKind::kLobes ? deformation.lobe_share * amplitude_times_k *
                                                                            std::abs(LobeDirection(deformation).sum())
                                                                      : 0.0;
  if (const double worst = std::max(amplitude_times_k, lobe_times_k); worst >= 1.0) {
    warnings.push_back("the deformation folds over: A k = " + Rounded(worst) +
                       ", and from 1 on the surface passes through itself; lower Deformation.amplitude_mm or raise "
                       "Deformation.wavelength_mm");
  } else {
    double least = 1.0;
    double when_s = 0;
    for (const double time_s : times_s) {
      for (const RestPoint& point : points) {
        const double determinant = motion.Gradient(point, time_s).determinant();
        if (determinant >= least) continue;
        least = determinant;
        when_s = time_s;
      }
    }
    if (least <= 0)
      warnings.push_back("the deformation folds over: the determinant of its gradient falls to " + Rounded(least) +
                         " (at " + Rounded(when_s) + " s, A k = " + Rounded(amplitude_times_k) +
                         "); lower Deformation.poke_mm, breathing_mm or amplitude_mm");
  }
  if (options.scene.kind == SceneKind::kLobes) {
    // How much nearer the lobes come: the difference of two oscillations of one frequency along y.
    const std::complex<double> upper =
        std::polar(deformation.lobe_share, deformation.lobe_phase_deg * std::numbers::pi / 180.0);
    const double approach_mm = deformation.amplitude_mm * std::abs(1.0 - upper * LobeDirection(deformation).y()) +
                               deformation.breathing_mm * std::abs(1.0 - upper);
    if (approach_mm >= LobeGapMm(options.scene))
      warnings.push_back("the lobes run into each other: they come " + Rounded(approach_mm) +
                         " mm nearer, and the gap between them is " + Rounded(LobeGapMm(options.scene)) +
                         " mm; raise Scene.lobe_step_mm or lower the amplitudes");
  }
  return warnings;
}

}  // namespace pliant::simulation
