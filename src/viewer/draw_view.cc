// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/draw_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "viewer/frame_geometry.h"
#include "viewer/view_images.h"

namespace pliant {
namespace {

// Okabe and Ito's colors, which the color-blind tell apart.
struct Color {
  double red;
  double green;
  double blue;
};
constexpr Color kBlack = {0, 0, 0};
constexpr Color kGray = {0.75, 0.75, 0.75};
constexpr Color kBlue = {0, 0.447, 0.698};
constexpr Color kVermillion = {0.835, 0.369, 0};
constexpr Color kGreen = {0, 0.62, 0.451};
constexpr Color kYellow = {0.941, 0.894, 0.259};
constexpr Color kSkyBlue = {0.337, 0.706, 0.914};
constexpr Color kPurple = {0.8, 0.475, 0.655};
constexpr Color kWhite = {1, 1, 1};
// Of the runs' points in the image, in turn.
constexpr std::array<Color, 4> kRunColors = {kYellow, kSkyBlue, kPurple, kWhite};

constexpr int kEmbeddedQuality = 90;
constexpr double kDot = 1.0 / 300;  // radius of a point, of the panel's width
constexpr double kSwatch = 1.2;     // width of a color in the legend, of the letters' size

void Use(cairo_t* drawing, const Color& color) { cairo_set_source_rgb(drawing, color.red, color.green, color.blue); }

void Dot(cairo_t* drawing, double x, double y, double radius) {
  cairo_new_sub_path(drawing);
  cairo_arc(drawing, x, y, radius, 0, 2 * std::numbers::pi);
}

void Clip(cairo_t* drawing, const Panel& panel) {
  cairo_rectangle(drawing, panel.left, panel.top, panel.width, panel.height);
  cairo_clip(drawing);
}

Surface ImageSurface(const cv::Mat& image) {
  cv::Mat bgra;
  cv::cvtColor(image, bgra, image.channels() == 1 ? cv::COLOR_GRAY2BGRA : cv::COLOR_BGR2BGRA);
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, bgra.cols, bgra.rows));
  const int stride = cairo_image_surface_get_stride(surface.get());
  unsigned char* pixels = cairo_image_surface_get_data(surface.get());
  cairo_surface_flush(surface.get());
  for (int y = 0; y < bgra.rows; ++y)
    std::copy_n(bgra.ptr(y), static_cast<std::size_t>(4 * bgra.cols), pixels + static_cast<std::ptrdiff_t>(y) * stride);
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

// Which SVG and PDF take instead of the pixels.
void AttachJpeg(const cv::Mat& image, cairo_surface_t* surface) {
  auto* jpeg = new std::string(ToJpeg(image, kEmbeddedQuality));
  cairo_surface_set_mime_data(
      surface, CAIRO_MIME_TYPE_JPEG, reinterpret_cast<const unsigned char*>(jpeg->data()), jpeg->size(),
      [](void* text) { delete static_cast<std::string*>(text); }, jpeg);
}

void UseFont(cairo_t* drawing, double size) {
  cairo_select_font_face(drawing, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(drawing, size);
}

double WidthOf(cairo_t* drawing, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(drawing, text.c_str(), &extents);
  return extents.x_advance;
}

// Cut at its end, which then says so, until it is no wider than this.
std::string Fitting(cairo_t* drawing, std::string text, double width) {
  if (WidthOf(drawing, text) <= width) return text;
  const std::string ellipsis = "\u2026";
  while (!text.empty() && WidthOf(drawing, text + ellipsis) > width) {
    const auto continues = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; };
    while (continues(text.back()) && text.size() > 1) text.pop_back();
    text.pop_back();
  }
  return text + ellipsis;
}

class SceneDrawing {
 public:
  SceneDrawing(cairo_t* drawing, const Panel& panel, const Orbit& orbit)
      : drawing_(drawing), panel_(panel), orbit_(orbit) {}

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
      if (seen.z() > 0) Dot(drawing_, panel_.left + seen.x(), panel_.top + seen.y(), radius);
    }
  }

  // False: behind the eye.
  bool Go(const Eigen::Vector3d& point, void (*go)(cairo_t*, double, double)) {
    const Eigen::Vector3d seen = orbit_.Project(point);
    if (!(seen.z() > 0)) return false;
    go(drawing_, panel_.left + seen.x(), panel_.top + seen.y());
    return true;
  }

  cairo_t* drawing_;
  const Panel& panel_;
  const Orbit& orbit_;
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

}  // namespace

double AspectOf(const View& view) {
  constexpr double kUsual = 0.75;
  return view.camera ? static_cast<double>(view.camera->height()) / view.camera->width() : kUsual;
}

bool HasTruth(const View& view) {
  const auto known = [](const ViewedObservation& o) { return o.truth.allFinite(); };
  const auto any = [&](const ViewedFrame& frame) { return std::ranges::any_of(frame.observations, known); };
  return !view.truth.empty() ||
         std::ranges::any_of(view.runs, [&](const ViewedRun& run) { return std::ranges::any_of(run.frames, any); });
}

Status TooLarge(double width_px, double height_px) {
  return {ErrorCode::kInvalidArgument, "a picture of " + std::to_string(std::lround(width_px)) + " x " +
                                           std::to_string(std::lround(height_px)) +
                                           " pixels is too large; give fewer frames or a smaller "
                                           "--Figure.panel_width_px"};
}

const ViewedFrame* FindFrame(const ViewedRun& run, int frame_idx) {
  const auto frame = std::lower_bound(run.frames.begin(), run.frames.end(), frame_idx,
                                      [](const ViewedFrame& f, int wanted) { return f.row.frame_idx < wanted; });
  return frame != run.frames.end() && frame->row.frame_idx == frame_idx ? &*frame : nullptr;
}

Viewpoint ViewpointOf(const View& view, const ViewedRun& run, const FigureOptions& options, double width_px,
                      double height_px) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> cameras;  // centers, and corners of their images
  const auto frustum = FrustumOf(run);
  for (const auto& [id, point] : run.points) points.push_back(point.position);
  AddObserved(run, &points);
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

namespace {

const Color& ColorOfRun(std::size_t run) { return kRunColors[run % kRunColors.size()]; }

// In pixels of the image. Of several runs the first one's points are the smallest, and above the others: runs often
// have points at the same pixels.
void DrawImagePoints(cairo_t* drawing, const View& view, int frame_idx, double radius) {
  for (std::size_t i = view.runs.size(); i-- > 0;) {
    const ViewedFrame* frame = FindFrame(view.runs[i], frame_idx);
    if (frame == nullptr) continue;
    const double size = radius * (1 + static_cast<double>(i));
    for (const ViewedObservation& o : frame->observations) Dot(drawing, o.pixel.x() + 0.5, o.pixel.y() + 0.5, size);
    Use(drawing, ColorOfRun(i));
    cairo_fill_preserve(drawing);
    Use(drawing, kBlack);
    cairo_set_line_width(drawing, 0.35 * radius);
    cairo_stroke(drawing);
  }
}

}  // namespace

void DrawImage(cairo_t* drawing, const Panel& panel, const cv::Mat& image, const View& view, int frame_idx) {
  if (image.empty()) return;
  cairo_save(drawing);
  Clip(drawing, panel);
  const double scale = std::min(panel.width / image.cols, panel.height / image.rows);
  const Surface surface = ImageSurface(image);
  if (cairo_surface_get_type(cairo_get_target(drawing)) != CAIRO_SURFACE_TYPE_IMAGE) AttachJpeg(image, surface.get());
  cairo_translate(drawing, panel.left, panel.top);
  cairo_scale(drawing, scale, scale);
  cairo_set_source_surface(drawing, surface.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(drawing), CAIRO_FILTER_GOOD);
  cairo_paint(drawing);
  DrawImagePoints(drawing, view, frame_idx, 1.2 * kDot * panel.width / scale);
  cairo_restore(drawing);
}

namespace {

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

void DrawScene(cairo_t* drawing, const Panel& panel, const View& view, const ViewedRun& run, int frame_idx,
               const Viewpoint& viewpoint, const FigureOptions& options) {
  cairo_save(drawing);
  Clip(drawing, panel);
  SceneDrawing scene(drawing, panel, viewpoint.orbit);
  const double radius = kDot * panel.width;
  const ViewedFrame* frame = FindFrame(run, frame_idx);
  DrawMap(drawing, run, radius, &scene);
  if (frame != nullptr) DrawFramePoints(drawing, run, *frame, radius, options.trail_frames, &scene);
  DrawTruePath(drawing, view, frame_idx, radius, &scene);
  Use(drawing, kBlue);
  cairo_set_line_width(drawing, radius);
  DrawPath(run, frame_idx, &scene);
  if (frame != nullptr && frame->world_from_cam && viewpoint.frustum)
    DrawFrustum(*frame->world_from_cam, *viewpoint.frustum, &scene);
  cairo_restore(drawing);
  DrawParagraph(drawing, panel, WhyNoPose(run, frame_idx));
  Use(drawing, kGray);
  cairo_set_line_width(drawing, 1);
  cairo_rectangle(drawing, panel.left, panel.top, panel.width, panel.height);
  cairo_stroke(drawing);
}

namespace {

struct LegendEntry {
  Color color;
  const char* text;
  double left = 0;
  int line = 0;
};

// Each beside the one before it, or on the next line where that is full.
std::vector<LegendEntry> LayOutLegend(cairo_t* drawing, double width, bool truth) {
  std::vector<LegendEntry> entries = {{kBlack, "undeformed map"}, {kVermillion, "deformation"}, {kBlue, "camera"}};
  if (truth) entries.push_back({kGreen, "truth"});
  UseFont(drawing, kText);
  double left = 0;
  int line = 0;
  for (LegendEntry& entry : entries) {
    const double taken = kSwatch * kText + WidthOf(drawing, entry.text);
    if (left > 0 && left + taken > width) {
      left = 0;
      ++line;
    }
    entry.left = left;
    entry.line = line;
    left += taken + 1.5 * kText;
  }
  return entries;
}

}  // namespace

void DrawParagraph(cairo_t* drawing, const Panel& panel, const std::string& text) {
  constexpr double kInset = 12;
  const double width = panel.width - 2 * kInset;
  UseFont(drawing, kText);
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || WidthOf(drawing, lines.back() + " " + word) > width)
      lines.push_back(word);
    else
      lines.back() += " " + word;
  }
  const auto room = static_cast<std::size_t>(std::max(1.0, std::floor((panel.height - kInset) / kLine)));
  for (std::size_t i = 0; i < std::min(room, lines.size()); ++i) {
    const bool is_cut = i + 1 == room && lines.size() > room;
    DrawText(drawing, panel.left + kInset, panel.top + kLine * static_cast<double>(i + 1), width,
             is_cut ? lines[i] + "\u2026" : lines[i]);
  }
}

void DrawText(cairo_t* drawing, double left, double baseline, double width, const std::string& text) {
  UseFont(drawing, kText);
  Use(drawing, kBlack);
  cairo_move_to(drawing, left, baseline);
  cairo_show_text(drawing, Fitting(drawing, text, width).c_str());
}

void DrawRunName(cairo_t* drawing, double left, double baseline, double width, const View& view, std::size_t run) {
  double name_left = left;
  if (view.sequence) {
    Dot(drawing, left + 0.4 * kText, baseline - 0.35 * kText, 0.35 * kText);
    Use(drawing, ColorOfRun(run));
    cairo_fill_preserve(drawing);
    Use(drawing, kBlack);
    cairo_set_line_width(drawing, 1);
    cairo_stroke(drawing);
    name_left += kSwatch * kText;
  }
  DrawText(drawing, name_left, baseline, left + width - name_left, view.runs[run].name);
}

double LegendHeight(double width, bool truth) {
  const Surface scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const Drawing drawing(cairo_create(scratch.get()));
  return kLine * (1 + LayOutLegend(drawing.get(), width, truth).back().line);
}

void DrawLegend(cairo_t* drawing, double left, double top, double width, bool truth) {
  for (const LegendEntry& entry : LayOutLegend(drawing, width, truth)) {
    const double baseline = top + kLine * (entry.line + 1) - 8;
    Use(drawing, entry.color);
    Dot(drawing, left + entry.left + 0.4 * kText, baseline - 0.35 * kText, 0.35 * kText);
    cairo_fill(drawing);
    DrawText(drawing, left + entry.left + kSwatch * kText, baseline, width, entry.text);
  }
}

}  // namespace pliant
