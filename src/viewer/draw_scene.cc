// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/draw_scene.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "viewer/frame_geometry.h"
#include "viewer/view_lookup.h"

namespace pliant {
namespace {

constexpr double kOnMesh = 0.6;  // of the radius of a point that is drawn over a mesh, whose colors are to be seen

class SceneDrawing {
 public:
  // `mesh`: what may hide points; null: nothing.
  SceneDrawing(cairo_t* drawing, const Panel& panel, const Orbit& orbit, const MeshPicture* mesh)
      : drawing_(drawing), panel_(panel), orbit_(orbit), mesh_(mesh) {}

  void Path(const std::vector<Eigen::Vector3d>& points) {
    bool begun = false;
    for (const Eigen::Vector3d& point : points) begun = Go(point, begun ? cairo_line_to : cairo_move_to);
    cairo_stroke(drawing_);
  }

  void Points(const std::vector<Eigen::Vector3d>& points, double radius) {
    Circles(points, radius);
    cairo_fill(drawing_);
  }

  void Rings(const std::vector<Eigen::Vector3d>& points, double radius) {
    Circles(points, radius);
    cairo_stroke(drawing_);
  }

 private:
  void Circles(const std::vector<Eigen::Vector3d>& points, double radius) {
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d seen = orbit_.Project(point);
      if (seen.z() > 0 && !(mesh_ != nullptr && mesh_->Hides(seen)))
        Dot(drawing_, panel_.left + seen.x(), panel_.top + seen.y(), radius);
    }
  }

  // False: behind the eye, or the mesh.
  bool Go(const Eigen::Vector3d& point, void (*go)(cairo_t*, double, double)) {
    const Eigen::Vector3d seen = orbit_.Project(point);
    if (!(seen.z() > 0) || (mesh_ != nullptr && mesh_->Hides(seen))) return false;
    go(drawing_, panel_.left + seen.x(), panel_.top + seen.y());
    return true;
  }

  cairo_t* drawing_;
  const Panel& panel_;
  const Orbit& orbit_;
  const MeshPicture* mesh_;
};

// The present frame's points, each from its undeformed position through the last frames to where it is.
std::map<PointId, std::vector<Eigen::Vector3d>> Trails(const ViewedRun& run, std::size_t now, int trail_frames) {
  std::map<PointId, std::vector<Eigen::Vector3d>> trails;
  for (const ViewedObservation& o : run.frames[now].observations) trails[o.id] = {run.points.at(o.id).position};
  const std::size_t length = static_cast<std::size_t>(trail_frames);
  for (std::size_t i = now > length ? now - length : 0; i <= now; ++i)
    for (const ViewedObservation& o : run.frames[i].observations)
      if (const auto trail = trails.find(o.id); trail != trails.end())
        trail->second.push_back(o.position.cast<double>());
  return trails;
}

// Where points are in any frame, and the true surface there.
void AddObserved(const ViewedRun& run, std::vector<Eigen::Vector3d>* points) {
  constexpr std::size_t kEnough = 20000;
  std::size_t count = 0;
  for (const ViewedFrame& frame : run.frames) count += frame.observations.size();
  const std::size_t step = 1 + count / kEnough;
  std::size_t position = 0;
  for (const ViewedFrame& frame : run.frames)
    for (const ViewedObservation& o : frame.observations) {
      if (position++ % step != 0) continue;
      points->push_back(o.position.cast<double>());
      if (o.truth.allFinite()) points->push_back(o.truth.cast<double>());
    }
}

// Where vertices are in any frame.
void AddVertices(const std::vector<ViewedMesh>& meshes, std::vector<Eigen::Vector3d>* points) {
  constexpr std::size_t kEnough = 20000;
  std::size_t count = 0;
  for (const ViewedMesh& mesh : meshes)
    count += mesh.surface.mesh.vertices.size() * std::max<std::size_t>(1, mesh.surface.keys.size());
  const std::size_t step = 1 + count / kEnough;
  std::size_t index = 0;
  const auto add = [&](const std::vector<Eigen::Vector3f>& positions) {
    for (const Eigen::Vector3f& position : positions)
      if (index++ % step == 0) points->push_back(position.cast<double>());
  };
  for (const ViewedMesh& mesh : meshes) {
    if (mesh.surface.keys.empty()) add(mesh.surface.mesh.vertices);
    for (const MeshKey& key : mesh.surface.keys) add(key.positions);
  }
}

void DrawMesh(cairo_t* drawing, const Panel& panel, const MeshPicture& mesh) {
  const CairoSurface surface = ImageSurface(mesh.bgra);
  cairo_save(drawing);
  cairo_translate(drawing, panel.left, panel.top);
  cairo_scale(drawing, 1 / mesh.scale, 1 / mesh.scale);
  cairo_set_source_surface(drawing, surface.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(drawing), CAIRO_FILTER_GOOD);
  cairo_paint(drawing);
  cairo_restore(drawing);
}

void DrawMap(cairo_t* drawing, const ViewedRun& run, double radius, SceneDrawing* scene) {
  std::vector<Eigen::Vector3d> map;
  for (const auto& [id, point] : run.points) map.push_back(point.position);
  Use(drawing, kBlack);
  scene->Points(map, 0.5 * radius);
}

// Trails over the truth: they are short, and would vanish under it.
void DrawFramePoints(cairo_t* drawing, const ViewedRun& run, const ViewedFrame& frame, double radius, int trail_frames,
                     SceneDrawing* scene) {
  std::vector<Eigen::Vector3d> now;
  std::vector<Eigen::Vector3d> truth;
  for (const ViewedObservation& o : frame.observations) {
    now.emplace_back(o.position.cast<double>());
    if (o.truth.allFinite()) truth.emplace_back(o.truth.cast<double>());
  }
  Use(drawing, kGreen);
  cairo_set_line_width(drawing, 0.35 * radius);
  scene->Rings(truth, radius);
  Use(drawing, kVermillion);
  cairo_set_line_width(drawing, 1.2 * radius);
  cairo_set_line_cap(drawing, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(drawing, CAIRO_LINE_JOIN_ROUND);
  for (const auto& [id, trail] : Trails(run, static_cast<std::size_t>(&frame - run.frames.data()), trail_frames))
    scene->Path(trail);
  scene->Points(now, 0.8 * radius);
  cairo_set_line_cap(drawing, CAIRO_LINE_CAP_BUTT);
  cairo_set_line_join(drawing, CAIRO_LINE_JOIN_MITER);
}

void DrawTruePath(cairo_t* drawing, const View& view, int frame_idx, double radius, SceneDrawing* scene) {
  std::vector<Eigen::Vector3d> path;
  for (const TruePose& pose : view.truth)
    if (pose.frame_idx <= frame_idx) path.push_back(pose.world_from_cam.translation);
  const std::array<double, 2> dashes = {4 * radius, 3 * radius};
  cairo_set_line_width(drawing, 0.6 * radius);
  cairo_set_dash(drawing, dashes.data(), dashes.size(), 0);
  Use(drawing, kGreen);
  scene->Path(path);
  cairo_set_dash(drawing, nullptr, 0, 0);
}

// The camera's path up to a frame, broken where the camera was lost.
void DrawPath(const ViewedRun& run, int frame_idx, SceneDrawing* scene) {
  std::vector<Eigen::Vector3d> path;
  for (const ViewedFrame& f : run.frames) {
    if (f.row.frame_idx > frame_idx) break;
    if (f.world_from_cam)
      path.push_back(f.world_from_cam->translation);
    else
      scene->Path(std::exchange(path, {}));
  }
  scene->Path(path);
}

void DrawFrustum(const Rigid3& world_from_cam, const std::array<Eigen::Vector3d, 4>& corners, SceneDrawing* scene) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    scene->Path(
        {world_from_cam.translation, world_from_cam * corners[i], world_from_cam * corners[(i + 1) % corners.size()]});
}

// Why there is no pose to draw, if there is none; else empty.
std::string WhyNoPose(const ViewedRun& run, int frame_idx) {
  const auto has_pose = [](const ViewedFrame& frame) { return frame.world_from_cam.has_value(); };
  if (std::ranges::none_of(run.frames, has_pose)) {
    const std::string status = run.status.empty() ? "" : " (" + run.status + ")";
    return "This run has no map" + status + (run.note.empty() ? "." : ": " + run.note);
  }
  const ViewedFrame* frame = FindFrame(run, frame_idx);
  if (frame == nullptr) return "This run has no frame " + std::to_string(frame_idx) + ".";
  if (has_pose(*frame)) return {};
  std::string state(EnumName(frame->row.state));
  std::ranges::replace(state, '_', ' ');
  return "No pose in this frame: " + state + (frame->note.empty() ? "" : ", " + frame->note);
}

}  // namespace

Viewpoint ViewpointOf(const View& view, const ViewedRun& run, const FigureOptions& options, double width_px,
                      double height_px) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> cameras;  // centers, and corners of their images
  const auto frustum = FrustumOf(run);
  if (run.meshes.empty()) {
    for (const auto& [id, point] : run.points) points.push_back(point.position);
    AddObserved(run, &points);
  }
  AddVertices(run.meshes, &points);
  Eigen::Vector4d orientation = Eigen::Vector4d::Zero();
  for (const ViewedFrame& frame : run.frames) {
    if (!frame.world_from_cam) continue;
    cameras.push_back(frame.world_from_cam->translation);
    if (frustum)
      for (const Eigen::Vector3d& corner : *frustum) cameras.push_back(*frame.world_from_cam * corner);
    const Eigen::Vector4d q = frame.world_from_cam->rotation.coeffs();
    orientation += q.dot(orientation) < 0 ? Eigen::Vector4d(-q) : q;
  }
  for (const TruePose& pose : view.truth) cameras.push_back(pose.world_from_cam.translation);
  if (points.empty()) points.emplace_back(0, 0, 0);
  const Eigen::Quaterniond mean =
      orientation.norm() > 0 ? Eigen::Quaterniond(orientation.normalized()) : Eigen::Quaterniond::Identity();
  return {Orbit(points, cameras, mean, options.azimuth_deg, options.elevation_deg, width_px, height_px), frustum};
}

SceneDrawer::SceneDrawer(const View& view, const FigureOptions& options, double width_px, double height_px)
    : view_(view), options_(options), meshes_(view, options.surface_color) {
  for (const ViewedRun& run : view.runs) viewpoints_.push_back(ViewpointOf(view, run, options, width_px, height_px));
}

void SceneDrawer::Draw(cairo_t* drawing, const Panel& panel, std::size_t run_index, int frame_idx) const {
  const ViewedRun& run = view_.runs[run_index];
  const Viewpoint& viewpoint = viewpoints_[run_index];
  cairo_save(drawing);
  Clip(drawing, panel);
  const auto mesh = meshes_.Paint(run_index, frame_idx, viewpoint.orbit, panel);
  if (mesh) DrawMesh(drawing, panel, *mesh);
  SceneDrawing scene(drawing, panel, viewpoint.orbit, mesh ? &*mesh : nullptr);
  const double radius = kDot * panel.width;
  const ViewedFrame* frame = FindFrame(run, frame_idx);
  if (!mesh) DrawMap(drawing, run, radius, &scene);
  if (frame != nullptr)
    DrawFramePoints(drawing, run, *frame, mesh ? kOnMesh * radius : radius, options_.trail_frames, &scene);
  DrawTruePath(drawing, view_, frame_idx, radius, &scene);
  Use(drawing, kBlue);
  cairo_set_line_width(drawing, radius);
  DrawPath(run, frame_idx, &scene);
  if (frame != nullptr && frame->world_from_cam && viewpoint.frustum)
    DrawFrustum(*frame->world_from_cam, *viewpoint.frustum, &scene);
  cairo_restore(drawing);
  std::string missing = WhyNoPose(run, frame_idx);
  if (!mesh && !run.meshes.empty()) missing = "No surface in this frame." + (missing.empty() ? "" : " " + missing);
  DrawParagraph(drawing, panel, missing);
  Use(drawing, kGray);
  cairo_set_line_width(drawing, 1);
  cairo_rectangle(drawing, panel.left, panel.top, panel.width, panel.height);
  cairo_stroke(drawing);
}

LegendContent SceneDrawer::Legend(const std::set<int>& frames_idx) const {
  bool any_map = false;
  for (std::size_t i = 0; i < view_.runs.size(); ++i)
    any_map = any_map || !std::ranges::all_of(frames_idx, [&](int frame_idx) { return meshes_.Has(i, frame_idx); });
  return {.map = any_map,
          .truth = HasTruth(view_),
          .unknown = meshes_.scale() && options_.surface_color == SurfaceColor::kError,
          .scale = meshes_.scale()};
}

}  // namespace pliant
