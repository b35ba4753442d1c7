// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Run folders as they lie on disk, other systems' among them, and the figures once more by an independent script.
#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "evaluation/truth_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_summary.h"
#include "pliant/simulation/write_sequence.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kAgreement = 1e-6;  // mm, deg, shares: what decimals of the files leave between two programs
// What is compared is more than none, so that agreement means something.
constexpr double kNotNone = 0.01;
constexpr double kNotNone_mm = 0.5;
constexpr double kNotNone_px = 0.5;
constexpr int kMinPoints = 200;

class RunFolderEvaluation : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() /
            (std::string("pliant_evaluation_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    fs::create_directories(root_ / "run");
    fs::create_directories(root_ / "depth");
  }
  void TearDown() override { fs::remove_all(root_); }

  std::string Run() const { return (root_ / "run").string(); }
  void Write(const char* name, const std::string& text) const { std::ofstream(root_ / "run" / name) << text; }

  // What any program may write: trajectory.txt and observations.csv, with all digits.
  void WriteRun(const EvaluationInput& run, double time_offset_s = 0) const {
    std::ofstream trajectory(root_ / "run" / "trajectory.txt");
    std::ofstream observations(root_ / "run" / "observations.csv");
    observations << "frame,point_id,u_px,v_px,x,y,z\n";  // no ssim
    for (const EvaluationFrame& frame : run.frames) {
      if (!frame.cam_from_world) continue;
      trajectory << TumLine(frame.timestamp_s + time_offset_s, frame.cam_from_world->Inverse());
      for (const PointObservation& o : frame.observations)
        observations << frame.frame_idx << "," << o.id.value << "," << FormatDouble(o.pixel.x()) << ","
                     << FormatDouble(o.pixel.y()) << "," << FormatDouble(o.position.x()) << ","
                     << FormatDouble(o.position.y()) << "," << FormatDouble(o.position.z()) << "\n";
    }
  }
  static std::string TumLine(double time_s, const Rigid3& pose) {
    std::string line = FormatDouble(time_s);
    for (const double value : pose.translation) line += " " + FormatDouble(value);
    for (const double value : pose.rotation.coeffs()) line += " " + FormatDouble(value);
    return line + "\n";
  }
  // NumPy's own format, version 1: a magic, the header's length, the header padded to 64 bytes, the data.
  static void WriteNpy(const fs::path& path, const cv::Mat& depth_mm) {
    static_assert(std::endian::native == std::endian::little);
    std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(depth_mm.rows) + ", " +
                         std::to_string(depth_mm.cols) + "), }";
    header.resize((10 + header.size() + 1 + 63) / 64 * 64 - 10 - 1, ' ');
    header += '\n';
    std::ofstream file(path, std::ios::binary);
    file << "\x93NUMPY" << '\x01' << '\0' << static_cast<char>(header.size() & 0xFF)
         << static_cast<char>(header.size() >> 8) << header;
    file.write(reinterpret_cast<const char*>(depth_mm.data),
               static_cast<std::streamsize>(depth_mm.total() * depth_mm.elemSize()));
  }

  // The script's figures of the run on disk, or nothing where there is no NumPy. Writes depth and poses for it from
  // frame `first` on. `more`: its last arguments.
  std::optional<nlohmann::json> Reference(const Sequence& sequence, int first, const std::string& more) const {
    std::string python;
    for (const char* candidate : {"python3", "/usr/bin/python3"})
      if (std::system((std::string(candidate) + " -c 'import numpy' >/dev/null 2>&1").c_str()) == 0) python = candidate;
    if (python.empty()) return std::nullopt;
    std::ofstream truth(root_ / "groundtruth.txt");
    for (int idx = first; idx < sequence.size(); ++idx) {
      WriteNpy(root_ / "depth" / (std::string("00000") + std::to_string(idx) + ".npy"), **sequence.Depth(idx));
      truth << TumLine(*sequence.TimestampS(idx), *sequence.WorldFromCamera(idx));
    }
    truth.close();
    std::string camera;
    for (const double value : sequence.camera().params()) camera += " " + FormatDouble(value);
    const std::string out = (root_ / "out.json").string();
    const std::string command = python + " '" PLIANT_TEST_SOURCE_DIR "/reference_evaluation.py' '" + Run() + "' '" +
                                (root_ / "depth").string() + "' '" + (root_ / "groundtruth.txt").string() + "'" +
                                camera + " " + more + " > '" + out + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::ifstream file(out);
    return nlohmann::json::parse(file);
  }

  // Every figure that the script has, through every protocol, against ours.
  static void ExpectSame(const nlohmann::json& ours, const nlohmann::json& script, double tolerance) {
    for (const char* protocol : {"paper", "depth_trimmed", "lmeds"})
      for (const char* side : {"estimate", "null"})
        for (const auto& [name, value] : script[std::string(protocol) + "_" + side].items())
          EXPECT_NEAR(ours["protocols"][protocol][side][name].get<double>(), value.get<double>(), tolerance)
              << protocol << " " << side << " " << name;
  }

  fs::path root_;
};

TEST_F(RunFolderEvaluation, ReadsAnotherSystemsResultAndGivesItsPosesTheirFramesByTime) {
  const EvaluationInput run = MakeRun(8, 1, 1);
  const TruthSequence sequence(8);
  WriteRun(run, 0.004);
  const auto read = ReadEvaluationInput(Run(), sequence, {});
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->frames.size(), 7U);  // without frames.csv only tracked frames are known
  EXPECT_TRUE(read->notes.empty());
  const auto direct = Evaluate(run, sequence, kNoMaterial, {});
  const auto from_disk = Evaluate(*read, sequence, kNoMaterial, {});
  ASSERT_TRUE(direct.ok() && from_disk.ok());
  EXPECT_NEAR(from_disk->surface->plain.estimate.mean_rmse_mm, direct->surface->plain.estimate.mean_rmse_mm,
              kLengthRoundOff_mm);
  EXPECT_EQ(ReadEvaluationInput((root_ / "nothing").string(), sequence, {}).status().code(), ErrorCode::kNotFound);
}

TEST_F(RunFolderEvaluation, ARunSaysWhetherItsUnitsAreMillimeters) {
  Write("trajectory.txt", "");
  Write("observations.csv", "frame,point_id,u_px,v_px,x,y,z,ssim\n");
  RunSummary summary;
  for (const std::optional<bool> metric : {std::optional<bool>(), std::optional(false), std::optional(true)}) {
    summary.description.metric = metric;
    ASSERT_TRUE(WriteRunSummary(Run() + "/run.json", summary).ok());
    const auto read = ReadEvaluationInput(Run());
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->metric, metric.value_or(false));
  }
}

TEST_F(RunFolderEvaluation, RefusesPosesOfAnotherClock) {
  WriteRun(MakeRun(8, 1, 1), 1e6);
  const auto read = ReadEvaluationInput(Run(), TruthSequence(8), {});
  EXPECT_EQ(read.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(read.status().message(), HasSubstr("is within 0.01 s of a frame: its times go from 1000000.04 s"));
}

TEST_F(RunFolderEvaluation, NotesPosesWithoutAFrameAndPointsWithoutAPose) {
  // Frames are 0.04 s apart. Two poses near frame 1, of which the nearer counts; one 15 ms before
  // frame 3.
  Write("trajectory.txt",
        "0 0 0 0 0 0 0 1\n0.035 9 0 0 0 0 0 1\n0.041 1 0 0 0 0 0 1\n0.105 3 0 0 0 0 0 1\n0.16 4 0 0 0 0 0 1");
  Write("observations.csv",
        "frame,point_id,u_px,v_px,x,y,z,ssim\n0,1,10,20,1,2,30,1\n1,1,10,20,1,2,30,1\n3,1,10,20,1,2,30,1");
  const auto read = ReadEvaluationInput(Run(), TruthSequence(8), {});
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->frames.size(), 4U);  // 0, 1, 3 without a pose, 4 without points
  EXPECT_NEAR(read->frames[1].cam_from_world->translation.x(), -1, kRoundOff);
  EXPECT_EQ(read->frames[1].observations.size(), 1U);
  EXPECT_EQ(read->frames[2].frame_idx, 3);
  EXPECT_FALSE(read->frames[2].cam_from_world);
  EXPECT_TRUE(read->frames[3].cam_from_world && read->frames[3].observations.empty());
  EXPECT_THAT(read->notes, ElementsAre(HasSubstr("2 of 5 poses"), HasSubstr("1 frames of")));
  const auto wide = ReadEvaluationInput(Run(), TruthSequence(8), {.max_time_difference_s = 0.02});
  ASSERT_TRUE(wide.ok());
  EXPECT_TRUE(wide->frames[2].cam_from_world);
  EXPECT_THAT(wide->notes, ElementsAre(HasSubstr("1 of 5 poses")));
}

TEST_F(RunFolderEvaluation, RefusesPosesAtOtherFramesThanTheirPoints) {
  // Every pose is at a frame, but at twice the number of its own.
  std::string poses;
  std::string points = "frame,point_id,u_px,v_px,x,y,z,ssim\n";
  for (int frame = 0; frame < 8; ++frame) {
    poses += FormatDouble(0.08 * frame) + " 0 0 0 0 0 0 1\n";
    points += std::to_string(frame) + ",1,10,20,1,2,30,1\n";
  }
  Write("trajectory.txt", poses);
  Write("observations.csv", points);
  const auto read = ReadEvaluationInput(Run(), TruthSequence(8), {});
  EXPECT_EQ(read.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(read.status().message(), HasSubstr("has 8 poses and as many frames with points, but by the times of "
                                                 "the poses 4 of these frames have none"));
}

TEST_F(RunFolderEvaluation, PointsAndPosesMayGoBeyondTheSequence) {
  WriteRun(MakeRun(8, 1, 1));
  const auto read = ReadEvaluationInput(Run(), TruthSequence(4), {});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_THAT(read->notes, testing::Contains(HasSubstr("poses of")));
}

TEST_F(RunFolderEvaluation, BadRowsAndEmptyRunsAreOneSentence) {
  const TruthSequence sequence(8);
  const std::string pose = "0 0 0 0 0 0 0 1\n";
  const std::string head = "frame,point_id,u_px,v_px,x,y,z\n";
  for (const auto& [trajectory, rows, says] :
       {std::tuple(pose, head + "0,1,10,20,1,nan,30\n", "observations.csv:2: 'nan' is not a finite number; leave out"),
        std::tuple(pose, head + "0,1,10,20,1,2,30,1\n", "observations.csv:2: a row has 7 columns"),
        std::tuple(pose, head + "0,2,10,20,1,2,30\n0,1,10,20,1,2,30\n", "observations.csv:3: point 1 comes twice or"),
        std::tuple(pose, head + "0,1,10,20,1,2,30\n0,1,10,20,1,2,30\n", "observations.csv:3: point 1 comes twice or"),
        std::tuple(pose, head + "1,1,10,20,1,2,30\n0,1,10,20,1,2,30\n", "observations.csv:3: frame 0 comes after"),
        std::tuple(pose, std::string("frame,id\n"), "observations.csv:1: the first line must be"),
        std::tuple(pose + pose, head, "trajectory.txt:2: the time is not after the line before"),
        std::tuple(std::string("0 nan 0 0 0 0 0 1\n"), head, "trajectory.txt:1: 'nan' is not a finite number"),
        std::tuple(std::string(), head, "no tracked frame among the 0 it read")}) {
    Write("trajectory.txt", trajectory);
    Write("observations.csv", rows);
    const auto read = ReadEvaluationInput(Run(), sequence, {});
    const Status status = read.ok() ? Evaluate(*read, sequence, kNoMaterial, {}).status() : read.status();
    ASSERT_FALSE(status.ok()) << says;
    EXPECT_THAT(status.message(), HasSubstr(says));
    EXPECT_THAT(status.message(), HasSubstr(Run()));
  }
}

TEST_F(RunFolderEvaluation, ASurfaceWithoutTrueDepthIsANoteAndTheRestIsThere) {
  WriteRun(MakeRun(8, 1, 1));
  const fs::path surface = root_ / "surface";
  fs::create_directories(surface);
  ASSERT_TRUE(WriteCameraFile((surface / "camera.yaml").string(), {.camera = TestCamera(), .depth_scale = 0.01}).ok());
  std::ofstream(surface / "surface.json")
      << R"({"status": "completed", "frames": [{"frame": 2, "name": "2.png", "note": ""}]})";
  OpenedTruth truth;
  truth.sequence = std::make_unique<TruthSequence>(8, TruthSequence::Truth::kPosesOnly);
  truth.material = kNoMaterial.status();
  const auto evaluation =
      EvaluateRun(Run(), RunReferences{.truth = &truth, .surface_path = surface.string()}, EvaluationOptions());
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  EXPECT_FALSE(evaluation->dense.has_value());
  EXPECT_TRUE(evaluation->trajectory.has_value());
  EXPECT_THAT(evaluation->notes, testing::Contains(HasSubstr("has pixels whose true depth is known")));
  EXPECT_TRUE(nlohmann::json::parse(EvaluationJson(*evaluation)).at("dense").is_null());
}

TEST_F(RunFolderEvaluation, AgreesWithAnIndependentNumPyScript) {
  constexpr int kFramesOfRun = 6;
  EvaluationInput run = MakeRun(kFramesOfRun, 2, 1.5);
  for (EvaluationFrame& frame : run.frames)
    for (PointObservation& outlier : frame.observations)
      if (outlier.id.value % 10 == 0) outlier.position += Eigen::Vector3d(10, -3, 20);
  WriteRun(run);
  const TruthSequence sequence(kFramesOfRun);
  const std::string first_map_frames =
      std::to_string(kFirstMap.reference_frame_idx) + " " + std::to_string(kFirstMap.declared_frame_idx);
  const auto script = Reference(sequence, 1, first_map_frames);
  if (!script) GTEST_SKIP() << "needs python3 with numpy (python3-numpy)";

  EvaluationOptions options;
  options.points.max_depth_step = 10;  // the script refuses nothing
  options.points.protocols = {ErrorProtocol::kPaper, ErrorProtocol::kDepthTrimmed, ErrorProtocol::kLmeds};
  auto read = ReadEvaluationInput(Run(), sequence, options.matching);
  ASSERT_TRUE(read.ok()) << read.status().message();
  read->frames.front().first_map = kFirstMap;  // what another program's result does not say
  read->frames[kFirstMap.declared_frame_idx - kFirstMap.reference_frame_idx].first_map = kFirstMap;
  const auto evaluation = Evaluate(*read, sequence, kNoMaterial, options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  const auto ours = nlohmann::json::parse(EvaluationJson(*evaluation));
  ExpectSame(ours["surface"], (*script)["surface"], kAgreement);
  for (const char* name : {"ate_rmse_mm", "rpe_translation_rmse_mm", "rpe_rotation_rmse_deg"})
    EXPECT_NEAR(ours["trajectory"][name].get<double>(), (*script)[name].get<double>(), kAgreement) << name;
  const nlohmann::json& first_map = (*script)["first_map"];
  for (const char* frame : {"declared", "reference"})
    for (const char* side : {"estimate", "null"})
      for (const auto& [name, value] : first_map[frame][side].items())
        EXPECT_NEAR(ours["first_map"][frame][side][name].get<double>(), value.get<double>(), kAgreement)
            << frame << " " << side << " " << name;
  ASSERT_FALSE(first_map["motion"].empty());
  for (const auto& [name, value] : first_map["motion"].items())
    EXPECT_NEAR(ours["first_map"]["motion"][name].get<double>(), value.get<double>(), kAgreement) << name;
  EXPECT_GT(first_map["declared"]["estimate"]["median_relative_depth"], kNotNone);
  EXPECT_GT((*script)["surface"]["paper_estimate"]["mean_rmse_mm"], kNotNone_mm);
  EXPECT_GT((*script)["surface"]["lmeds_estimate"]["left_out_share"], 0.0);
  EXPECT_GT((*script)["ate_rmse_mm"], kNotNone_mm);
}

// Tracks on a simulated sequence that drift by some pixels, with noise in space; the map's unit is two millimeters.
// Only tracks that have true depth at all their pixels.
EvaluationInput DriftingRun(const Sequence& sequence, MaterialTruth& material) {
  constexpr double kScale = 2;
  Random random(3);
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < 150; ++i) pixels.emplace_back(random.Uniform(15, 145), random.Uniform(15, 105));
  std::vector<MaterialId> ids;
  const auto points = material.PointsAt(0, pixels);
  for (const auto& point : *points)
    if (point) ids.push_back(*point);
  EvaluationInput run;
  std::set<PointId> without_depth;
  for (int idx = 0; idx < sequence.size(); ++idx) {
    EvaluationFrame& frame = run.frames.emplace_back();
    frame.frame_idx = idx;
    frame.timestamp_s = *sequence.TimestampS(idx);
    const Rigid3 world_from_cam = *sequence.WorldFromCamera(idx);
    const Rigid3 scaled(world_from_cam.rotation, world_from_cam.translation / kScale);
    frame.cam_from_world = scaled.Inverse();
    const auto states = material.Observe(idx, ids);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const MaterialState& state = *(*states)[i];
      const Eigen::Vector2d drift = idx * Eigen::Vector2d(random.Normal(0.5), random.Normal(0.5));
      const Eigen::Vector3d noise(random.Normal(1), random.Normal(1), random.Normal(3));
      const PointId id{static_cast<int>(i)};
      frame.observations.push_back({id, state.pixel.value_or(Eigen::Vector2d(-1, -1)) + drift,
                                    scaled * ((state.point_in_cam + noise) / kScale), 1});
      const std::vector<Eigen::Vector2d> pixel = {frame.observations.back().pixel};
      const std::vector<Eigen::Vector3d> point = {state.point_in_cam};
      if (PairWithDepth(idx, point, pixel, sequence.camera(), **sequence.Depth(idx), 10).pairs.empty())
        without_depth.insert(id);
    }
  }
  for (EvaluationFrame& frame : run.frames)
    std::erase_if(frame.observations, [&](const PointObservation& o) { return without_depth.contains(o.id); });
  return run;
}

// The script takes the material's truth from the first depth image and the formula: nothing of it comes from the
// simulator's mesh. Depth is read between pixels there and hit by a ray here, on a smooth wall.
TEST_F(RunFolderEvaluation, OfASimulatedSequenceAgreesWithTheFormulaInNumPy) {
  SimulationOptions simulation;
  simulation.scene.kind = SceneKind::kTube;
  simulation.scene.view_mm = 100;
  simulation.scene.relief_mm = 0;
  simulation.texture.texel_mm = 0.8;
  simulation.texture.smallest_mm = 2;
  simulation.camera.width = 160;
  simulation.camera.height = 120;
  simulation.sensor.samples = 1;
  simulation.trajectory.frames = 5;
  simulation.trajectory.fps = 10;
  simulation.deformation.amplitude_mm = 4;
  simulation.deformation.omega_rad_s = 5;
  simulation.deformation.wavelength_mm = 150;
  const fs::path folder = root_ / "sequence";
  ASSERT_TRUE(WriteSequence(simulation, folder).ok());
  SequenceRequest request;
  request.image_path = folder;
  const auto sequence = OpenSequence(request);
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  auto material = OpenMaterialTruth(folder.string());
  ASSERT_TRUE(material.ok()) << material.status().message();

  WriteRun(DriftingRun(**sequence, **material));
  const auto script = Reference(**sequence, 0, "4 5 150 10");
  if (!script) GTEST_SKIP() << "needs python3 with numpy (python3-numpy)";

  EvaluationOptions options;
  options.points.max_depth_step = 10;
  options.points.protocols = {ErrorProtocol::kPaper, ErrorProtocol::kDepthTrimmed, ErrorProtocol::kLmeds};
  const auto read = ReadEvaluationInput(Run(), **sequence, options.matching);
  ASSERT_TRUE(read.ok()) << read.status().message();
  const auto evaluation = Evaluate(*read, **sequence, material->get(), options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  const auto ours = nlohmann::json::parse(EvaluationJson(*evaluation));
  ExpectSame(ours["surface"], (*script)["surface"], kAgreement);
  constexpr double kInterpolation = 0.02;  // mm and px: of depth between pixels, and of the mesh's facets
  ExpectSame(ours["material"], (*script)["material"], kInterpolation);
  ASSERT_FALSE((*script)["drift"].empty());
  for (const auto& [name, value] : (*script)["drift"].items())
    EXPECT_NEAR(ours["material"]["drift"][name].get<double>(), value.get<double>(), kInterpolation) << name;
  EXPECT_GT(ours["material"]["points"], kMinPoints);
  EXPECT_GT(ours["material"]["estimate"]["mean_rmse_mm"], kNotNone_mm);
  EXPECT_GT(ours["material"]["drift"]["median_px"], kNotNone_px);
}

}  // namespace
}  // namespace pliant
