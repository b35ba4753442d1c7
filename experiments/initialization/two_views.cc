// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// pliant_two_views: first maps from synthetic rays against exact truth, one row of CSV a trial. The maps are made by
// the library's own initializers, chosen by its own options, from the pixels of a scene of which everything is known.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cli/command_line.h"
#include "pliant/base/options.h"
#include "pliant/base/random.h"
#include "pliant/base/statistics.h"
#include "pliant/geometry/triangulation.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "support/synthetic_frames.h"
#include "support/synthetic_scene.h"

namespace pliant {

// What is wrong with the pixels themselves.
enum class PixelDefect {
  kNone,
  kNotANumber,  // every tenth point of the last frame
  kOneRay,      // all points of the reference have the same pixel
};
template <>
struct EnumNames<PixelDefect> {
  static constexpr std::array kNames = {std::pair{PixelDefect::kNone, std::string_view("none")},
                                        std::pair{PixelDefect::kNotANumber, std::string_view("not_a_number")},
                                        std::pair{PixelDefect::kOneRay, std::string_view("one_ray")}};
};

namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kFramesPerSecond = 30.0;

const cli::Manual kManual = {
    .command = "",
    .summary = "first maps from synthetic rays against exact truth",
    .text =
        "Makes scenes of which everything is known, hands the pixels of some frames to an initializer of pliant track, "
        "and compares the map with the truth. Every seed is one trial: another surface, other noise, other outliers, "
        "other samples.\n\n"
        "Leaves --output_path: a CSV file with one row a trial. First come the options of the scene, the seed and the "
        "choices of the initializer. Then status: made or refused, and the reason in a sentence. Then what was "
        "measured: inlier_share of the correspondences; rotation_deg and direction_deg, the errors of the last "
        "camera's rotation and of its translation's direction; of the map's points median_depth_error and "
        "depth_rmse, relative errors of the distance in the reference after the median scale; null_depth_error, the "
        "median of the same points all at one distance; points, and how many of them are outliers; and ms, the time "
        "of the initializer. What does not apply is empty.",
    .examples = {"pliant_two_views --seeds 20 --output_path rows.csv --Init.solver kneip --Scene.outlier_share 0.5",
                 "pliant_two_views --seeds 5 --output_path rows.csv --Init.method window --Scene.views 11 "
                 "--Scene.gap_frames 40 --Scene.amplitude_mm 2.5"},
    .program = "pliant_two_views"};

struct Setting {
  test::SceneOptions scene;
  int gap_frames = 20;
  double speed_mm_s = 15.0;
  double turn_deg_s = 5.0;
  int views = 2;
  PixelDefect defect = PixelDefect::kNone;
  InitOptions init;

  Setting() {
    scene.motion = test::Motion::kSideways;
    scene.noise_px = 0.3;
    scene.outlier_share = 0.1;
    scene.light_sigma = 0.1;
    init.method = InitMethod::kGated;
    init.monocular.refinement = RigidRefinement::kTwoView;
  }

  void List(OptionTable& table) {
    table.BeginGroup("Scene", "what is seen, and how");
    table.AddChoice("surface", &scene.surface,
                    "tube from its axis, tilted and bumpy organ, flat plane, points anywhere");
    table.AddChoice("motion", &scene.motion, "of the camera");
    table.Add("amplitude_mm", &scene.wave.amplitude_mm, "mm", "of the wave that the points move in; 0: rigid", 0, 100);
    table.Add("wavelength_mm", &scene.wave.wavelength_mm, "mm", "along the sum of the coordinates", 1, 1e6);
    table.Add("omega_rad_s", &scene.wave.omega_rad_s, "rad/s", "of the wave", 0, 100);
    table.Add("gap_frames", &gap_frames, "frames", "from the reference to the last frame, at 30 a second", 1, 1000);
    table.Add("speed_mm_s", &speed_mm_s, "mm/s", "of the camera, where it moves", 0, 1000);
    table.Add("turn_deg_s", &turn_deg_s, "deg/s", "of the camera, unless it is still", 0, 360);
    table.Add("relief_mm", &scene.relief_mm, "mm", "of the bumps of tube and organ", 0, 15);
    table.Add("noise_px", &scene.noise_px, "px", "standard deviation of a pixel, in each direction", 0, 100);
    table.Add("outlier_share", &scene.outlier_share, "-", "of the points: anywhere in the image but in the reference",
              0, 1);
    table.Add("light_sigma", &scene.light_sigma, "-", "of the log distance that brightness speaks of", 0, 10);
    table.Add("points", &scene.num_points, "-", "in the reference", 0, 100000);
    table.Add("views", &views, "frames", "handed over, spread evenly from the reference to the last", 2, 1000);
    table.AddChoice("defect", &defect, "of the pixels");
    init.List(table);
  }
};

// Which of the other options are columns of their own.
constexpr std::array<std::string_view, 6> kInitColumns = {"Init.method",     "Init.solver",        "Init.robust",
                                                          "Init.refinement", "Init.triangulation", "WindowInit.light"};

struct Map {
  int points = 0;
  int outliers = 0;
  double rotation_deg = 0;
  std::optional<double> direction_deg;  // none where the camera did not move
  double median_depth_error = 0;
  double depth_rmse = 0;
  double null_depth_error = 0;
};

struct Trial {
  InitMeasurements measured;
  std::string reason;
  double milliseconds = 0;
  std::optional<Map> map;
};

void Spoil(PixelDefect defect, std::vector<InitFrame>* frames) {
  if (defect == PixelDefect::kNotANumber)
    for (InitObservation& seen : frames->back().observations)
      if (seen.id.value % 10 == 0) seen.pixel.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (defect == PixelDefect::kOneRay)
    for (InitObservation& seen : frames->front().observations) seen.pixel = frames->front().observations.front().pixel;
}

// `count` of the frames, spread evenly, the first and the last among them.
std::vector<InitFrame> SpreadEvenly(const std::vector<InitFrame>& frames, std::size_t count) {
  const std::size_t last = frames.size() - 1;
  const std::size_t steps = std::min(count - 1, last);
  std::vector<InitFrame> chosen;
  for (std::size_t k = 0; k <= steps; ++k) chosen.push_back(frames[(k * last + steps / 2) / steps]);
  return chosen;
}

// Median and root mean square of the relative errors of distances, up to one scale, the median of their ratios.
std::pair<double, double> RelativeErrors(const std::vector<double>& distances, const std::vector<double>& truths) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < truths.size(); ++i) ratios.push_back(distances[i] / truths[i]);
  const double scale = Median(ratios);
  for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1.0);
  return {Median(ratios), Rms(ratios)};
}

Map Compare(const InitOutcome& outcome, const test::Scene& scene) {
  Map map;
  std::vector<double> distances;
  std::vector<double> truths;
  for (const InitPoint& point : outcome.points) {
    const auto i = static_cast<std::size_t>(point.id.value);
    distances.push_back(point.position.norm());
    truths.push_back(scene.points[i].norm());
    map.outliers += scene.is_outlier[i];
  }
  map.points = static_cast<int>(truths.size());
  std::tie(map.median_depth_error, map.depth_rmse) = RelativeErrors(distances, truths);
  map.null_depth_error = RelativeErrors(std::vector<double>(truths.size(), 1.0), truths).first;
  const Rigid3& found = outcome.frames.back().cam_from_world;
  const Rigid3& truth = scene.cams_from_world.back();
  map.rotation_deg = kDegPerRad * RotationAngle(found.rotation * truth.rotation.conjugate());
  if (!truth.translation.isZero(0.0))
    map.direction_deg = kDegPerRad * AngleBetween(found.translation, truth.translation);
  return map;
}

Trial Run(const Setting& setting, std::uint64_t seed) {
  test::SceneOptions options = setting.scene;
  const double seconds = setting.gap_frames / kFramesPerSecond;
  options.seed = seed;
  options.num_frames = setting.gap_frames + 1;
  options.baseline_mm = setting.speed_mm_s * seconds;
  options.rotation_deg = setting.turn_deg_s * seconds;
  options.wave.seconds = seconds;
  const test::Scene scene = MakeScene(options);
  std::vector<InitFrame> frames = SpreadEvenly(FramesOf(scene, options, 0), static_cast<std::size_t>(setting.views));
  Spoil(setting.defect, &frames);

  // Every start is asked once, now.
  InitOptions init = setting.init;
  const int since = static_cast<int>(frames.size()) - 1;
  init.monocular.paper_frames = since;
  init.monocular.max_window = since + 1;
  init.window.first_frame = since;
  init.window.deforming_frame = std::min(init.window.deforming_frame, since);
  init.window.last_frame = since + init.window.every;
  const auto initializer = MakeInitializer(init, Random(seed).Child("samples"));
  const Camera camera = SceneCamera(options);
  const auto before = std::chrono::steady_clock::now();
  const InitOutcome outcome = initializer->Try({camera, frames, {}});
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - before;

  Trial trial{outcome.measured, outcome.reason, took.count(), std::nullopt};
  if (outcome.decision == InitDecision::kMap) trial.map = Compare(outcome, scene);
  return trial;
}

std::string ColumnOf(std::string_view option) { return std::string(option.substr(option.find('.') + 1)); }

// The scene's options and the initializer's choices, as they are in every row.
std::vector<const OptionField*> SettingFields(const OptionTable& table) {
  std::vector<const OptionField*> fields;
  for (const OptionField& field : table.fields())
    if (field.name.starts_with("Scene.")) fields.push_back(&field);
  for (const std::string_view name : kInitColumns) fields.push_back(table.Find(name));
  return fields;
}

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string Header(const OptionTable& table) {
  std::string header;
  for (const OptionField* field : SettingFields(table)) header += ColumnOf(field->name) + ",";
  return header +
         "seed,status,reason,correspondences,inlier_share,parallax_deg,rotation_deg,direction_deg,median_depth_error,"
         "depth_rmse,null_depth_error,map_points,outliers_in_map,ms\n";
}

std::string Row(const OptionTable& table, std::uint64_t seed, const Trial& trial) {
  std::ostringstream row;
  for (const OptionField* field : SettingFields(table)) row << field->get() << ",";
  const InitMeasurements& measured = trial.measured;
  row << seed << "," << (trial.map ? "made" : "refused") << "," << Quoted(trial.reason) << ","
      << measured.correspondences << ",";
  if (measured.correspondences > 0) row << measured.inliers / static_cast<double>(measured.correspondences);
  row << "," << measured.median_parallax_deg << ",";
  if (!trial.map) {
    row << ",,,,,,,";
  } else {
    row << trial.map->rotation_deg << ",";
    if (trial.map->direction_deg) row << *trial.map->direction_deg;
    row << "," << trial.map->median_depth_error << "," << trial.map->depth_rmse << "," << trial.map->null_depth_error
        << "," << trial.map->points << "," << trial.map->outliers << ",";
  }
  row << trial.milliseconds << "\n";
  return row.str();
}

int Main(std::span<const std::string> args) {
  std::string output_path;
  int first_seed = 1;
  int seeds = 20;
  cli::CommandLine line(kManual);
  line.Add("output_path", &output_path, "FILE", "CSV file to write", cli::Need::kRequired);
  line.Add("seeds", &seeds, "trials", 1, 1000000);
  line.Add("first_seed", &first_seed, "of the first trial; the others follow", 0, 1000000000);
  if (const auto exit = line.Parse(args)) return *exit;
  Setting setting;
  OptionTable table;
  setting.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  if (setting.init.method == InitMethod::kDepth)
    return line.UsageError("Init.method is 'depth', which takes no rays; give window, gated or paper");
  std::ofstream file(output_path);
  file << Header(table);
  for (int k = 0; k < seeds && file; ++k) {
    const auto seed = static_cast<std::uint64_t>(first_seed + k);
    file << Row(table, seed, Run(setting, seed));
  }
  if (!file.flush()) return line.Failure("cannot write '" + output_path + "'; is the folder there, and the disk full?");
  return cli::kExitOk;
}

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  try {
    return pliant::Main(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
  } catch (const std::exception& error) {  // a library ran out of memory or met what it did not expect
    std::cerr << "pliant_two_views: " << error.what() << std::endl;
    return pliant::cli::kExitFailed;
  }
}
