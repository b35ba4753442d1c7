// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/run_sequence.h"

#include <system_error>
#include <utility>

#include "datasets/image_file.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/camera/same_camera.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_summary.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// The camera and the images' names.
Result<RunMap> MapFromSequence(const SequenceRequest& request, const Run& run) {
  const auto sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  RunMap known;
  known.camera = (*sequence)->camera();
  known.interlaced = run.summary && run.summary->description.interlaced;
  for (const RunFrame& frame : run.frames)
    if (auto name = (*sequence)->Name(frame.frame_idx)) known.names.emplace(frame.frame_idx, *std::move(name));
  return known;
}

Status NotOfRun(const std::string& what) {
  return {ErrorCode::kMismatch, what + "; are the images those that were tracked? Name them with --sequence"};
}

// The calibration that the run was made with, or, where that is gone, what its model says.
fs::path CameraOfRun(const std::string& run_path, const RunDescription& run) {
  std::error_code error;
  if (IsAssumedCamera(run.camera) || fs::exists(run.camera, error)) return run.camera;
  for (const char* model : {"sparse", "sparse/0"})
    if (fs::path cameras = fs::path(run_path) / model / "cameras.bin"; fs::exists(cameras, error)) return cameras;
  return run.camera;
}

std::string CameraText(const Camera& camera) {
  std::string text = std::string(camera.model_name()) + " of " + SizeText(camera.width(), camera.height()) + " (";
  for (const double param : camera.params()) text += (text.back() == '(' ? "" : " ") + FormatNumber("%.6g", param);
  return text + ")";
}

// What the given calibration says of images of the run's size. That of a pair says it after rectification alone.
Result<Camera> ReadGivenCamera(const std::string& path, const Camera& of_run) {
  if (IsAssumedCamera(path)) return MakeAssumedCamera(path, of_run.width(), of_run.height());
  CameraFileOptions options;
  options.image_size = ImageSize{of_run.width(), of_run.height()};
  return ReadCamera(path, options);
}

bool IsSamePath(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return a == b || fs::equivalent(a, b, error);
}

Status OtherCamera(const Camera& of_run, const std::string& what, const Camera& other, const std::string& advice) {
  return {ErrorCode::kMismatch, "the run was tracked with " + CameraText(of_run) + ", and " + what + " is " +
                                    CameraText(other) + "; " + advice};
}

// A run's points and poses are those of the camera that it was tracked with.
Status CheckGivenCamera(const SequenceRequest& request, const Camera& of_run) {
  if (request.camera_path.empty()) return Status::Ok();
  auto given = ReadGivenCamera(request.camera_path.string(), of_run);
  if (given.ok() && IsSameCamera(*given, of_run)) return Status::Ok();
  if (const auto sequence = OpenSequence(request); sequence.ok()) given = (*sequence)->camera();
  if (!given.ok()) return given.status();
  if (IsSameCamera(*given, of_run)) return Status::Ok();
  return OtherCamera(of_run, "--camera " + Quoted(request.camera_path.string()), *given,
                     "track the images again to use that one");
}

}  // namespace

SequenceRequest SequenceOfRun(const std::string& run_path, const std::filesystem::path& sequence_path,
                              const std::filesystem::path& camera_path) {
  SequenceRequest request{.image_path = sequence_path, .camera_path = camera_path};
  const auto summary = ReadRunSummary(run_path + "/run.json");
  if (!summary.ok()) return request;
  const std::filesystem::path input = summary->description.input;
  if (sequence_path.empty()) request.image_path = input;
  // Parts that were joined need not have begun a multiple of the stride apart.
  const FrameSelection& range = summary->description.range;
  request.start = range.start;
  request.end = range.end;
  request.stride = summary->description.joined_from.empty() ? range.stride : 1;
  request.spare_camera_path = CameraOfRun(run_path, summary->description);
  if (!IsSamePath(request.image_path, input)) return request;
  const std::filesystem::path mask = summary->description.mask;
  std::error_code error;
  if (std::filesystem::exists(mask, error)) request.mask_path = mask;
  return request;
}

Result<RunMap> KnownMapOfRun(const std::string& run_path, const SequenceRequest& sequence, const Run& run) {
  if (HasRunMap(run_path, run)) {
    auto known = ReadRunMap(run_path, run);
    if (!known.ok()) return known;
    if (Status status = CheckGivenCamera(sequence, *known->camera); !status.ok()) return status;
    return known;
  }
  if (!sequence.image_path.empty()) {
    auto known = MapFromSequence(sequence, run);
    if (known.ok()) return known;
    return Status(known.status().code(), "the run has no sparse/ to take the camera and the images' names from, and " +
                                             known.status().message());
  }
  return Status(ErrorCode::kNotFound, Quoted(run_path) +
                                          " has no sparse/ to take the camera and the images' names "
                                          "from; name its sequence with --sequence");
}

Status CheckCameraOfImages(const SequenceRequest& request, const Run& run, const Camera& of_run,
                           const Camera& of_images) {
  if (!request.camera_path.empty() || IsSameCamera(of_images, of_run)) return Status::Ok();
  if (of_images.width() != of_run.width() || of_images.height() != of_run.height()) return Status::Ok();
  if (run.summary && IsSamePath(request.image_path, run.summary->description.input) &&
      (!run.summary->description.camera.empty() || !run.summary->description.metric))
    return Status::Ok();
  return OtherCamera(of_run, "the calibration that belongs to the images " + Quoted(request.image_path.string()),
                     of_images,
                     "give the run's with --camera if the images are those that were tracked, or track them again");
}

Status CheckMasksOfRun(const SequenceRequest& request, const Run& run) {
  if (!request.mask_path.empty() || !run.summary || run.summary->description.mask.empty()) return Status::Ok();
  const std::string& mask = run.summary->description.mask;
  if (Exists(mask))
    return {ErrorCode::kNotFound, "the masks that the run was tracked with, " + Quoted(mask) +
                                      ", are of the images that it names, and others were given; name theirs, or the "
                                      "same again, with --mask_path"};
  return {ErrorCode::kNotFound,
          "the masks that the run was tracked with are not at " + Quoted(mask) + "; name them with --mask_path"};
}

Result<std::unique_ptr<Sequence>> OpenImagesOfRun(const std::string& run_path, const SequenceRequest& request) {
  if (request.image_path.empty())
    return Status(ErrorCode::kNotFound,
                  Quoted(run_path) + " does not say which images it is of; name them with --sequence");
  if (!Exists(request.image_path.string()))
    return Status(ErrorCode::kNotFound, "the images of the run are not at " + Quoted(request.image_path.string()) +
                                            "; name them with --sequence");
  return OpenSequence(request);
}

Result<SequenceFrame> NextFrameOfRun(const Camera& camera, int frame_idx, const std::string& name, Sequence* sequence) {
  const std::string frame_of_run = "frame " + std::to_string(frame_idx) + " of the run";
  while (true) {
    auto next = sequence->Next();
    if (!next.ok()) return next.status();
    if (!next->has_value()) return NotOfRun("the images end before " + frame_of_run);
    SequenceFrame& frame = **next;
    if (frame.frame_idx < frame_idx) continue;
    if (frame.frame_idx > frame_idx) return NotOfRun("the images have no " + frame_of_run);
    if (frame.image.cols != camera.width() || frame.image.rows != camera.height())
      return NotOfRun("image " + frame.name + " has " + SizeText(frame.image) + " pixels, and the run's camera has " +
                      SizeText(camera.width(), camera.height()));
    if (!name.empty() && !frame.name.empty() && frame.name != name)
      return NotOfRun(frame_of_run + " is image " + name + ", and here it is " + frame.name);
    return std::move(frame);
  }
}

}  // namespace pliant
