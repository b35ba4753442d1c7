// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/two_view/opengv_relative_pose.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>
#include <opengv/sac/Lmeds.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac/SampleConsensusProblem.hpp>

#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/estimation/two_view/two_view_refinement.h"
#include "pliant/geometry/decompositions.h"
#include "pliant/geometry/essential.h"

namespace pliant {
namespace {

using Rays = std::span<const Eigen::Vector3d>;
namespace gv = opengv::relative_pose;

// A complex solution whose imaginary part is larger than this share of the real one is none.
constexpr double kRealShare = 1e-6;
// Of a better motion on its inliers; more inliers make the next round better.
constexpr int kLocalRounds = 2;
constexpr int kLocalIterations = 10;

// OpenGV's essential matrices are f0' E f1 = 0, ours f1' E f0 = 0. The translation's sign is free here.
void AddMotion(const Eigen::Matrix3d& opengv_essential, std::vector<Rigid3>* motions) {
  const auto decomposed = DecomposeEssential(opengv_essential.transpose());
  if (decomposed.ok()) motions->emplace_back(decomposed->rotations[0], decomposed->translation);
}

// A hypothesis is scored on at most this many correspondences: beyond it the time grows and the choice does not change.
constexpr std::size_t kMaxScored = 200;

// What OpenGV's robust loops sample and score: motions from a few pairs of rays, scored by the epipolar error
// (docs/method.md, eq. I1).
class RelativePoseProblem final : public opengv::sac::SampleConsensusProblem<Rigid3> {
 public:
  // Takes the rays as they are: unit vectors, of equal number. A sample's solutions, and the two signs of a
  // translation, are told apart by the errors of the pairs that agree with them (AgreesWithMotion): where the views
  // are near to each other, nearly all pairs agree with everything.
  RelativePoseProblem(opengv::bearingVectors_t rays0, opengv::bearingVectors_t rays1, double focal_px,
                      const RelativePoseOptions& options);

  // The error (|I1|, radians) of a pair that agrees with a motion is at most this.
  double Threshold() const;

  int getSampleSize() const override { return SampleSize(options_.solver); }
  bool computeModelCoefficients(const std::vector<int>& sample, Rigid3& cam1_from_cam0) const override;
  void optimizeModelCoefficients(const std::vector<int>& inliers, const Rigid3& start, Rigid3& refined) override;
  void getSelectedDistancesToModel(const Rigid3& cam1_from_cam0, const std::vector<int>& indices,
                                   std::vector<double>& errors_rad) const override;

 private:
  std::vector<Rigid3> MotionsThrough(const std::vector<int>& sample) const;
  Rigid3 MotionWithRotation(const Eigen::Matrix3d& cam0_from_cam1, const std::vector<int>& sample) const;
  struct Candidate {
    Rigid3 cam1_from_cam0;
    std::vector<int> inliers;
    double cost = std::numeric_limits<double>::infinity();  // squared errors, each at most the threshold's
  };
  Candidate Scored(const Rigid3& motion_of_any_sign) const;
  Rigid3 Refined(const std::vector<int>& inliers, const Rigid3& start) const;

  opengv::bearingVectors_t rays0_;
  opengv::bearingVectors_t rays1_;
  opengv::relative_pose::CentralRelativeAdapter adapter_;  // keeps references to both
  double focal_px_;
  double max_error_rad_;  // of one view
  RelativePoseOptions options_;
  mutable std::size_t most_inliers_ = 0;  // of any motion so far, for kLocal
};

RelativePoseProblem::RelativePoseProblem(opengv::bearingVectors_t rays0, opengv::bearingVectors_t rays1,
                                         double focal_px, const RelativePoseOptions& options)
    : SampleConsensusProblem<Rigid3>(/*randomSeed=*/false),
      rays0_(std::move(rays0)),
      rays1_(std::move(rays1)),
      adapter_(rays0_, rays1_),
      focal_px_(focal_px),
      max_error_rad_(std::atan(options.max_error_px / focal_px)),
      options_(options) {
  setUniformIndices(static_cast<int>(rays0_.size()));
  if (options_.solver != RelativePoseSolver::kEigensolver) return;
  const auto rotation = FitRotation(rays0_, rays1_, focal_px_, options_.max_error_px);  // where it starts from
  if (rotation.ok()) adapter_.setR12(rotation->cam1_from_cam0.toRotationMatrix().transpose());
}

double RelativePoseProblem::Threshold() const { return std::sqrt(2.0) * max_error_rad_; }

bool RelativePoseProblem::computeModelCoefficients(const std::vector<int>& sample, Rigid3& cam1_from_cam0) const {
  Candidate best;
  for (const Rigid3& motion : MotionsThrough(sample)) {
    if (!motion.rotation.coeffs().allFinite() || !motion.translation.allFinite()) continue;
    Candidate candidate = Scored(motion);
    if (candidate.cost < best.cost) best = std::move(candidate);
  }
  if (options_.robust == RobustLoop::kLocal && best.inliers.size() > most_inliers_) {
    for (int round = 0; round < kLocalRounds; ++round) {
      Candidate refined = Scored(Refined(best.inliers, best.cam1_from_cam0));
      if (!(refined.cost < best.cost)) break;
      best = std::move(refined);
    }
    most_inliers_ = best.inliers.size();
  }
  cam1_from_cam0 = best.cam1_from_cam0;
  return !best.inliers.empty();
}

void RelativePoseProblem::optimizeModelCoefficients(const std::vector<int>& inliers, const Rigid3& start,
                                                    Rigid3& refined) {
  refined = Refined(inliers, start);
}

void RelativePoseProblem::getSelectedDistancesToModel(const Rigid3& cam1_from_cam0, const std::vector<int>& indices,
                                                      std::vector<double>& errors_rad) const {
  errors_rad.clear();
  for (const int i : indices) {
    const auto k = static_cast<std::size_t>(i);
    const double error = std::abs(SampsonErrorRad(cam1_from_cam0, rays0_[k], rays1_[k]));
    const bool behind = error <= Threshold() && !MeetInFront(cam1_from_cam0, rays0_[k], rays1_[k], max_error_rad_);
    errors_rad.push_back(behind ? std::numbers::pi : error);
  }
}

std::vector<Rigid3> RelativePoseProblem::MotionsThrough(const std::vector<int>& sample) const {
  std::vector<Rigid3> motions;
  switch (options_.solver) {
    case RelativePoseSolver::kNister:
      for (const Eigen::Matrix3d& essential : gv::fivept_nister(adapter_, sample)) AddMotion(essential, &motions);
      break;
    case RelativePoseSolver::kStewenius:
      for (const auto& essential : gv::fivept_stewenius(adapter_, sample))
        if (essential.imag().norm() <= kRealShare * essential.real().norm()) AddMotion(essential.real(), &motions);
      break;
    case RelativePoseSolver::kKneip:
      for (const Eigen::Matrix3d& rotation : gv::fivept_kneip(adapter_, sample))
        motions.push_back(MotionWithRotation(rotation, sample));
      break;
    case RelativePoseSolver::kSevenPoint:
      for (const Eigen::Matrix3d& essential : gv::sevenpt(adapter_, sample)) AddMotion(essential, &motions);
      break;
    case RelativePoseSolver::kEightPoint:
      AddMotion(gv::eightpt(adapter_, sample), &motions);
      break;
    case RelativePoseSolver::kEigensolver:
      motions.push_back(MotionWithRotation(gv::eigensolver(adapter_, sample), sample));
      break;
    default:
      assert(false && "a solver with a loop of its own");
  }
  return motions;
}

// With the rotation known every pair's epipolar plane holds the translation: it is what all their normals miss.
Rigid3 RelativePoseProblem::MotionWithRotation(const Eigen::Matrix3d& cam0_from_cam1,
                                               const std::vector<int>& sample) const {
  const Eigen::Matrix3d rotation = cam0_from_cam1.transpose();
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  for (const int i : sample) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d normal = (rotation * rays0_[k]).cross(rays1_[k]);
    normals += normal * normal.transpose();
  }
  return {rotation, SvdOf(normals).v.col(2)};
}

RelativePoseProblem::Candidate RelativePoseProblem::Scored(const Rigid3& motion_of_any_sign) const {
  const double largest = std::pow(Threshold(), 2);
  std::vector<std::pair<int, double>> near;  // to the epipolar planes, which are those of both signs
  for (std::size_t i = 0; i < rays0_.size(); ++i)
    if (const double squared = std::pow(SampsonErrorRad(motion_of_any_sign, rays0_[i], rays1_[i]), 2);
        squared <= largest)
      near.emplace_back(static_cast<int>(i), squared);
  Candidate best;
  for (const double sign : {1.0, -1.0}) {
    Candidate candidate{{motion_of_any_sign.rotation, sign * motion_of_any_sign.translation}, {}, 0.0};
    candidate.cost = largest * static_cast<double>(rays0_.size());
    for (const auto& [i, squared] : near) {
      const auto k = static_cast<std::size_t>(i);
      if (!MeetInFront(candidate.cam1_from_cam0, rays0_[k], rays1_[k], max_error_rad_)) continue;
      candidate.inliers.push_back(i);
      candidate.cost += squared - largest;
    }
    if (candidate.cost < best.cost) best = std::move(candidate);
  }
  return best;
}

Rigid3 RelativePoseProblem::Refined(const std::vector<int>& inliers, const Rigid3& start) const {
  std::vector<Eigen::Vector3d> rays0;
  std::vector<Eigen::Vector3d> rays1;
  for (const int i : inliers) {
    rays0.push_back(rays0_[static_cast<std::size_t>(i)]);
    rays1.push_back(rays1_[static_cast<std::size_t>(i)]);
  }
  const auto refined = RefineTwoView(start, rays0, rays1, focal_px_,
                                     {.loss_scale_px = options_.max_error_px, .max_iterations = kLocalIterations});
  return refined.ok() ? refined->cam1_from_cam0 : start;
}

// The first `count` entries of a random order of 0 .. size - 1 (Fisher and Yates).
std::vector<std::size_t> RandomOrder(std::size_t size, std::size_t count, Random random) {
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = 0; i < count; ++i)
    std::swap(order[i], order[i + static_cast<std::size_t>(random.Index(static_cast<int>(size - i)))]);
  order.resize(count);
  return order;
}

// The C library's generator, which OpenGV's eigensolver asks, at a fixed seed; the host's state comes back at the end.
// There is one generator in a process: the others wait.
class FixedCRandom {
 public:
  FixedCRandom() : lock_(Mutex()), before_(initstate(1U, state_.data(), state_.size())) {}
  ~FixedCRandom() { setstate(before_); }
  FixedCRandom(const FixedCRandom&) = delete;
  FixedCRandom& operator=(const FixedCRandom&) = delete;

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }

  std::unique_lock<std::mutex> lock_;
  std::array<char, 128> state_{};
  char* before_;
};

// The samples after which one is clean with the wanted confidence when half of the pairs are: LMedS does not know more.
int SamplesForHalf(int sample_size, const RelativePoseOptions& options) {
  const double needed = std::log(1.0 - options.confidence) / std::log(1.0 - std::pow(0.5, sample_size));
  return static_cast<int>(std::min<double>(std::ceil(needed), options.max_iterations));
}

}  // namespace

int SampleSize(RelativePoseSolver solver) {
  switch (solver) {
    case RelativePoseSolver::kHomography:
      return 4;
    case RelativePoseSolver::kSevenPoint:
      return 7;
    case RelativePoseSolver::kEightPoint:
    case RelativePoseSolver::kEigensolver:
      return 8;
    case RelativePoseSolver::kRotationOnly:
      return 0;
    default:
      return 5;
  }
}

std::optional<Rigid3> SampleMotion(Rays rays0, Rays rays1, double focal_px, Random random,
                                   const RelativePoseOptions& options) {
  opengv::bearingVectors_t scored0;
  opengv::bearingVectors_t scored1;
  for (const std::size_t i : RandomOrder(rays0.size(), std::min(rays0.size(), kMaxScored), random)) {
    scored0.push_back(rays0[i]);
    scored1.push_back(rays1[i]);
  }
  const auto problem = std::make_shared<RelativePoseProblem>(std::move(scored0), std::move(scored1), focal_px, options);
  const auto run = [&](auto loop) -> std::optional<Rigid3> {
    loop.sac_model_ = problem;
    if (!loop.computeModel()) return std::nullopt;
    return loop.model_coefficients_;
  };
  std::optional<FixedCRandom> fixed;
  if (options.solver == RelativePoseSolver::kEigensolver) fixed.emplace();
  if (options.robust == RobustLoop::kLmeds)
    return run(opengv::sac::Lmeds<RelativePoseProblem>(SamplesForHalf(problem->getSampleSize(), options),
                                                       problem->Threshold(), options.confidence));
  return run(
      opengv::sac::Ransac<RelativePoseProblem>(options.max_iterations, problem->Threshold(), options.confidence));
}

Result<Rigid3> RefineMotionByOpengv(const Rigid3& start, Rays rays0, Rays rays1) {
  const opengv::bearingVectors_t bearings0(rays0.begin(), rays0.end());
  const opengv::bearingVectors_t bearings1(rays1.begin(), rays1.end());
  opengv::relative_pose::CentralRelativeAdapter adapter(bearings0, bearings1);  // keeps references to both
  // One call stops after a few steps, wherever it is: with a length that is free and numeric derivatives it creeps.
  constexpr int kCalls = 10;
  constexpr double kAtRest = 1e-6;
  Rigid3 cam0_from_cam1 = start.Inverse();
  cam0_from_cam1.translation.normalize();
  for (int call = 0; call < kCalls; ++call) {
    adapter.setR12(cam0_from_cam1.RotationMatrix());
    adapter.sett12(cam0_from_cam1.translation);
    const opengv::transformation_t found = opengv::relative_pose::optimize_nonlinear(adapter);
    if (!found.allFinite() || !(found.col(3).norm() > 0.0))
      return Status(ErrorCode::kDegenerate, "OpenGV's refinement of the relative pose ended without a motion");
    const Rigid3 next(Eigen::Matrix3d(found.leftCols<3>()), found.col(3).normalized());
    const double change = (next.translation - cam0_from_cam1.translation).norm() +
                          RotationAngle(next.rotation * cam0_from_cam1.rotation.conjugate());
    cam0_from_cam1 = next;
    if (change < kAtRest) break;
  }
  return cam0_from_cam1.Inverse();
}

}  // namespace pliant
