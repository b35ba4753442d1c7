// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/extensions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/tracking/bootstrapping/rigid_map.h"
#include "python/arrays.h"
#include "python/calibration.h"
#include "python/cost.h"
#include "python/errors.h"
namespace py = pybind11;

namespace pliant::python {
namespace {

py::array_t<double> PixelArray(const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<double> numbers;
  for (const Eigen::Vector2d& pixel : pixels) numbers.insert(numbers.end(), {pixel.x(), pixel.y()});
  return ArrayOf(std::move(numbers), {2});
}

std::vector<std::int64_t> IdsOf(const py::handle& array) {
  const auto ids = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!ids || ids.ndim() != 1) RaiseValueError("point_id of a map has to be a list of whole numbers");
  return {ids.data(), ids.data() + ids.size()};
}

void CheckCount(std::size_t count, std::size_t expected, const std::string& what) {
  if (count == expected) return;
  RaiseValueError(what + " of a map has " + std::to_string(count) + " entries, and there are " +
                  std::to_string(expected) + " point ids");
}

// A frame whose matrix is not a number has no known pose.
std::vector<std::optional<Rigid3>> PosesOf(const py::handle& array) {
  const auto poses = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!poses || poses.ndim() != 3 || poses.shape(1) != 4 || poses.shape(2) != 4)
    RaiseValueError("cam_from_world of a map has to be an array of shape (frames, 4, 4)");
  std::vector<std::optional<Rigid3>> cams_from_world;
  for (py::ssize_t k = 0; k < poses.shape(0); ++k) {
    const bool known =
        std::none_of(poses.data(k), poses.data(k) + 16, [](double number) { return std::isnan(number); });
    const py::object matrix = poses[py::int_(k)];
    cams_from_world.emplace_back();
    if (known) cams_from_world.back() = RigidOf(matrix, "cam_from_world of entry " + std::to_string(k));
  }
  return cams_from_world;
}

class PythonInitializer final : public Initializer {
 public:
  PythonInitializer(py::handle ask, std::string name, const TrackerOptions& options, Callbacks* callbacks)
      : ask_(ask),
        name_(std::move(name)),
        nominal_depth_mm_(options.init.monocular.nominal_depth_mm),
        min_points_(options.min_points),
        callbacks_(callbacks) {}

  std::string_view name() const override { return name_; }

  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    outcome.measured.correspondences = static_cast<int>(input.frames.back().observations.size());
    callbacks_->Call([&] { Ask(input, &outcome); });
    return outcome;
  }

 private:
  void Ask(const InitInput& input, InitOutcome* outcome) const {
    py::list frames;
    for (const InitFrame& frame : input.frames) {
      std::vector<std::int64_t> ids;
      for (const InitObservation& seen : frame.observations) ids.push_back(seen.id.value);
      frames.append(py::make_tuple(frame.frame_idx, ArrayOf(std::move(ids)), PixelArray(PixelsOf(frame.observations))));
    }
    const bool is_last = input.moment == InitMoment::kLastFrame;
    const auto answer = py::cast<py::dict>(ask_(frames, Calibration{input.camera}, is_last));
    outcome->reason = py::cast<std::string>(answer["reason"]);
    const auto decision = py::cast<std::string>(answer["decision"]);
    if (decision == "new_reference") outcome->decision = InitDecision::kNewReference;
    if (decision == "map") FillMap(input, answer, outcome);
  }

  void FillMap(const InitInput& input, const py::dict& answer, InitOutcome* outcome) const {
    const std::vector<std::int64_t> ids = IdsOf(answer["point_id"]);
    const std::vector<Eigen::Vector3d> positions = VectorsOf(answer["position"], "position of a map");
    CheckCount(positions.size(), ids.size(), "position");
    std::vector<double> sigmas(ids.size(), 0.0);
    if (!answer["sigma"].is_none()) sigmas = py::cast<std::vector<double>>(answer["sigma"].attr("tolist")());
    CheckCount(sigmas.size(), ids.size(), "sigma");
    RigidMap map{.points = {}, .cams_from_world = PosesOf(answer["cam_from_world"])};
    for (std::size_t i = 0; i < ids.size(); ++i) map.points.push_back({PointId{ids[i]}, positions[i], sigmas[i]});
    const Status status = FillRigidMap(input, map, min_points_, nominal_depth_mm_, outcome);
    if (status.code() == ErrorCode::kInvalidArgument) Raise(status);
    if (!status.ok()) {
      outcome->reason = status.message();
      return;
    }
    outcome->provisional = py::cast<bool>(answer["provisional"]);
    if (outcome->reason.empty()) outcome->reason = "first map of " + std::to_string(ids.size()) + " points";
  }

  py::handle ask_;
  std::string name_;
  double nominal_depth_mm_;
  int min_points_;
  Callbacks* callbacks_;
};

class PythonTracks final : public TrackSource {
 public:
  PythonTracks(py::handle follow, Callbacks* callbacks) : follow_(follow), callbacks_(callbacks) {}

  TrackAbilities abilities() const override { return {.finds_points = false, .tracks_blurred = false}; }

  std::optional<PointId> Add(const Eigen::Vector2d& pixel, const PreparedFrame&) override {
    const PointId id{next_id_++};
    kept_[id] = pixel;
    return id;
  }
  bool Resume(PointId id, const Eigen::Vector2d& pixel, const PreparedFrame&) override {
    kept_[id] = pixel;
    next_id_ = std::max(next_id_, id.value + 1);
    return true;
  }
  PointId next_id() const override { return PointId{next_id_}; }
  void SkipIds(PointId next) override { next_id_ = std::max(next_id_, next.value); }
  void Remove(PointId id) override { kept_.erase(id); }

  std::vector<PointTrack> Track(const PreparedFrame& previous, const PreparedFrame& current,
                                std::span<const PointPrediction> predictions) override {
    found_.clear();
    std::vector<PointTrack> tracks = NotFound(predictions, PatchFailure::kUnknownPoint);
    std::vector<Eigen::Vector2d> from;
    std::vector<Eigen::Vector2d> expected;
    std::vector<PointTrack*> asked;
    for (PointTrack& track : tracks) {
      const auto known = kept_.find(track.id);
      if (known == kept_.end()) continue;
      track.failure = PatchFailure::kOccluded;  // unless it is found
      asked.push_back(&track);
      from.push_back(known->second);
      expected.push_back(track.pixel);
    }
    if (asked.empty()) return tracks;
    callbacks_->Call([&] {
      const auto answer = py::cast<py::tuple>(
          follow_(ImageTuple(previous), ImageTuple(current), PixelArray(from), PixelArray(expected)));
      const auto pixels = PointsOf(answer[0], 2, "the pixels that follow returns");
      const auto seen = py::array_t<bool, py::array::c_style | py::array::forcecast>::ensure(answer[1]);
      const auto count = static_cast<py::ssize_t>(asked.size());
      if (pixels.shape(0) != count || !seen || seen.ndim() != 1 || seen.shape(0) != count)
        RaiseValueError("follow has to return as many pixels and as many visible as it is given pixels, " +
                        std::to_string(count));
      for (py::ssize_t k = 0; k < count; ++k)
        if (seen.at(k)) Found({pixels.at(k, 0), pixels.at(k, 1)}, current, asked[static_cast<std::size_t>(k)]);
    });
    return tracks;
  }
  std::vector<PointTrack> Find(const PreparedFrame&, std::span<const PointPrediction> predictions) override {
    return NotFound(predictions, PatchFailure::kOccluded);
  }
  void Keep(std::span<const PointId> ids) override {
    for (const PointId id : ids)
      if (const auto found = found_.find(id); found != found_.end()) kept_[id] = found->second;
  }
  std::vector<PointTrack> TrackIntoBlur(const PreparedFrame&, const PreparedFrame&,
                                        std::span<const PointPrediction> predictions) const override {
    return NotFound(predictions, PatchFailure::kOccluded);
  }

 private:
  static std::vector<PointTrack> NotFound(std::span<const PointPrediction> predictions, PatchFailure failure) {
    std::vector<PointTrack> tracks;
    for (const PointPrediction& prediction : predictions)
      tracks.push_back({.id = prediction.id, .failure = failure, .pixel = prediction.pixel});
    return tracks;
  }

  static py::tuple ImageTuple(const PreparedFrame& frame) {
    return py::make_tuple(frame.frame_idx, frame.timestamp_s, ImageArray(frame.gray));
  }

  void Found(const Eigen::Vector2d& pixel, const PreparedFrame& frame, PointTrack* track) {
    if (!pixel.allFinite()) RaiseValueError("follow returned a pixel that is not a number and says that it is visible");
    track->pixel = pixel;
    const Eigen::Array2d at = pixel.array().round();  // may be too far away for an integer
    const bool inside = (at >= 0).all() && at.x() < frame.gray.cols && at.y() < frame.gray.rows;
    if (!inside) {
      track->failure = PatchFailure::kOutOfImage;
    } else if (!frame.mask.unrestricted() && !frame.mask.Valid(static_cast<int>(at.x()), static_cast<int>(at.y()))) {
      track->failure = PatchFailure::kMasked;
    } else {
      track->failure = PatchFailure::kNone;
      track->ssim = 1;
      found_[track->id] = pixel;
    }
  }

  py::handle follow_;
  Callbacks* callbacks_;
  std::int64_t next_id_ = 0;
  std::map<PointId, Eigen::Vector2d> kept_;   // where they were last kept
  std::map<PointId, Eigen::Vector2d> found_;  // by the present attempt
};

}  // namespace

TrackerExtensions ExtensionsOf(const py::dict& given, const TrackerOptions& options, Callbacks* callbacks) {
  TrackerExtensions extensions;
  const py::handle initializer = given["initializer"];
  const py::handle tracks = given["tracks"];
  if (!initializer.is_none())
    extensions.initializer = std::make_shared<PythonInitializer>(
        initializer, py::cast<std::string>(given["initializer_name"]), options, callbacks);
  if (!tracks.is_none())
    extensions.make_tracks = [tracks, callbacks] { return std::make_unique<PythonTracks>(tracks, callbacks); };
  extensions.cost = FrameCostOf(given, callbacks);
  return extensions;
}

}  // namespace pliant::python
