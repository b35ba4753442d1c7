// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/calibrate_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "calibration/board_problem.h"
#include "calibration/choose_model.h"
#include "calibration/pixel_accuracy.h"
#include "pliant/base/parallel.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

// Horizontal fields of view that the estimation begins with.
constexpr std::array kPerspectiveStarts_deg = {20.0, 35.0, 50.0, 65.0, 80.0, 95.0, 110.0, 130.0};
constexpr std::array kFisheyeStarts_deg = {50.0, 80.0, 110.0, 140.0, 170.0, 200.0};
constexpr double kWidestPerspective_deg = 160;
constexpr int kStartIterations = 15;
constexpr int kEvenAndOdd = 2;
constexpr double kSmallestTilt_deg = 10;  // less is not known from a board's corners
constexpr double kAsGood = 1.1;           // times the error of another model

struct CalibrationInput {
  std::vector<Eigen::Vector3d> points;
  std::span<const BoardView> views;
  int width = 0;
  int height = 0;
  int threads = 1;
};

constexpr std::array kModels = {CameraModelId::kSimplePinhole, CameraModelId::kPinhole, CameraModelId::kSimpleRadial,
                                CameraModelId::kRadial,        CameraModelId::kOpenCv,  CameraModelId::kOpenCvFisheye};

std::vector<CameraModelId> ModelsOf(ModelChoice choice, Lenses lenses) {
  if (choice == ModelChoice::kAuto) {
    std::vector<CameraModelId> models(kModels.begin(), kModels.end());
    if (lenses == Lenses::kPerspective) std::erase(models, CameraModelId::kOpenCvFisheye);
    return models;
  }
  return {kModels[static_cast<std::size_t>(choice) - 1]};
}

// The parameters of `model` that say the same as f, cx and cy, without distortion.
std::vector<double> PinholeParams(CameraModelId model, double focal_px, double cx, double cy) {
  std::vector<double> params(static_cast<std::size_t>(NumParams(model)), 0.0);
  const auto first = static_cast<std::size_t>(NumPinholeParams(model));
  std::fill_n(params.begin(), first - 2, focal_px);
  params[first - 2] = cx;
  params[first - 1] = cy;
  return params;
}

double MedianError(const CalibrationInput& input, const BoardFit& fit) {
  std::vector<double> errors;
  for (std::size_t view = 0; view < input.views.size(); ++view)
    for (const Eigen::Vector2d& residual : Residuals(input.points, input.views[view], fit, fit.poses[view]))
      errors.push_back(residual.norm());
  return Median(errors);
}

// A perspective model of a lens that is wider than any drifts to ever shorter focal lengths.
bool IsPlausible(const CalibrationInput& input, const BoardFit& fit) {
  if (fit.model == CameraModelId::kOpenCvFisheye) return fit.params.front() > 0;
  return fit.params.front() > 0.5 * input.width / std::tan(0.5 * kWidestPerspective_deg / kDegPerRad);
}

// The best of fits that begin with several fields of view. Lenses without and with strong distortion agree near their
// axis, so a radial model of one parameter is enough to begin with; a fisheye's start is its own first term.
std::optional<BoardFit> FitFromStarts(const CalibrationInput& input, CameraModelId model,
                                      std::span<const double> fields_deg) {
  std::vector<std::optional<BoardFit>> fits(fields_deg.size());
  std::vector<double> errors(fields_deg.size(), std::numeric_limits<double>::infinity());
  const double cx = 0.5 * (input.width - 1);
  const double cy = 0.5 * (input.height - 1);
  const bool is_fisheye = model == CameraModelId::kOpenCvFisheye;
  ParallelFor(
      static_cast<int>(fields_deg.size()), input.threads,
      [&](int i) {
        const auto idx = static_cast<std::size_t>(i);
        const double half_rad = 0.5 * fields_deg[idx] / kDegPerRad;
        const double focal_px = 0.5 * input.width / (is_fisheye ? half_rad : std::tan(half_rad));
        BoardFit fit{model, PinholeParams(model, focal_px, cx, cy), NumPinholeParams(model) + 1, {}};
        const auto camera = Camera::Create(model, input.width, input.height, fit.params);
        if (!camera.ok() || !StartPoses(*camera, input.points, input.views, &fit.poses)) return;
        if (!Solve(input.points, input.views, {}, Intrinsics::kFree, kStartIterations, &fit)) return;
        if (!IsPlausible(input, fit)) return;
        errors[idx] = MedianError(input, fit);
        fits[idx] = std::move(fit);
      },
      1);
  const auto best = std::min_element(errors.begin(), errors.end());
  if (!std::isfinite(*best)) return std::nullopt;
  return std::move(fits[static_cast<std::size_t>(best - errors.begin())]);
}

// A perspective fit in the parameters of another perspective model, all of them free.
BoardFit Converted(const BoardFit& radial, CameraModelId model) {
  BoardFit fit{model, PinholeParams(model, radial.params[0], radial.params[1], radial.params[2]), NumParams(model),
               radial.poses};
  const auto first = static_cast<std::size_t>(NumPinholeParams(model));
  if (fit.params.size() > first) fit.params[first] = radial.params[3];
  return fit;
}

Status TellOfModel(const JobProgress& progress, std::string_view task, std::size_t model, std::size_t models) {
  return Tell(progress, task, static_cast<int>(model), static_cast<int>(models));
}

// One fit a model; of a fisheye, whose last coefficients only a view up to the image's border determines, also with
// fewer of them.
Result<std::vector<BoardFit>> FirstFits(const CalibrationInput& input, const std::vector<CameraModelId>& models,
                                        const JobProgress& progress) {
  std::vector<BoardFit> starts;
  std::optional<BoardFit> radial;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (Status status = TellOfModel(progress, "start", i, models.size()); !status.ok()) return status;
    if (models[i] == CameraModelId::kOpenCvFisheye) {
      const auto fisheye = FitFromStarts(input, models[i], kFisheyeStarts_deg);
      for (const int num_free : {5, 6, 8}) {
        if (!fisheye) break;
        starts.push_back(*fisheye);
        starts.back().num_free = num_free;
      }
      continue;
    }
    if (!radial) radial = FitFromStarts(input, CameraModelId::kSimpleRadial, kPerspectiveStarts_deg);
    if (radial) starts.push_back(Converted(*radial, models[i]));
  }
  std::vector<BoardFit> fits;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (Status status = TellOfModel(progress, "fit", i, starts.size()); !status.ok()) return status;
    if (Solve(input.points, input.views, {}, Intrinsics::kFree, kMaxIterations, &starts[i]) &&
        IsPlausible(input, starts[i]))
      fits.push_back(std::move(starts[i]));
  }
  return fits;
}

double ViewRms(const CalibrationInput& input, const BoardView& view, const BoardFit& fit, const BoardPose& pose) {
  return RmsLength(Residuals(input.points, view, fit, pose));
}

// The views whose error is much larger than the others'.
std::vector<bool> Outliers(const CalibrationInput& input, const BoardFit& fit) {
  std::vector<double> errors;
  for (std::size_t view = 0; view < input.views.size(); ++view)
    errors.push_back(ViewRms(input, input.views[view], fit, fit.poses[view]));
  const double bound = kOutlierFactor * Median(errors);
  std::vector<bool> outliers;
  for (const double error : errors) outliers.push_back(error > bound);
  return outliers;
}

int NumUsed(const std::vector<bool>& without) {
  return static_cast<int>(std::count(without.begin(), without.end(), false));
}

// The points of a view whose place in it is even, or odd.
BoardView HalfOf(const BoardView& view, int parity) {
  BoardView half;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    if (static_cast<int>(i % kEvenAndOdd) != parity) continue;
    half.point_ids.push_back(view.point_ids[i]);
    half.pixels.push_back(view.pixels[i]);
  }
  return half;
}

// The error of one view under parameters that do not know it: each half of its points under the pose of the other.
double PredictionError(const CalibrationInput& input, const BoardView& view, const BoardFit& fit,
                       const BoardPose& start) {
  std::vector<double> errors;
  for (int parity = 0; parity < kEvenAndOdd; ++parity) {
    const BoardView half = HalfOf(view, parity);
    BoardFit alone{fit.model, fit.params, fit.num_free, {start}};
    if (!Solve(input.points, {&half, 1}, {}, Intrinsics::kHeld, kMaxIterations, &alone))
      return std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& residual :
         Residuals(input.points, HalfOf(view, 1 - parity), alone, alone.poses.front()))
      errors.push_back(residual.norm());
  }
  return Rms(errors);
}

// What fits without one group of views after the other say of a model.
struct GroupFits {
  std::vector<double> prediction_errors_px;  // a used view each
  Eigen::MatrixXd covariance;                // of the parameters, by the jackknife
  double student_factor = 1;                 // of their number
};

std::optional<GroupFits> FitGroups(const CalibrationInput& input, const std::vector<bool>& outliers,
                                   const BoardFit& fit) {
  std::vector<std::size_t> used;
  for (std::size_t view = 0; view < outliers.size(); ++view)
    if (!outliers[view]) used.push_back(view);
  const int groups = std::min<int>(kMaxGroups, static_cast<int>(used.size()));
  std::vector<std::vector<double>> params(static_cast<std::size_t>(groups));
  std::vector<double> errors(used.size(), std::numeric_limits<double>::infinity());
  ParallelFor(
      groups, input.threads,
      [&](int group) {
        std::vector<bool> without = outliers;
        for (std::size_t i = static_cast<std::size_t>(group); i < used.size(); i += static_cast<std::size_t>(groups))
          without[used[i]] = true;
        BoardFit others = fit;
        if (!Solve(input.points, input.views, without, Intrinsics::kFree, kMaxIterations, &others)) return;
        for (std::size_t i = static_cast<std::size_t>(group); i < used.size(); i += static_cast<std::size_t>(groups))
          errors[i] = PredictionError(input, input.views[used[i]], others, fit.poses[used[i]]);
        params[static_cast<std::size_t>(group)] = others.params;
      },
      1);
  for (const std::vector<double>& group : params)
    if (group.empty()) return std::nullopt;
  GroupFits result;
  result.prediction_errors_px = errors;
  const auto num_params = static_cast<Eigen::Index>(fit.params.size());
  Eigen::MatrixXd by_group(num_params, groups);
  for (int group = 0; group < groups; ++group)
    by_group.col(group) = Eigen::Map<const Eigen::VectorXd>(params[static_cast<std::size_t>(group)].data(), num_params);
  const Eigen::MatrixXd from_mean = by_group.colwise() - by_group.rowwise().mean();
  result.covariance = (groups - 1.0) / groups * from_mean * from_mean.transpose();
  result.student_factor = StudentFactor(groups);
  return result;
}

std::optional<ModelCandidate> Evaluate(const CalibrationInput& input, const std::vector<bool>& outliers, BoardFit fit) {
  if (!Solve(input.points, input.views, outliers, Intrinsics::kFree, kMaxIterations, &fit)) return std::nullopt;
  auto camera = Camera::Create(fit.model, input.width, input.height, fit.params);
  if (!camera.ok()) return std::nullopt;
  const auto knows_focal_length = [&](const Eigen::MatrixXd& of_params) {
    return std::sqrt(of_params(0, 0)) < kLargestFocalLengthSigma * fit.params.front();
  };
  ParamsCovariance covariance{Covariance(input.points, input.views, outliers, fit), {}};
  if (covariance.of_points.size() == 0 || !knows_focal_length(covariance.of_points)) return std::nullopt;
  auto groups = FitGroups(input, outliers, fit);
  if (!groups) return std::nullopt;
  const double widening = groups->student_factor * groups->student_factor;
  covariance.of_points *= widening;
  covariance.of_views = widening * groups->covariance;
  if (!knows_focal_length(covariance.of_points) || !knows_focal_length(covariance.of_views)) return std::nullopt;
  return ModelCandidate{std::move(fit), *std::move(camera), std::move(covariance),
                        std::move(groups->prediction_errors_px)};
}

// The focal length of the first half of the views that are used, and of the second, all other parameters held.
std::vector<FocalLengthEstimate> HalfFocalLengths(const CalibrationInput& input, const std::vector<bool>& outliers,
                                                  const BoardFit& fit) {
  const int used = NumUsed(outliers);
  if (used < 2 * kFewestCalibrationViews) return {};
  std::vector<FocalLengthEstimate> halves;
  for (const bool is_first : {true, false}) {
    std::vector<bool> without = outliers;
    int place = 0;
    for (std::size_t view = 0; view < outliers.size(); ++view)
      if (!outliers[view]) without[view] = (place++ < used / 2) != is_first;
    BoardFit half = fit;
    half.num_free = NumPinholeParams(fit.model) - 2;
    if (!Solve(input.points, input.views, without, Intrinsics::kFree, kMaxIterations, &half)) return {};
    const Eigen::MatrixXd covariance = Covariance(input.points, input.views, without, half);
    if (covariance.size() == 0) return {};
    halves.push_back({half.params.front(), std::sqrt(covariance(0, 0))});
  }
  return halves;
}

// Of the board against the image: one that is parallel to it says nothing of the focal length, wherever it is seen.
double TiltDeg(const Rigid3& cam_from_board) {
  const Eigen::Vector3d normal = cam_from_board.rotation * Eigen::Vector3d::UnitZ();
  return kDegPerRad * std::acos(std::min(1.0, std::abs(normal.z())));
}

std::vector<FittedView> FittedViews(const CalibrationInput& input, const std::vector<bool>& outliers,
                                    const BoardFit& fit) {
  std::vector<FittedView> views;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    BoardPose pose = fit.poses[i];
    if (outliers[i]) {
      BoardFit alone{fit.model, fit.params, fit.num_free, {pose}};
      if (Solve(input.points, input.views.subspan(i, 1), {}, Intrinsics::kHeld, kMaxIterations, &alone))
        pose = alone.poses.front();
    }
    FittedView view;
    view.is_outlier = outliers[i];
    view.cam_from_board = ToRigid3(pose);
    view.residuals_px = Residuals(input.points, input.views[i], fit, pose);
    view.rms_px = ViewRms(input, input.views[i], fit, pose);
    view.tilt_deg = TiltDeg(view.cam_from_board);
    views.push_back(std::move(view));
  }
  return views;
}

// Whether the chosen model knows the focal length by its own curves alone: a fisheye's, of images that perspective
// models explain as well without knowing it, or any model's where no board was tilted.
bool IsGuess(const CalibrationInput& input, const std::vector<BoardFit>& fits,
             const std::vector<ModelCandidate>& candidates, const CameraCalibration& calibration) {
  const auto is_fisheye = [](const auto& fit) { return fit.model == CameraModelId::kOpenCvFisheye; };
  const auto tilted = std::ranges::count_if(
      calibration.views, [](const FittedView& view) { return !view.is_outlier && view.tilt_deg >= kSmallestTilt_deg; });
  if (tilted == 0) return true;
  if (!std::ranges::all_of(candidates, [&](const ModelCandidate& candidate) { return is_fisheye(candidate.fit); }))
    return false;
  double perspective_px = std::numeric_limits<double>::infinity();
  double fisheye_px = std::numeric_limits<double>::infinity();
  for (const BoardFit& fit : fits) {
    double& least_px = is_fisheye(fit) ? fisheye_px : perspective_px;
    least_px = std::min(least_px, MedianError(input, fit));
  }
  return perspective_px < kAsGood * fisheye_px;
}

double RmsOf(const std::vector<FittedView>& views) {
  std::vector<double> errors;
  for (const FittedView& view : views)
    if (!view.is_outlier)
      for (const Eigen::Vector2d& residual : view.residuals_px) errors.push_back(residual.norm());
  return Rms(errors);
}

Status TooFew(std::size_t views) {
  const std::string seen = views <= 1 ? "the board is seen in one image, or in images that are alike"
                                      : "the board is seen in " + std::to_string(views) + " images that differ";
  return {ErrorCode::kInsufficient, seen + ", and " + std::to_string(kFewestCalibrationViews) +
                                        " are the least; add images of the board from other sides"};
}

}  // namespace

Result<CameraCalibration> CalibrateCamera(const CalibrationBoard& board, std::span<const BoardView> views, int width,
                                          int height, ModelChoice model, int threads, Lenses lenses,
                                          const JobProgress& progress) {
  if (views.size() < kFewestCalibrationViews) return TooFew(views.size());
  const CalibrationInput input{board.Points(), views, width, height, threads};
  const Status undetermined(ErrorCode::kInsufficient,
                            "the images do not determine the focal length; add images in which the board is tilted by "
                            "30 to 45 degrees, in several directions, and fills other parts of the image");

  const auto fits = FirstFits(input, ModelsOf(model, lenses), progress);
  if (!fits.ok()) return fits.status();

  // Outliers are those of the fit with the smallest error.
  if (fits->empty()) return undetermined;
  const auto best = std::min_element(fits->begin(), fits->end(), [&](const auto& a, const auto& b) {
    return MedianError(input, a) < MedianError(input, b);
  });
  const std::vector<bool> outliers = Outliers(input, *best);
  if (const int used = NumUsed(outliers); used < kFewestCalibrationViews)
    return Status(ErrorCode::kInsufficient,
                  "only " + std::to_string(used) + " of the " + std::to_string(views.size()) +
                      " images that differ fit one camera; look for blur, for a board that is not flat, and for zoom "
                      "or focus that changed");

  std::vector<ModelCandidate> candidates;
  for (std::size_t i = 0; i < fits->size(); ++i) {
    if (Status status = TellOfModel(progress, "check", i, fits->size()); !status.ok()) return status;
    if (auto candidate = Evaluate(input, outliers, (*fits)[i])) candidates.push_back(*std::move(candidate));
  }
  if (candidates.empty()) return undetermined;
  ModelChosen choice = ChooseModel(candidates);
  const ModelCandidate& chosen = candidates[choice.chosen];
  CameraCalibration calibration{.camera = chosen.camera};
  calibration.sigmas = chosen.covariance.Sigmas();
  calibration.views = FittedViews(input, outliers, chosen.fit);
  calibration.rms_px = RmsOf(calibration.views);
  calibration.border = BorderAccuracy(candidates, choice);
  calibration.half_focal_lengths = HalfFocalLengths(input, outliers, chosen.fit);
  calibration.held_out = std::move(choice.errors);
  if (IsGuess(input, *fits, candidates, calibration)) return undetermined;
  return calibration;
}

}  // namespace pliant
