// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/page_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pliant/base/version.h"
#include "viewer/frame_geometry.h"
#include "viewer/pack_array.h"
#include "viewer/page_asset.h"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

// null where it is not a number.
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <class Value>
Json Column(const ViewedRun& run, const Value& value) {
  Json column = Json::array();
  for (const ViewedFrame& frame : run.frames) column.push_back(value(frame));
  return column;
}

Json OptionalColumn(const std::vector<std::optional<double>>& values) {
  Json column = Json::array();
  for (const std::optional<double>& value : values) column.push_back(value ? Number(*value) : Json(nullptr));
  return column;
}

void AppendPose(const Rigid3& world_from_cam, std::vector<float>* values) {
  const Eigen::Quaterniond& q = world_from_cam.rotation;
  const Eigen::Vector3d& t = world_from_cam.translation;
  for (const double value : {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()})
    values->push_back(static_cast<float>(value));
}

Json FramePosesOf(const ViewedRun& run) {
  std::vector<float> values;
  for (const ViewedFrame& frame : run.frames) {
    if (frame.world_from_cam)
      AppendPose(*frame.world_from_cam, &values);
    else
      values.insert(values.end(), 7, kUnknown);
  }
  return PackFloats(values, 7);
}

// What a run writes as 0 where there is nothing to measure is null: the error of a frame without a pose, or of points
// that were placed at their pixels, and the terms of a frame for which no joint problem was solved.
Json ReprojectionErrorOf(const ViewedFrame& frame) {
  const double error_px = frame.row.median_reprojection_error_px;
  return frame.world_from_cam && error_px > 0 ? Number(error_px) : Json(nullptr);
}

Json CostIn(const ViewedFrame& frame, const std::string& term) {
  const auto& costs = frame.row.costs;
  const bool solved = std::ranges::any_of(costs, [](const CostTerm& cost) { return cost.value != 0; });
  return solved ? Number(CostOf(costs, term)) : Json(nullptr);
}

Json Frames(const ViewedRun& run) {
  const auto row = [](auto member) { return [member](const ViewedFrame& f) { return Json(f.row.*member); }; };
  Json frames = {{"frame", Column(run, row(&RunFrame::frame_idx))},
                 {"time", Column(run, row(&RunFrame::timestamp_s))},
                 {"state", Column(run, [](const ViewedFrame& f) { return EnumName(f.row.state); })},
                 {"submap", Column(run, row(&RunFrame::submap))},
                 {"tracked", Column(run, row(&RunFrame::tracked))},
                 {"pose", FramePosesOf(run)},
                 {"note", Json::object()},
                 {"costs", Json::object()},
                 {"stages_ms", Json::object()},
                 {"errors", Json::object()}};
  const bool has = run.has_rows;
  const auto known = [&](auto member) {
    return Column(run, [&](const ViewedFrame& f) { return has ? Json(f.row.*member) : Json(nullptr); });
  };
  frames["optimized"] = known(&RunFrame::optimized);
  frames["lost"] = known(&RunFrame::lost);
  frames["added"] = known(&RunFrame::added);
  frames["reprojection_px"] =
      Column(run, [&](const ViewedFrame& f) { return has ? ReprojectionErrorOf(f) : Json(nullptr); });
  if (has) {
    for (const CostTerm& cost : run.frames.empty() ? std::vector<CostTerm>() : run.frames.front().row.costs) {
      std::string label = cost.name;
      std::ranges::replace(label, '_', ' ');
      frames["costs"][label] = Column(run, [&](const ViewedFrame& f) { return CostIn(f, cost.name); });
    }
    for (std::size_t i = 0; i < run.stage_names.size(); ++i)
      frames["stages_ms"][run.stage_names[i]] = Column(run, [i](const ViewedFrame& f) {
        return i < f.row.stage_ms.size() ? Number(f.row.stage_ms[i]) : Json(nullptr);
      });
  }
  for (const auto& [name, values] : run.errors) frames["errors"][name] = OptionalColumn(values);
  frames["scale"] = run.scales.empty() ? Json(nullptr) : OptionalColumn(run.scales);
  for (std::size_t i = 0; i < run.frames.size(); ++i)
    if (!run.frames[i].note.empty()) frames["note"][std::to_string(i)] = run.frames[i].note;
  return frames;
}

Json Points(const ViewedRun& run) {
  // A number of the page has 32 bits: larger ids of other programs are counted through.
  const bool fits = run.points.empty() || (run.points.begin()->first.value >= 0 &&
                                           run.points.rbegin()->first.value < std::int64_t{0xFFFFFFFF});
  std::vector<std::uint32_t> ids;
  std::vector<float> rest;
  std::vector<std::uint32_t> rgb;
  for (const auto& [id, point] : run.points) {
    ids.push_back(static_cast<std::uint32_t>(fits ? id.value : static_cast<std::int64_t>(ids.size())));
    for (int i = 0; i < 3; ++i) rest.push_back(static_cast<float>(point.position[i]));
    rgb.insert(rgb.end(), point.rgb.begin(), point.rgb.end());
  }
  return {{"id", PackWhole(ids, 1, PackedType::kU32)},
          {"rest", PackQuantized(rest, 3, PackedType::kU16)},
          {"rgb", PackWhole(rgb, 3, PackedType::kU8)}};
}

// A run's observations point by point.
class Observations {
 public:
  explicit Observations(const ViewedRun& run) {
    std::size_t count = 0;
    for (const ViewedFrame& frame : run.frames) count += frame.observations.size();
    std::unordered_map<PointId, std::uint32_t> positions;
    for (const auto& [id, point] : run.points) positions.emplace(id, static_cast<std::uint32_t>(positions.size()));
    sorted_.reserve(count);
    for (std::size_t row = 0; row < run.frames.size(); ++row)
      for (const ViewedObservation& o : run.frames[row].observations)
        sorted_.push_back({positions.at(o.id), static_cast<std::uint32_t>(row), &o});
    std::stable_sort(sorted_.begin(), sorted_.end(), [](const Seen& a, const Seen& b) { return a.point < b.point; });
    counts_.assign(run.points.size(), 0);
    for (const Seen& seen : sorted_) ++counts_[seen.point];
  }

  Json ToJson() const {
    std::vector<std::uint32_t> rows;
    for (const Seen& seen : sorted_) rows.push_back(seen.row);
    Json packed = {{"count", counts_},
                   {"row", PackWhole(rows, 1, PackedType::kU32)},
                   {"pixel", Vectors<2>(&ViewedObservation::pixel)},
                   {"position", Vectors<3>(&ViewedObservation::position)},
                   {"depth", Numbers(&ViewedObservation::depth, PackedType::kU16)},
                   {"reprojection_px", Numbers(&ViewedObservation::reprojection_px, PackedType::kU16)},
                   {"ssim", Numbers(&ViewedObservation::ssim, PackedType::kU8)}};
    packed["sigma"] =
        Any(&ViewedObservation::sigma) ? Numbers(&ViewedObservation::sigma, PackedType::kU16) : Json(nullptr);
    const bool bright = Any(&ViewedObservation::gain);
    packed["gain"] = bright ? Numbers(&ViewedObservation::gain, PackedType::kU16) : Json(nullptr);
    packed["bias"] = bright ? Numbers(&ViewedObservation::bias, PackedType::kU16) : Json(nullptr);
    const bool truth = Any(&ViewedObservation::error_mm);
    packed["truth"] = truth ? Vectors<3>(&ViewedObservation::truth) : Json(nullptr);
    packed["error_mm"] = truth ? Numbers(&ViewedObservation::error_mm, PackedType::kU16) : Json(nullptr);
    return packed;
  }

 private:
  struct Seen {
    std::uint32_t point;
    std::uint32_t row;
    const ViewedObservation* observation;
  };

  bool Any(float ViewedObservation::*member) const {
    return std::any_of(sorted_.begin(), sorted_.end(),
                       [&](const Seen& seen) { return std::isfinite(seen.observation->*member); });
  }
  Json Numbers(float ViewedObservation::*member, PackedType type) const {
    std::vector<float> values;
    values.reserve(sorted_.size());
    for (const Seen& seen : sorted_) values.push_back(seen.observation->*member);
    return PackQuantized(values, 1, type);
  }
  template <int N>
  Json Vectors(Eigen::Matrix<float, N, 1> ViewedObservation::*member) const {
    std::vector<float> values;
    values.reserve(N * sorted_.size());
    for (const Seen& seen : sorted_)
      for (int i = 0; i < N; ++i) values.push_back((seen.observation->*member)[i]);
    return PackQuantized(values, N, PackedType::kU16);
  }

  std::vector<Seen> sorted_;
  std::vector<std::uint32_t> counts_;
};

Json Texts(const std::vector<NamedText>& texts, bool as_options) {
  Json rows = Json::array();
  for (const NamedText& text : texts) {
    if (as_options)
      rows.push_back({text.group + "." + text.name, text.value});
    else
      rows.push_back({text.group, text.name, text.value});
  }
  return rows;
}

std::string UnitOf(bool in_millimeters) { return in_millimeters ? "mm" : "map units"; }

Json Positions(const std::vector<Eigen::Vector3f>& positions, const std::vector<Eigen::Vector3f>& from) {
  std::vector<float> values;
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (int i = 0; i < 3; ++i) values.push_back(positions[v][i] - (from.empty() ? 0.0F : from[v][i]));
  return PackQuantized(values, 3, PackedType::kU16);
}

Json MeshData(const ViewedMesh& viewed) {
  const GltfMesh& surface = viewed.surface;
  const Mesh& mesh = surface.mesh;
  std::vector<std::uint32_t> triangles;
  std::vector<float> uvs(2 * mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(mesh.triangles[t][k]);
      triangles.push_back(static_cast<std::uint32_t>(v));
      if (mesh.texture_uvs.empty()) continue;
      uvs[2 * v] = mesh.texture_uvs[t][k].x();
      uvs[2 * v + 1] = mesh.texture_uvs[t][k].y();
    }
  Json frames = Json::array();
  Json displacements = Json::array();
  for (const MeshKey& key : surface.keys) {
    frames.push_back(key.frame_idx);
    displacements.push_back(Positions(key.positions, mesh.vertices));
  }
  Json gaps = Json::array();
  for (const MotionGap& gap : surface.gaps) gaps.push_back({gap.last_frame_idx, gap.next_frame_idx});
  Json errors = viewed.errors_mm.empty() ? Json() : Json::array();
  for (const std::vector<float>& error_mm : viewed.errors_mm)
    errors.push_back(PackQuantized(error_mm, 1, PackedType::kU16));
  return {{"submap", surface.submap},
          {"rest", Positions(mesh.vertices, {})},
          {"triangles", PackWhole(triangles, 3, PackedType::kU32)},
          {"uv", PackQuantized(uvs, 2, PackedType::kU16)},
          {"sigma", PackQuantized(mesh.sigmas, 1, PackedType::kU16)},
          {"texture", surface.texture_jpeg.empty() ? Json() : Json(Base64(surface.texture_jpeg))},
          {"frame", frames},
          {"gaps", gaps},
          {"displacement", displacements},
          {"error_mm", errors}};
}

Json RunData(const ViewedRun& run) {
  Json meshes = Json::array();
  for (const ViewedMesh& mesh : run.meshes) meshes.push_back(MeshData(mesh));
  return {{"name", run.name},
          {"unit", UnitOf(run.in_millimeters)},
          {"status", run.status},
          {"note", run.note},
          {"figures", Texts(run.figures, false)},
          {"options", Texts(run.options, true)},
          {"frames", Frames(run)},
          {"points", Points(run)},
          {"observations", Observations(run).ToJson()},
          {"meshes", meshes}};
}

Json CameraData(const std::optional<Camera>& camera) {
  if (!camera) return nullptr;
  Json corners = nullptr;
  if (const auto rays = CornerRays(*camera))
    for (const Eigen::Vector3d& ray : *rays) corners.push_back({ray.x(), ray.y(), ray.z()});
  return {{"width", camera->width()}, {"height", camera->height()}, {"corners", std::move(corners)}};
}

Json ImageData(const ViewImages& images) {
  if (images.jpeg.empty()) return nullptr;
  Json jpeg = Json::array();
  for (const std::string& bytes : images.jpeg) jpeg.push_back(Base64(bytes));
  return {{"width", images.width},
          {"height", images.height},
          {"scale", images.scale},
          {"frame", images.frame_idx},
          {"jpeg", std::move(jpeg)}};
}

Json TruthData(const std::vector<TruePose>& truth) {
  if (truth.empty()) return nullptr;
  Json frames = Json::array();
  std::vector<float> poses;
  for (const TruePose& pose : truth) {
    frames.push_back(pose.frame_idx);
    AppendPose(pose.world_from_cam, &poses);
  }
  return {{"frame", frames}, {"pose", PackFloats(poses, 7)}};
}

}  // namespace

Json PageData(const View& view, const ViewImages& images, const std::string& title) {
  Json runs = Json::array();
  for (const ViewedRun& run : view.runs) runs.push_back(RunData(run));
  return {{"format", kPageFormat},
          {"version", kVersion},
          {"title", title},
          {"live", false},
          {"unit", UnitOf(view.in_millimeters)},
          {"notes", view.notes},
          {"camera", CameraData(view.camera)},
          {"images", ImageData(images)},
          {"truth", TruthData(view.truth)},
          {"runs", std::move(runs)}};
}

std::string PageWith(const Json& data) {
  const std::string_view page = PageAsset();
  const std::size_t marker = page.find(kPageDataMarker);
  const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string whole(page.substr(0, marker + kPageDataMarker.size() - kPageDataEnd.size()));
  whole.reserve(page.size() + text.size());
  for (const char c : text) {  // nothing in it may end the element
    if (c == '<')
      whole += "\\u003c";
    else
      whole.push_back(c);
  }
  whole += page.substr(marker + kPageDataMarker.size() - kPageDataEnd.size());
  return whole;
}

}  // namespace pliant
