// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_trust.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/camera/assumed_camera.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Key;
using testing::Not;

RunSummary Summary(const FirstMapEvidence& evidence) {
  RunSummary summary;
  summary.frames_read = 100;
  summary.frames_tracked = 90;
  summary.states = {{TrackingState::kTracking, 90}, {TrackingState::kInitializing, 10}};
  summary.first_maps = {{0, 30, evidence}};
  summary.median_coverage = 0.8;
  summary.median_reprojection_error_px = 0.21;
  return summary;
}

std::map<std::string, std::string> Trust(const RunSummary& summary) {
  const auto trust = TrustIn(summary);
  return {trust.begin(), trust.end()};
}

constexpr FirstMapEvidence kKnown = {.deforming = true,
                                     .points = 200,
                                     .median_parallax_deg = 8,
                                     .depth_sigma = 0.01,
                                     .depth_spread = 0.2,
                                     .still_camera_error_ratio = 1.8};

TEST(RunTrust, SaysWhatAGoodRunHas) {
  const auto trust = Trust(Summary(kKnown));
  EXPECT_THAT(trust.at("frames"), HasSubstr("90 of 100 frames have a map (90 %)"));
  EXPECT_THAT(trust.at("depth"), HasSubstr("spread by 20.0 % and are known to 1.0 % (200 points, parallax 8.0 deg)"));
  EXPECT_THAT(trust.at("depth"), HasSubstr("can be trusted to about that, if the calibration is right."));
  EXPECT_THAT(trust.at("camera"), HasSubstr("1.80 times as large"));
  EXPECT_THAT(trust.at("tracks"), HasSubstr("0.21 px"));
  EXPECT_THAT(trust.at("coverage"), HasSubstr("80 %"));
  EXPECT_THAT(trust, Not(Contains(Key("advice"))));
}

TEST(RunTrust, OfARefinedRunSaysNothingOfTheFirstMap) {
  FirstMapEvidence evidence = kKnown;
  evidence.depth_sigma = 0.15;
  evidence.focal_length_factor = 0.75;
  RunSummary summary = Summary(evidence);
  summary.description.refined_from = "/runs/run";
  summary.description.refinement = RunRefinement{{RefinedModel::kRigid}, 0.008};
  const auto trust = Trust(summary);
  for (const auto& [topic, sentences] : trust) EXPECT_THAT(sentences, Not(HasSubstr("irst map"))) << topic;
  EXPECT_THAT(trust.at("depth"), HasSubstr("points' distances from the camera are known to 0.8 % in the median"));
  EXPECT_THAT(trust.at("depth"), HasSubstr("if the calibration is right"));
  EXPECT_THAT(trust.at("camera"), HasSubstr("The scene was taken for rigid"));
  EXPECT_THAT(trust.at("tracks"), HasSubstr("0.21 px"));
  EXPECT_THAT(trust.at("calibration"), HasSubstr("contradict")) << "the calibration is the run's";
  EXPECT_THAT(trust.at("advice"), Not(HasSubstr("more parallax")));

  summary.description.refinement = RunRefinement{{RefinedModel::kDeforming, RefinedModel::kUnchanged}, 0.008, true};
  const auto of_two = Trust(summary);
  EXPECT_THAT(of_two.at("camera"), HasSubstr("Submap 0: the scene was taken for deforming"));
  EXPECT_THAT(of_two.at("camera"), HasSubstr("Submap 1: it could not be refined"));
  EXPECT_THAT(of_two.at("depth"), Not(HasSubstr("calibration")));
  EXPECT_THAT(of_two.at("calibration"), Not(HasSubstr("contradict")));
  EXPECT_THAT(of_two, Not(Contains(Key("advice"))));

  summary.description.refinement.reset();  // an earlier version's
  EXPECT_THAT(Trust(summary), Not(Contains(Key("depth"))));
  EXPECT_THAT(Trust(summary), Not(Contains(Key("camera"))));
}

TEST(RunTrust, OfAnAssumedCameraAdvisesNoRefinementThatWasTried) {
  const auto refine = HasSubstr("pliant refine");
  const std::string warning = std::string(kAssumedCameraWarning) + " (fov:70 degrees are assumed)";
  RunSummary summary = Summary(kKnown);
  summary.description.camera = "fov:70";
  summary.description.warnings = {warning, "the images are repeated"};
  const auto tracked = Trust(summary);
  EXPECT_THAT(tracked.at("calibration"), HasSubstr("fov:70 degrees were assumed"));
  EXPECT_EQ(tracked.at("recording"), "the images are repeated.") << "what calibration says is not said twice";
  EXPECT_THAT(tracked.at("advice"), refine);

  summary.description.refined_from = "/runs/run";
  summary.description.refinement = RunRefinement{{RefinedModel::kRigid}, 0.008, false, "nothing determines it"};
  const auto refined = Trust(summary);
  EXPECT_THAT(refined.at("calibration"),
              HasSubstr("The refinement was to estimate the focal length and kept it: nothing determines it."));
  EXPECT_THAT(refined.at("advice"), testing::AllOf(HasSubstr("Calibrate the camera"), Not(refine)));

  const TestFolder folder;
  ASSERT_TRUE(WriteRunSummary(folder.Path("run.json"), summary).ok());
  EXPECT_EQ(ReadRunSummary(folder.Path("run.json"))->description.refinement->focal_length_kept,
            "nothing determines it");
}

TEST(RunTrust, SaysNoErrorThatIsZero) {
  RunSummary summary = Summary(kKnown);
  summary.median_reprojection_error_px = 0.002;
  EXPECT_THAT(Trust(summary).at("tracks"), HasSubstr("Points lie less than 0.01 px"));
}

TEST(RunTrust, TheErrorOfPointsThatMoveByThemselvesDoesNotSayThatTheyAreRight) {
  const auto says_so = HasSubstr("their displacements take up the error");
  EXPECT_THAT(Trust(Summary(kKnown)).at("tracks"), says_so);
  FirstMapEvidence rigid = kKnown;
  rigid.deforming = false;
  RunSummary summary = Summary(rigid);
  EXPECT_THAT(Trust(summary).at("tracks"), Not(says_so));
  summary.states = {{TrackingState::kProvisional, 90}, {TrackingState::kInitializing, 10}};
  EXPECT_THAT(Trust(summary).at("tracks"), says_so);
  summary.description.refinement = RunRefinement{{RefinedModel::kRigid}, 0.008};
  EXPECT_THAT(Trust(summary).at("tracks"), Not(says_so));
}

TEST(RunTrust, ImagesThatShowTooLittleAreNoLackOfMotion) {
  RunSummary summary = Summary(kKnown);
  summary.frames_tracked = 60;
  summary.states = {{TrackingState::kTracking, 60}, {TrackingState::kWaitingForReference, 40}};
  EXPECT_THAT(Trust(summary).at("frames"), HasSubstr("in 40 the image showed too little to start from"));
  EXPECT_THAT(Trust(summary), Not(Contains(Key("advice"))));
  summary.states = {{TrackingState::kTracking, 60}, {TrackingState::kInitializing, 40}};
  EXPECT_THAT(Trust(summary).at("advice"), HasSubstr("the camera moved too little"));
}

TEST(RunTrust, OfARunWithoutAMapTheNoteSaysWhatWasMissing) {
  RunSummary summary = Summary(kKnown);
  summary.frames_tracked = 0;
  summary.first_maps.clear();
  summary.states = {{TrackingState::kInitializing, 100}};
  EXPECT_THAT(Trust(summary), Not(Contains(Key("advice"))));
}

TEST(RunTrust, ALiveRunWithoutAMapSaysHowManyImagesWereSkipped) {
  RunSummary summary = Summary(kKnown);
  summary.description.input = "/runs/or_recording";
  summary.stream = StreamCounts{.received = 150, .skipped = 50};
  EXPECT_EQ(AdviceOnSkippedImages(summary), "") << "it has a map";
  summary.frames_tracked = 0;
  summary.first_maps.clear();
  summary.states = {{TrackingState::kInitializing, 100}};
  const std::string advice = Trust(summary).at("advice");
  EXPECT_THAT(advice, HasSubstr("50 of 150 images were skipped"));
  EXPECT_THAT(advice, HasSubstr("--LiveInput.frames all"));
  EXPECT_THAT(advice, HasSubstr("pliant track /runs/or_recording."));
  summary.stream->skipped = 0;
  EXPECT_EQ(AdviceOnSkippedImages(summary), "");
}

TEST(RunTrust, TellsWhetherTextureOrDepthIsMissing) {
  RunSummary summary = Summary(kKnown);
  summary.median_coverage = 0.3;
  summary.median_followed_coverage = 0.4;
  EXPECT_THAT(Trust(summary).at("coverage"), HasSubstr("30 % of the scene lies near a point"));
  EXPECT_THAT(Trust(summary).at("coverage"), HasSubstr("and 40 % with points that are followed"));
  EXPECT_THAT(Trust(summary).at("advice"), HasSubstr("--Corners.max_corners"));
  summary.median_followed_coverage = 0.8;
  EXPECT_THAT(Trust(summary).at("advice"), HasSubstr("move the camera sideways"));
  EXPECT_THAT(Trust(summary).at("advice"), Not(HasSubstr("--Corners.max_corners")));
}

TEST(RunTrust, SaysThatDepthsAloneShowThatTheCameraMoves) {
  FirstMapEvidence noisy = kKnown;
  noisy.still_camera_error_ratio = 1.12;
  noisy.moves_by_depth = true;
  EXPECT_THAT(Trust(Summary(kKnown)).at("camera"), HasSubstr("so it moved."));
  const std::string camera = Trust(Summary(noisy)).at("camera");
  EXPECT_THAT(camera, HasSubstr("1.12 times as large, too little to tell in so much noise"));
  EXPECT_THAT(camera, Not(HasSubstr("so it moved")));
}

TEST(RunTrust, SaysWhatBecameOfADepthPrior) {
  RunSummary summary = Summary(kKnown);
  summary.prior = {.compared = 60, .agree = 50, .fall = 3};
  EXPECT_THAT(Trust(summary), Not(Contains(Key("depth_prior")))) << "no folder was given";
  summary.description.depth_prior = "/priors";
  EXPECT_EQ(Trust(summary).at("depth_prior"),
            "A depth prior was given and had no effect: no map took depths from it. It agrees with the map in 50 of 60 "
            "frames.");
  summary.first_maps.front().evidence.uses_prior = true;
  EXPECT_THAT(Trust(summary).at("depth_prior"), HasSubstr("given; 1 map, first or re-estimated, took depths from it."));
  summary.prior.reestimated_maps = 2;
  EXPECT_THAT(Trust(summary).at("depth_prior"), HasSubstr("given; 3 maps, first or re-estimated, took"));
  summary.prior = {};
  summary.first_maps.front().evidence.uses_prior = false;
  EXPECT_THAT(Trust(summary).at("depth_prior"), HasSubstr("it counts where brightness is no depth cue"));
}

TEST(RunTrust, AsksWhetherTheKindOfADepthPriorIsRightWhereItFallsInNearlyAllFrames) {
  RunSummary summary = Summary(kKnown);
  summary.description.depth_prior = "/priors";
  EXPECT_EQ(DoubtOfPrior(summary), "");
  summary.prior = {.compared = 60, .agree = 5, .fall = 47};
  EXPECT_EQ(DoubtOfPrior(summary), "");
  summary.prior.fall = 48;
  EXPECT_EQ(
      DoubtOfPrior(summary),
      "the depth prior falls where the map's values grow in 48 of 60 frames: is it of the other DepthPrior.kind?");
  EXPECT_THAT(Trust(summary).at("depth_prior"), HasSubstr("The depth prior falls where the map's values grow in 48"));
  EXPECT_THAT(Trust(summary).at("depth_prior"), Not(HasSubstr("agrees")));

  summary.first_maps = {{0, 0, {.provisional = true, .points = 200, .uses_prior = true}}};
  summary.prior.by_brightness = 60;
  const std::string alone = Trust(summary).at("depth_prior");
  EXPECT_THAT(alone, HasSubstr("nothing confirmed them. The depth prior falls where by brightness it should grow"));
  EXPECT_THAT(alone, EndsWith("Where the light is not at the camera, set WindowInit.light off."));
}

TEST(RunTrust, DepthsThatAreHardlyBetterThanOneAreNoneToTrust) {
  FirstMapEvidence flat = kKnown;
  flat.depth_spread = 0.02;
  flat.median_parallax_deg = 1;
  flat.provisional = true;
  RunSummary summary = Summary(flat);
  summary.states = {{TrackingState::kProvisional, 90}, {TrackingState::kInitializing, 10}};
  const auto trust = Trust(summary);
  EXPECT_THAT(trust.at("frames"), HasSubstr("in 90 of them it is provisional"));
  EXPECT_THAT(trust.at("depth"), HasSubstr("hardly better than one constant depth"));
  EXPECT_THAT(trust.at("advice"), HasSubstr("more parallax"));
}

TEST(RunTrust, WhereParallaxIsThereOtherCausesAreNamed) {
  FirstMapEvidence flat = kKnown;
  flat.depth_spread = 0.02;
  flat.median_parallax_deg = 25;
  RunSummary summary = Summary(flat);
  summary.median_coverage = 0.3;
  summary.median_followed_coverage = 0.8;
  const std::string advice = Trust(summary).at("advice");
  EXPECT_THAT(advice, Not(HasSubstr("sideways")));
  EXPECT_THAT(advice, HasSubstr("Parallax is not what is missing: check the calibration, mask"));
}

TEST(RunTrust, AMapWhoseSpreadWasNotMeasuredIsNotJudgedByIt) {
  FirstMapEvidence gated = kKnown;
  gated.deforming = false;
  gated.depth_spread = gated.still_camera_error_ratio = 0;
  EXPECT_THAT(Trust(Summary(gated)), Not(Contains(Key("advice"))));
  EXPECT_THAT(Trust(Summary(gated)).at("camera"), HasSubstr("whether the camera moved at all was not tested"));
}

TEST(RunTrust, SaysThatTheCalibrationIsContradicted) {
  EXPECT_THAT(Trust(Summary(kKnown)), Not(Contains(Key("calibration"))));
  FirstMapEvidence contradicted = kKnown;
  contradicted.focal_length_factor = 0.75;
  const auto trust = Trust(Summary(contradicted));
  EXPECT_THAT(trust.at("calibration"), HasSubstr("about 0.75 times its focal length"));
  EXPECT_THAT(trust.at("advice"), HasSubstr("Calibrate the camera"));
}

TEST(RunTrust, AnAmbiguousRunIsToldWhatToDo) {
  RunSummary summary = Summary(kKnown);
  summary.frames_tracked = 0;
  summary.median_reprojection_error_px = 0;
  summary.median_coverage = 0;
  summary.first_maps.clear();
  summary.states = {{TrackingState::kAmbiguous, 100}};
  const auto trust = Trust(summary);
  EXPECT_THAT(trust.at("frames"), HasSubstr("in 100 camera and scene cannot be told apart"));
  EXPECT_THAT(trust.at("advice"), HasSubstr("--Init.method depth"));
  EXPECT_THAT(trust, Not(Contains(Key("depth"))));
  EXPECT_THAT(trust, Not(Contains(Key("tracks"))));
}

TEST(RunTrust, SaysThatARigidMapIsOfASceneThatDeformsLittle) {
  FirstMapEvidence trembling = kKnown;
  trembling.deforming = false;
  const auto trust = Trust(Summary(trembling));
  EXPECT_THAT(trust.at("camera"),
              HasSubstr("The scene deforms, but so little that a rigid map knows its depths better; "
                        "with a camera that stands still"));
}

TEST(RunTrust, SaysThatASceneTakenForRigidWasFoundToDeform) {
  FirstMapEvidence rigid = kKnown;
  rigid.deforming = false;
  RunSummary summary = Summary(rigid);
  EXPECT_THAT(Trust(summary).at("depth"), Not(HasSubstr("found to deform")));
  summary.states = {{TrackingState::kTracking, 60}, {TrackingState::kProvisional, 30}};
  EXPECT_THAT(Trust(summary).at("depth"), HasSubstr("taken for rigid and then found to deform"));
  summary.first_maps[0].evidence.provisional = true;
  EXPECT_THAT(Trust(summary).at("depth"), Not(HasSubstr("found to deform"))) << "it never was certain";
}

TEST(RunTrust, TellsSeveralMapsApart) {
  RunSummary summary = Summary(kKnown);
  FirstMapEvidence rigid = kKnown;
  rigid.deforming = false;
  rigid.still_camera_error_ratio = 0;
  summary.first_maps.push_back({50, 60, rigid});
  const auto trust = Trust(summary);
  EXPECT_THAT(trust.at("camera"), HasSubstr("Map 0: the scene deforms"));
  EXPECT_THAT(trust.at("camera"), HasSubstr("Map 1: the scene was taken for rigid"));
}

TEST(RunTrust, MethodsThatMeasureNothingClaimNothing) {
  const auto trust = Trust(Summary({.points = 200}));
  EXPECT_THAT(trust, Not(Contains(Key("depth"))));
  EXPECT_THAT(trust, Not(Contains(Key("camera"))));
}

TEST(RunTrust, SaysHowNoisyTheImagesAreWhereItWasMeasured) {
  RunSummary summary = Summary(kKnown);
  EXPECT_THAT(Trust(summary), Not(Contains(Key("images"))));
  summary.description.image_noise_levels = 1.25;
  summary.description.track_noise_px = 0.151;
  summary.description.alive_after_9 = 0.4;
  const std::string images = Trust(summary).at("images");
  EXPECT_THAT(images, HasSubstr("to 0.15 px"));
  EXPECT_THAT(images, HasSubstr("40 % of the corners"));
  EXPECT_THAT(images, HasSubstr("noise of 1."));
  summary.description.image_noise_levels = 0;  // black images
  EXPECT_THAT(Trust(summary).at("images"), testing::StartsWith("In the first images points are tracked to 0.15 px"));
}

TEST(RunTrust, ListsWhatIsOddAboutTheRecording) {
  RunSummary summary = Summary(kKnown);
  EXPECT_THAT(Trust(summary), Not(Contains(Key("recording"))));
  summary.description.warnings = {"8 of 16 images repeat the one before", "the frame rate varies"};
  EXPECT_EQ(Trust(summary).at("recording"), "8 of 16 images repeat the one before. the frame rate varies.");
}

TEST(RunTrust, ARunWithoutFramesSaysNothing) { EXPECT_TRUE(TrustIn({}).empty()); }

}  // namespace
}  // namespace pliant
