// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/run_reports.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_summary.h"
#include "pliant/io/run_writer.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using namespace run_reports;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

TEST(StreamCounts, ComeBackAndThoseOfEarlierVersionsToo) {
  const TestFolder folder;
  RunSummary summary;
  summary.stream = StreamCounts{.received = 9, .skipped = 2, .damaged = 1, .fps = 24.5, .measured = true};
  ASSERT_TRUE(WriteRunSummary(folder.Path("run.json"), summary).ok());
  const auto read = ReadRunSummary(folder.Path("run.json"));
  ASSERT_TRUE(read.ok() && read->stream) << read.status().message();
  EXPECT_EQ(read->stream->received, 9);
  EXPECT_EQ(read->stream->skipped, 2);
  EXPECT_EQ(read->stream->damaged, 1);
  EXPECT_EQ(read->stream->fps, 24.5);
  EXPECT_TRUE(read->stream->measured);

  std::string text = folder.Read("run.json");
  const std::size_t begin = text.find(',', text.find("\"damaged\": 1"));
  const std::size_t end = text.find("true", begin);
  ASSERT_NE(end, std::string::npos);
  text.erase(begin, end + 4 - begin);
  const auto earlier = ReadRunSummary(folder.Write("earlier.json", text));
  ASSERT_TRUE(earlier.ok() && earlier->stream) << earlier.status().message();
  EXPECT_EQ(earlier->stream->fps, 0);
  EXPECT_FALSE(earlier->stream->measured);
}

TEST(RunFolder, ComesBackAsItWasReported) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  ASSERT_TRUE(run->summary);
  EXPECT_EQ(run->summary->status, RunStatus::kLost);
  EXPECT_EQ(run->summary->note, "too few points");
  EXPECT_EQ(run->summary->description.command_line, (std::vector<std::string>{"pliant", "track"}));
  EXPECT_EQ(run->summary->description.input, (std::filesystem::current_path() / "clip.mp4").string());
  EXPECT_EQ(run->summary->description.camera, (std::filesystem::current_path() / "stereo.yaml").string());
  EXPECT_EQ(run->summary->description.mask, (std::filesystem::current_path() / "masks").string());
  EXPECT_EQ(run->summary->description.seed, 7u);
  EXPECT_EQ(run->summary->description.oracles, (std::vector<std::string>{"tracks"}));
  EXPECT_EQ(run->summary->description.image_scale, 0.75);
  EXPECT_EQ(run->summary->description.image_smoothing_px, 0.7);
  EXPECT_EQ(run->summary->description.patch_size, 21);
  EXPECT_EQ(run->summary->description.metric, std::nullopt);
  EXPECT_EQ(run->summary->frames_read, 5);
  EXPECT_EQ(run->summary->frames_tracked, 4);
  EXPECT_EQ(run->summary->points, kPoints);
  ASSERT_EQ(run->summary->first_maps.size(), 1u);
  const FirstMapFrames& first_map = run->summary->first_maps.front();
  EXPECT_EQ(first_map.reference_frame_idx, kFirstMap.reference_frame_idx);
  EXPECT_EQ(first_map.declared_frame_idx, kFirstMap.declared_frame_idx);
  EXPECT_TRUE(first_map.evidence.deforming);
  EXPECT_EQ(first_map.evidence.points, kFirstMap.evidence.points);
  EXPECT_EQ(first_map.evidence.depth_sigma, kFirstMap.evidence.depth_sigma);
  EXPECT_EQ(first_map.evidence.still_camera_error_ratio, kFirstMap.evidence.still_camera_error_ratio);
  EXPECT_EQ(first_map.evidence.focal_length_factor, kFirstMap.evidence.focal_length_factor);
  EXPECT_TRUE(first_map.evidence.uses_prior);
  const PriorCounts& prior = run->summary->prior;
  EXPECT_EQ(prior.compared, 3);
  EXPECT_EQ(prior.agree, 1);
  EXPECT_EQ(prior.fall, 2);
  EXPECT_EQ(prior.by_brightness, 1);
  EXPECT_EQ(prior.reestimated_maps, 1);
  EXPECT_THAT(run->summary->states,
              UnorderedElementsAre(Pair(TrackingState::kWaitingForReference, 1), Pair(TrackingState::kTracking, 4)));
  EXPECT_NEAR(run->summary->median_coverage, kCoverage, kRoundOff);
  EXPECT_NEAR(run->summary->median_followed_coverage, kFollowedCoverage, kRoundOff);
  EXPECT_EQ(run->summary->losses,
            (std::vector<std::pair<std::string, std::int64_t>>{{"similarity", 10}, {"border", 5}}));
  EXPECT_NEAR(run->summary->mean_ms[1].second, 2.25, kRoundOff);
  EXPECT_EQ(run->stage_names, kStages);
  ASSERT_EQ(run->frames.size(), 5u);
  EXPECT_EQ(run->frames[0].state, TrackingState::kWaitingForReference);
  EXPECT_EQ(run->frames[0].costs, (std::vector<CostTerm>{{"stretch", 0}, {"bending", 0}}));
  EXPECT_EQ(run->frames[3].costs, (std::vector<CostTerm>{{"stretch", 2.5}, {"bending", 0.125}}));
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
      EXPECT_EQ(o.sigma, 0.25);
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
  EXPECT_TRUE(run->summary->first_maps.empty());
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
  for (const auto& [row, says] : {std::pair("12,0,1,2,3,4,5", "observations.csv:3: a row has 9 columns"),
                                  std::pair("12,3,1,nan,3,4,5,1,0", "observations.csv:3: 'nan' is not a finite"),
                                  std::pair("12,0,1,2,3,4,5,1,0", "observations.csv:3: point 0 comes twice"),
                                  std::pair("9,3,1,2,3,4,5,1,0", "observations.csv:3: frame 9 comes after frame 12")}) {
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

TEST(RunFolder, FindsTheColumnsOfFramesByTheirNames) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 2);
  const std::string frames = folder.Read("run/frames.csv");
  EXPECT_TRUE(
      frames.starts_with("frame,timestamp,state,tracked,optimized,lost,added,cost_stretch,cost_bending,"
                         "median_reprojection_error_px,submap,ms_pyramid,ms_tracking,latency_ms\n"));
  folder.Write("run/frames.csv",
               "state,frame,unknown,timestamp,tracked,optimized,lost,added,median_reprojection_error_px,cost_a\n"
               "waiting_for_reference,10,?,0,0,0,0,0,0,0\n"
               "tracking,12,?,0.04,7,6,5,4,0.5,3\n");
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  const RunFrame& frame = run->frames[1];
  EXPECT_EQ(frame.frame_idx, 12);
  EXPECT_EQ(frame.lost, 5);
  EXPECT_EQ(frame.median_reprojection_error_px, 0.5);
  EXPECT_EQ(frame.costs, (std::vector<CostTerm>{{"a", 3}}));
  EXPECT_TRUE(run->stage_names.empty());
  folder.Write("run/frames.csv", "frame,timestamp,state,tracked,lost,added,median_reprojection_error_px\n");
  EXPECT_THAT(ReadRun(folder.Path("run")).status().message(), HasSubstr("frames.csv:1: the first line names no column "
                                                                        "'optimized'"));
}

TEST(RunFolder, ReadsARunOfAnEarlierVersion) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 2);
  folder.Write("run/frames.csv",
               "frame,timestamp,state,tracked,optimized,lost,added,cost_reprojection,cost_spatial,cost_temporal,"
               "cost_edge_length,median_reprojection_error_px,ms_prepare,ms_initialise\n"
               "10,0,initialising,0,0,0,0,0,0,0,0,0,1,2\n"
               "12,0.04,tracking,7,6,5,4,1,2,3,0,0.5,3,4\n");
  std::string summary = folder.Read("run/run.json");
  summary.replace(summary.find("pyramid"), 7, "initialise");
  folder.Write("run/run.json", summary);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->frames[0].state, TrackingState::kInitializing);
  EXPECT_EQ(run->frames[1].submap, 0);
  EXPECT_EQ(run->stage_names, (std::vector<std::string>{"prepare", "initialize"}));
  EXPECT_EQ(run->frames[1].costs,
            (std::vector<CostTerm>{{"reprojection", 1}, {"spatial", 2}, {"temporal", 3}, {"edge_length", 0}}));
  EXPECT_EQ(run->summary->mean_ms[0].first, "initialize");
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
  EXPECT_EQ((*last)->observations[0].sigma, 0);
  EXPECT_EQ(ReadRun(folder.Path("none")).status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(ReadRun(folder.Path(std::string(300, 'x'))).status().code(),
            ErrorCode::kNotFound);  // no name may be so long
}

TEST(RunFolder, ReadsColumnsBehindThoseOfEveryRunByTheirNames) {
  const TestFolder folder;
  folder.Write("observations.csv",
               "frame,point_id,u_px,v_px,x,y,z,color,sigma_mm,ssim\n4,1,10,20,1,2,3,red,0.5,0.75\n");
  auto reader = ObservationReader::Open(folder.Path(""));
  ASSERT_TRUE(reader.ok()) << reader.status().message();
  const auto frame = reader->Next();
  ASSERT_TRUE(frame.ok() && frame->has_value()) << frame.status().message();
  EXPECT_EQ((*frame)->observations[0].position.z(), 3);
  EXPECT_EQ((*frame)->observations[0].sigma, 0.5);
  EXPECT_EQ((*frame)->observations[0].ssim, 0.75);
}

TEST(RunFolder, GivesTheRowsOfFramesThatAreAskedForInGrowingOrder) {
  const TestFolder folder;
  folder.Write("observations.csv",
               "frame,point_id,u_px,v_px,x,y,z\n4,1,10,20,1,2,3\n6,1,10,20,1,2,3\n6,2,10,20,1,2,3\n9,5,10,20,1,2,3\n");
  auto reader = ObservationReader::Open(folder.Path(""));
  ASSERT_TRUE(reader.ok()) << reader.status().message();
  const auto ids = [&](int frame_idx) {
    std::vector<std::int64_t> found;
    const auto rows = reader->Of(frame_idx);
    EXPECT_TRUE(rows.ok()) << rows.status().message();
    if (rows.ok())
      for (const PointObservation& observation : *rows) found.push_back(observation.id.value);
    return found;
  };
  EXPECT_THAT(ids(5), IsEmpty()) << "passes over frame 4";
  EXPECT_THAT(ids(6), ElementsAre(1, 2)) << "which was read when frame 5 was asked for";
  EXPECT_THAT(ids(7), IsEmpty());
  const auto next = reader->Next();
  ASSERT_TRUE(next.ok() && next->has_value());
  EXPECT_EQ((*next)->frame_idx, 9) << "what was read ahead is the next";
  EXPECT_THAT(ids(10), IsEmpty());
  EXPECT_THAT(ids(11), IsEmpty()) << "after the end, too";
}

TEST(RunFolder, RefusesRowsThatAreNone) {
  const TestFolder folder;
  for (const std::string rows : {"frame,point_id,u_px,v_px,x,y,zz\n4,1,10,20,1,2,3\n", "frame,point_id\n4,1\n"}) {
    folder.Write("observations.csv", rows);
    EXPECT_FALSE(ObservationReader::Open(folder.Path("")).ok()) << rows;
  }
  for (const std::string row : {"4,1,10,20,1,2,3,0.9,-1", "4,1,10,20,1,2,3,0.9,nan", "4,1,10,20,1,2,3,0.9",
                                "4,1,10,20,1,2,3,0.9,0.1,5", "4,1,10,20,1,2,,0.9,0.1", "4,1,10,20,1,2,3,x,0.1"}) {
    folder.Write("observations.csv", "frame,point_id,u_px,v_px,x,y,z,ssim,sigma_mm\n" + row + "\n");
    auto reader = ObservationReader::Open(folder.Path(""));
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    EXPECT_FALSE(reader->Next().ok()) << row;
  }
}

}  // namespace
}  // namespace pliant
