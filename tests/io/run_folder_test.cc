// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <csignal>
#include <cstring>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "io/run_reports.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_writer.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using namespace run_reports;
using testing::HasSubstr;

TEST(RunFolder, ComesBackAsItWasReported) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  ASSERT_TRUE(run->summary);
  EXPECT_EQ(run->summary->status, RunStatus::kLost);
  EXPECT_EQ(run->summary->note, "too few points");
  EXPECT_EQ(run->summary->description.command_line, (std::vector<std::string>{"pliant", "track"}));
  EXPECT_EQ(run->summary->description.camera, (std::filesystem::current_path() / "stereo.yaml").string());
  EXPECT_EQ(run->summary->description.seed, 7u);
  EXPECT_EQ(run->summary->description.oracles, (std::vector<std::string>{"tracks"}));
  EXPECT_EQ(run->summary->frames_read, 5);
  EXPECT_EQ(run->summary->frames_tracked, 4);
  EXPECT_EQ(run->summary->points, kPoints);
  ASSERT_TRUE(run->summary->first_map);
  EXPECT_EQ(run->summary->first_map->reference_frame_idx, kFirstMap.reference_frame_idx);
  EXPECT_EQ(run->summary->first_map->declared_frame_idx, kFirstMap.declared_frame_idx);
  EXPECT_EQ(run->summary->losses,
            (std::vector<std::pair<std::string, std::int64_t>>{{"similarity", 10}, {"border", 5}}));
  EXPECT_NEAR(run->summary->mean_ms[1].second, 2.25, kRoundOff);
  EXPECT_EQ(run->stage_names, kStages);
  ASSERT_EQ(run->frames.size(), 5u);
  EXPECT_EQ(run->frames[0].state, TrackingState::kWaitingForReference);
  EXPECT_EQ(run->frames[3].costs.spatial, 0.125);
  EXPECT_EQ(run->frames[3].stage_ms, (std::vector<double>{1.5, 2.25}));
  ASSERT_EQ(run->poses.size(), 4u);
  auto reader = ObservationReader::Open(folder.Path("run"));
  ASSERT_TRUE(reader.ok());
  for (int i = 1; i < 5; ++i) {
    const FrameReport report = Report(i);
    const RunPose& pose = run->poses[static_cast<std::size_t>(i - 1)];
    EXPECT_EQ(pose.frame_idx, report.frame_idx);
    EXPECT_LT(
        (pose.world_from_cam * *report.cam_from_world * Eigen::Vector3d(1, 2, 50) - Eigen::Vector3d(1, 2, 50)).norm(),
        kFileLength_mm);
    const auto frame = reader->Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_EQ((*frame)->frame_idx, report.frame_idx);
    ASSERT_EQ((*frame)->observations.size(), report.observations.size());
    for (std::size_t k = 0; k < report.observations.size(); ++k) {
      const PointObservation& o = (*frame)->observations[k];
      EXPECT_EQ(o.id, report.observations[k].id);
      EXPECT_LT((o.pixel - report.observations[k].pixel).norm(), kFilePixel_px);
      EXPECT_LT((o.position - report.observations[k].position).norm(), kFileLength_mm);
      EXPECT_EQ(o.ssim, 0.9);
    }
  }
  EXPECT_FALSE(reader->Next()->has_value());
  EXPECT_EQ(run->cut_lines + reader->cut_lines(), 0);
}

TEST(RunFolder, SaysInterruptedUntilItIsFinishedAndKeepsItsRows) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(writer.Write(Report(i)).ok());
  // Read while the writer still lives, as if it had been killed.
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kInterrupted);
  EXPECT_FALSE(run->summary->first_map);
  EXPECT_EQ(run->frames.size(), 4u);
  EXPECT_EQ(run->poses.size(), 3u);
}

TEST(RunFolder, LeavesOutALastLineThatWasCutOff) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const std::string frames = folder.Read("run/frames.csv");
  const std::string rows = folder.Read("run/observations.csv");
  constexpr int kOneLine = 1;                   // no more than the last one is cut
  constexpr std::size_t kAllObservations = 18;  // of four frames: six points, or the three even ones
  const std::string poses = folder.Read("run/trajectory.txt");
  for (std::size_t cut = 1; cut < 60; cut += 7) {
    folder.Write("run/frames.csv", frames.substr(0, frames.size() - cut));
    folder.Write("run/observations.csv", rows.substr(0, rows.size() - cut));
    const auto run = ReadRun(folder.Path("run"));
    ASSERT_TRUE(run.ok()) << run.status().message();
    EXPECT_EQ(run->frames.size(), 4u);
    EXPECT_EQ(run->poses.size(), 3u) << "the last frame has no row";
    EXPECT_EQ(run->cut_lines, 1);
    auto reader = ObservationReader::Open(folder.Path("run"));
    std::size_t read = 0;
    for (auto frame = reader->Next(); frame.ok() && frame->has_value(); frame = reader->Next())
      read += (*frame)->observations.size();
    EXPECT_LT(read, kAllObservations);
    EXPECT_LE(reader->cut_lines(), kOneLine);
  }
}

TEST(RunFolder, RefusesADamagedRowInTheMiddle) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const std::string rows = folder.Read("run/observations.csv");
  for (const auto& [row, says] : {std::pair("12,0,1,2,3,4,5", "observations.csv:3: a row has 8 columns"),
                                  std::pair("12,3,1,nan,3,4,5,1", "observations.csv:3: 'nan' is not a finite"),
                                  std::pair("12,0,1,2,3,4,5,1", "observations.csv:3: point 0 comes twice"),
                                  std::pair("9,3,1,2,3,4,5,1", "observations.csv:3: frame 9 comes after frame 12")}) {
    std::string damaged = rows;
    const std::size_t second = damaged.find('\n', damaged.find('\n') + 1) + 1;
    damaged.replace(second, damaged.find('\n', second) - second, row);
    folder.Write("run/observations.csv", damaged);
    auto reader = ObservationReader::Open(folder.Path("run"));
    ASSERT_TRUE(reader.ok());
    const auto frame = reader->Next();
    ASSERT_FALSE(frame.ok()) << row;
    EXPECT_THAT(frame.status().message(), HasSubstr(says));
  }
  std::string frames = folder.Read("run/frames.csv");
  frames.replace(frames.find("tracking,", frames.find('\n')), 8, "trackinG");
  folder.Write("run/frames.csv", frames);
  EXPECT_THAT(ReadRun(folder.Path("run")).status().message(), HasSubstr("frames.csv:3: 'trackinG' is not a state"));
}

TEST(RunFolder, ReadsAnotherProgramsResult) {
  const TestFolder folder;
  folder.Write("trajectory.txt", "0.1 0 0 0 0 0 0 1\n0.2 1 0 0 0 0 0 1");
  folder.Write("observations.csv", "frame,point_id,u_px,v_px,x,y,z\n4,1,10,20,1,2,3\n7,1,10,20,1,2,3");
  const auto run = ReadRun(folder.Path(""));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_FALSE(run->summary);
  ASSERT_EQ(run->poses.size(), 2u);
  EXPECT_EQ(run->poses[1].timestamp_s, 0.2);
  EXPECT_FALSE(run->poses[1].frame_idx);  // its time tells the frame
  auto reader = ObservationReader::Open(folder.Path(""));
  ASSERT_TRUE(reader.ok()) << reader.status().message();
  ASSERT_TRUE(reader->Next().ok());
  const auto last = reader->Next();
  ASSERT_TRUE(last.ok() && last->has_value()) << "a last line without its end is as good as the others";
  EXPECT_EQ((*last)->frame_idx, 7);
  EXPECT_TRUE(std::isnan((*last)->observations[0].ssim));
  EXPECT_EQ(ReadRun(folder.Path("none")).status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(ReadRun(folder.Path(std::string(300, 'x'))).status().code(),
            ErrorCode::kNotFound);  // no name may be so long
}

TEST(RunWriter, ReplacesAFormerRunAndNothingElse) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  folder.Write("run/notes.txt", "mine");
  RunWriter writer = Writer(folder.Path("run"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/sparse/images.bin")));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/map.ply")));
  EXPECT_EQ(folder.Read("run/notes.txt"), "mine");
  folder.Write("other.txt", "x");
  const auto refused = RunWriter::Create(folder.Path(""), TestCamera(), {}, "", kStages);
  EXPECT_EQ(refused.status().code(), ErrorCode::kInvalidArgument);
  const auto no_folder = RunWriter::Create(folder.Path("other.txt/run"), TestCamera(), {}, "", kStages);
  EXPECT_EQ(no_folder.status().code(), ErrorCode::kUnwritable);
}

TEST(RunWriter, GivesTheSameBytesTwiceWithoutTimings) {
  const TestFolder folder;
  for (const char* run : {"a", "b"}) WriteRun(folder.Path(run), 5, {.timings = RunTimings::kNone});
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.Path("a"))) {
    if (!entry.is_regular_file()) continue;
    const std::string name = std::filesystem::relative(entry.path(), folder.Path("a")).string();
    EXPECT_EQ(folder.Read("a/" + name), folder.Read("b/" + name)) << name;
  }
}

TEST(RunWriter, RefusesReportsThatCannotBeMeant) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  FrameReport report = Report(1);
  report.observations[0].position.x() = std::nan("");
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("not finite"));
  report = Report(1);
  report.stage_ms = {{"other", 1.0}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("no stage 'other'"));
  report = Report(1);
  report.new_points.clear();
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("observed but was never new"));
  report = Report(1);
  report.refined_points = {{PointId{1}, Eigen::Vector3d(1, 2, 3)}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("refined but was never new"));
  report.refined_points = {{report.observations[0].id, Eigen::Vector3d(1, std::nan(""), 3)}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("not finite"));
}

TEST(RunWriter, TheMapHasPointsWhereTheyWereLastRefinedTo) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  for (int frame = 1; frame <= 3; ++frame) {
    FrameReport report = Report(frame);
    if (frame > 1) report.refined_points = {{PointId{0}, Eigen::Vector3d(0.125, 0.25, 70.5 + frame)}};
    ASSERT_TRUE(writer.Write(report).ok());
  }
  ASSERT_TRUE(writer.Finish(RunStatus::kCompleted, "").ok());
  const std::string points = folder.Read("run/sparse/points3D.txt");
  EXPECT_THAT(points, HasSubstr("\n0 0.125000 0.250000 73.500000 "));
  EXPECT_THAT(points, HasSubstr("\n3 -1.000000 0.500000 50.250000 ")) << "the others stay";
}

TEST(RunWriter, ReportsAFullDiskAndKeepsWhatItWrote) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  // A limit on the size of files stands in for a full disk: writing fails in the middle of a row.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{2000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  Status status;
  int frames = 0;
  for (; frames < 1000 && status.ok(); ++frames) status = writer.Write(Report(frames));
  const Status finished = writer.Finish(RunStatus::kCompleted, "");
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(status.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(status.message(), HasSubstr("observations.csv"));
  EXPECT_EQ(finished.code(), ErrorCode::kUnwritable);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kFailed);
  EXPECT_EQ(static_cast<int>(run->frames.size()), frames - 1);
}

TEST(RunWriter, TellsHowTheRunEndedWhereNoNewFileCanBeMade) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  ASSERT_TRUE(writer.Write(Report(0)).ok());
  // Folders in the way of the files stand in for a disk without room for new ones.
  std::filesystem::create_directories(folder.Path("run/run.json.tmp"));
  std::filesystem::create_directories(folder.Path("run/sparse/cameras.txt"));
  std::filesystem::create_directories(folder.Path("run/sparse/cameras.bin"));
  EXPECT_EQ(writer.Finish(RunStatus::kCompleted, "").code(), ErrorCode::kUnwritable);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kFailed);
  EXPECT_THAT(run->summary->note, HasSubstr("cannot write"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/sparse")));
}

// A second, independent reading of COLMAP's formats.
TEST(ColmapModel, OfARunLinksImagesAndPointsBothWays) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  std::istringstream images(folder.Read("run/sparse/images.txt"));
  std::map<int, std::vector<std::array<double, 3>>> keypoints;
  std::string line;
  while (std::getline(images, line)) {
    if (line.starts_with("#")) continue;
    std::istringstream head(line);
    int id = 0;
    int camera = 0;
    std::array<double, 7> pose{};
    std::string name;
    head >> id;
    for (double& value : pose) head >> value;
    head >> camera >> name;
    EXPECT_EQ(camera, 1);
    EXPECT_EQ(name, std::to_string(id - 1) + ".png");
    ASSERT_TRUE(std::getline(images, line));
    EXPECT_FALSE(line.ends_with(' '));
    std::istringstream triples(line);
    for (std::array<double, 3> k{}; triples >> k[0] >> k[1] >> k[2];) keypoints[id].push_back(k);
  }
  ASSERT_EQ(keypoints.size(), 4u);
  const FrameReport second = Report(2);
  ASSERT_EQ(keypoints[second.frame_idx + 1].size(), second.observations.size());
  EXPECT_NEAR(keypoints[second.frame_idx + 1][0][0], second.observations[0].pixel.x() + 0.5, kFilePixel_px);
  EXPECT_NEAR(keypoints[second.frame_idx + 1][0][1], second.observations[0].pixel.y() + 0.5, kFilePixel_px);

  std::istringstream points(folder.Read("run/sparse/points3D.txt"));
  int num_points = 0;
  while (std::getline(points, line)) {
    if (line.starts_with("#")) continue;
    std::istringstream row(line);
    int id = 0;
    std::array<double, 7> rest{};
    row >> id;
    for (double& value : rest) row >> value;
    EXPECT_LT(rest[6], kExactReprojection_px) << "exact observations have no reprojection error";
    int length = 0;
    for (int image = 0, idx = 0; row >> image >> idx; ++length)
      EXPECT_EQ(keypoints.at(image).at(static_cast<std::size_t>(idx))[2], id);
    EXPECT_EQ(length, (id / 3) % 2 == 0 ? 4 : 2);
    ++num_points;
  }
  EXPECT_EQ(num_points, kPoints);
}

class Bytes {
 public:
  explicit Bytes(std::string bytes) : bytes_(std::move(bytes)) {}
  template <class T>
  T Take() {
    T value{};
    EXPECT_LE(at_ + sizeof(T), bytes_.size());
    if (at_ + sizeof(T) <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string TakeName() {
    std::string name(bytes_.c_str() + at_);
    at_ += name.size() + 1;
    return name;
  }
  bool AtEnd() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

TEST(ColmapModel, HasTheSameInBinary) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  Bytes images(folder.Read("run/sparse/images.bin"));
  ASSERT_EQ(images.Take<std::uint64_t>(), 4u);
  for (int i = 1; i < 5; ++i) {
    const FrameReport report = Report(i);
    EXPECT_EQ(images.Take<std::uint32_t>(), static_cast<std::uint32_t>(report.frame_idx + 1));
    EXPECT_EQ(images.Take<double>(), report.cam_from_world->rotation.w());
    for (int k = 0; k < 3; ++k) images.Take<double>();
    EXPECT_EQ(images.Take<double>(), report.cam_from_world->translation.x());
    for (int k = 0; k < 2; ++k) images.Take<double>();
    EXPECT_EQ(images.Take<std::uint32_t>(), 1u);
    EXPECT_EQ(images.TakeName(), report.name);
    ASSERT_EQ(images.Take<std::uint64_t>(), report.observations.size());
    for (const PointObservation& o : report.observations) {
      EXPECT_NEAR(images.Take<double>(), o.pixel.x() + 0.5, kFilePixel_px);
      EXPECT_NEAR(images.Take<double>(), o.pixel.y() + 0.5, kFilePixel_px);
      EXPECT_EQ(images.Take<std::uint64_t>(), static_cast<std::uint64_t>(o.id.value));
    }
  }
  EXPECT_TRUE(images.AtEnd());
  Bytes points(folder.Read("run/sparse/points3D.bin"));
  ASSERT_EQ(points.Take<std::uint64_t>(), static_cast<std::uint64_t>(kPoints));
  for (int i = 0; i < kPoints; ++i) {
    EXPECT_EQ(points.Take<std::uint64_t>(), static_cast<std::uint64_t>(3 * i));
    EXPECT_EQ(points.Take<double>(), i - 2);
    for (int k = 0; k < 2; ++k) points.Take<double>();
    EXPECT_EQ(points.Take<std::uint8_t>(), 10);
    for (int k = 0; k < 2; ++k) points.Take<std::uint8_t>();
    EXPECT_LT(points.Take<double>(), kExactReprojection_px);
    const auto length = points.Take<std::uint64_t>();
    EXPECT_EQ(length, i % 2 == 0 ? 4u : 2u);
    for (std::uint64_t k = 0; k < 2 * length; ++k) points.Take<std::uint32_t>();
  }
  EXPECT_TRUE(points.AtEnd());
}

}  // namespace
}  // namespace pliant
