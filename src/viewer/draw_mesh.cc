// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/draw_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "image/image_size.h"
#include "pliant/base/text.h"
#include "pliant/surface/mesh_raster.h"
#include "viewer/color_maps.h"
#include "viewer/view_lookup.h"

namespace pliant {
namespace {

constexpr double kPictureScale = 2;    // pixels of a mesh's picture by those of its panel: it is printed, too
constexpr int kTextureLevels = 3;      // of which the next has half the size; more would mix the pieces of a texture
constexpr double kBehind = 0.02;       // of the distance from the eye: what is nearer to the mesh is on it
constexpr float kAmbientLight = 0.5F;  // of all light; the other part depends on the slant
constexpr float kOpaque = 255;

// The mesh where it is, from the eye.
struct SeenMesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::optional<Eigen::Vector2d>> pixels;  // of the picture
  std::vector<double> depths;
};

SeenMesh SeeMesh(std::vector<Eigen::Vector3f> positions, std::span<const Triangle> seamless, const Orbit& orbit) {
  SeenMesh seen;
  seen.positions = std::move(positions);
  seen.normals = VertexNormals(seen.positions, seamless);
  for (const Eigen::Vector3f& position : seen.positions) {
    const Eigen::Vector3d at = orbit.Project(position.cast<double>());
    seen.depths.push_back(at.z());
    seen.pixels.push_back(
        at.z() > 0.0 ? std::optional(Eigen::Vector2d(kPictureScale * at.x() - 0.5, kPictureScale * at.y() - 0.5))
                     : std::nullopt);
  }
  return seen;
}

// How much each corner of a triangle counts at a pixel, in perspective.
Eigen::Vector3f WeightsAt(const SeenMesh& seen, const Triangle& triangle, const Eigen::Vector2d& pixel) {
  const auto at = [&](std::size_t k) -> Eigen::Vector2d {
    return *seen.pixels[static_cast<std::size_t>(triangle[k])] - pixel;
  };
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
  Eigen::Vector3d weights(cross(at(1), at(2)), cross(at(2), at(0)), cross(at(0), at(1)));
  for (int k = 0; k < 3; ++k)
    weights[k] /= seen.depths[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
  return (weights / weights.sum()).cast<float>();
}

template <class Value>
Value Mean(const std::vector<Value>& values, const Triangle& triangle, const Eigen::Vector3f& weights) {
  Value sum = weights[0] * values[static_cast<std::size_t>(triangle[0])];
  for (int k = 1; k < 3; ++k)
    sum += weights[k] * values[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
  return sum;
}

// Of a mesh the triangles whose front is towards the eye: the side from which the camera has seen them. Of a tube the
// near wall would hide all that is in it.
class LitMesh {
 public:
  // `triangles` without seams; `size` of the picture.
  LitMesh(const SeenMesh& seen, const std::vector<Triangle>& triangles, const Eigen::Vector3d& eye, cv::Size size)
      : seen_(seen), triangles_(triangles), eye_(eye.cast<float>()) {
    std::vector<Triangle> front;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto at = [&](std::size_t k) { return seen.positions[static_cast<std::size_t>(triangles[t][k])]; };
      const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
      if (!(normal.dot(eye_ - at(0)) > 0.0F)) continue;
      front_.push_back(t);
      front.push_back(triangles[t]);
    }
    raster_ = RasterizeMesh(seen.pixels, seen.depths, front, size, 1.0);
  }

  // `color_at(triangle, weights of its corners)`: BGR.
  template <class ColorAtPixel>
  MeshPicture Picture(const ColorAtPixel& color_at) const {
    MeshPicture picture{cv::Mat(raster_.depth.size(), CV_8UC4, cv::Scalar::all(0)), raster_.depth, kPictureScale};
    for (int y = 0; y < picture.bgra.rows; ++y)
      for (int x = 0; x < picture.bgra.cols; ++x) {
        const std::int32_t index = raster_.triangle.at<std::int32_t>(y, x);
        if (index == kNoTriangle) continue;
        const std::size_t t = front_[static_cast<std::size_t>(index)];
        const Eigen::Vector3f weights = WeightsAt(seen_, triangles_[t], {x, y});
        const cv::Vec3f bgr = Brightness(t, weights) * color_at(t, weights);
        picture.bgra.at<cv::Vec4b>(y, x) = cv::Vec4f(bgr[0], bgr[1], bgr[2], kOpaque);
      }
    return picture;
  }

 private:
  float Brightness(std::size_t t, const Eigen::Vector3f& weights) const {
    const Eigen::Vector3f normal = Mean(seen_.normals, triangles_[t], weights).normalized();
    const Eigen::Vector3f to_eye = (eye_ - Mean(seen_.positions, triangles_[t], weights)).normalized();
    return kAmbientLight + (1.0F - kAmbientLight) * std::max(0.0F, normal.dot(to_eye));
  }

  const SeenMesh& seen_;
  const std::vector<Triangle>& triangles_;
  Eigen::Vector3f eye_;
  std::vector<std::size_t> front_;
  MeshRaster raster_;
};

cv::Vec3f InTexture(const std::vector<cv::Mat>& levels, const Eigen::Vector2f& uv, std::size_t level) {
  const cv::Mat& texture = levels[level];
  const float x =
      std::clamp(uv.x() * static_cast<float>(texture.cols) - 0.5F, 0.0F, static_cast<float>(texture.cols - 1));
  const float y =
      std::clamp(uv.y() * static_cast<float>(texture.rows) - 0.5F, 0.0F, static_cast<float>(texture.rows - 1));
  const int left = std::min(static_cast<int>(x), std::max(0, texture.cols - 2));
  const int top = std::min(static_cast<int>(y), std::max(0, texture.rows - 2));
  const int right = std::min(left + 1, texture.cols - 1);
  const int bottom = std::min(top + 1, texture.rows - 1);
  const float to_right = x - static_cast<float>(left);
  const float down = y - static_cast<float>(top);
  const auto at = [&](int row, int column) { return cv::Vec3f(texture.at<cv::Vec3b>(row, column)); };
  const cv::Vec3f upper = (1.0F - to_right) * at(top, left) + to_right * at(top, right);
  const cv::Vec3f lower = (1.0F - to_right) * at(bottom, left) + to_right * at(bottom, right);
  return (1.0F - down) * upper + down * lower;
}

double TwiceTheArea(const std::array<Eigen::Vector2d, 3>& corners) {
  const Eigen::Vector2d a = corners[1] - corners[0];
  const Eigen::Vector2d b = corners[2] - corners[0];
  return std::abs(a.x() * b.y() - a.y() * b.x());
}

// Colors of a picture's pixels from the texture.
class TextureColors {
 public:
  TextureColors(const Mesh& mesh, const std::vector<cv::Mat>& levels, const SeenMesh& seen)
      : mesh_(mesh), levels_(levels), seen_(seen) {}

  cv::Vec3f At(std::size_t t, const Eigen::Vector3f& weights) const {
    if (levels_.empty() || mesh_.texture_uvs.empty()) return kNoTexture;
    const auto& uvs = mesh_.texture_uvs[t];
    return InTexture(levels_, weights[0] * uvs[0] + weights[1] * uvs[1] + weights[2] * uvs[2], LevelOf(t));
  }

 private:
  inline static const cv::Vec3f kNoTexture = {200, 200, 200};

  // At which the texture's pixels are as large as the picture's, or somewhat smaller.
  std::size_t LevelOf(std::size_t t) const {
    std::array<Eigen::Vector2d, 3> in_texture;
    std::array<Eigen::Vector2d, 3> in_picture;
    for (std::size_t k = 0; k < 3; ++k) {
      in_texture[k] = mesh_.texture_uvs[t][k].cast<double>().cwiseProduct(
          Eigen::Vector2d(levels_.front().cols, levels_.front().rows));
      in_picture[k] = *seen_.pixels[static_cast<std::size_t>(mesh_.triangles[t][k])];
    }
    const double ratio = TwiceTheArea(in_texture) / std::max(1e-9, TwiceTheArea(in_picture));
    const double level = std::floor(0.5 * std::log2(std::max(1.0, ratio)));
    return std::min(static_cast<std::size_t>(level), levels_.size() - 1);
  }

  const Mesh& mesh_;
  const std::vector<cv::Mat>& levels_;
  const SeenMesh& seen_;
};

std::vector<cv::Mat> TextureLevels(const std::string& jpeg) {
  std::vector<cv::Mat> levels;
  const auto size = ImageSizeOf(std::span(reinterpret_cast<const unsigned char*>(jpeg.data()), jpeg.size()));
  if (!size || !CheckPixels(*size, "the texture").ok()) return levels;  // as without one
  levels.push_back(
      cv::imdecode(cv::Mat(1, static_cast<int>(jpeg.size()), CV_8U, const_cast<char*>(jpeg.data())), cv::IMREAD_COLOR));
  if (levels.front().empty()) return {};
  while (levels.size() < kTextureLevels && std::min(levels.back().cols, levels.back().rows) > 1) {
    cv::Mat half;
    cv::resize(levels.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    levels.push_back(half);
  }
  return levels;
}

ColorScale ScaleOf(SurfaceColor color, const ValueRange& range, bool in_millimeters) {
  const bool is_change = color == SurfaceColor::kAreaChange;
  const std::string unit = is_change ? "%" : in_millimeters || color == SurfaceColor::kError ? "mm" : "map units";
  std::string title(EnumName(color));
  std::ranges::replace(title, '_', ' ');
  const double factor = is_change ? 100 : 1;
  return {title + ", " + unit, FormatNumber("%.3g", factor * range.low), FormatNumber("%.3g", factor * range.high),
          is_change ? ColorMap::kDiverging : ColorMap::kViridis};
}

}  // namespace

bool MeshPicture::Hides(const Eigen::Vector3d& seen) const {
  const cv::Point at(static_cast<int>(std::lround(scale * seen.x() - 0.5)),
                     static_cast<int>(std::lround(scale * seen.y() - 0.5)));
  if (!cv::Rect(0, 0, depth.cols, depth.rows).contains(at)) return false;
  const float mesh = depth.at<float>(at);
  return mesh > 0.0F && mesh < (1 - kBehind) * seen.z();
}

Status CheckSurfaceColor(const View& view, SurfaceColor color) {
  if (color == SurfaceColor::kImage) return Status::Ok();
  bool any = false;
  bool any_error = false;
  for (const ViewedRun& run : view.runs)
    for (const ViewedMesh& mesh : run.meshes) {
      any = true;
      any_error = any_error || !mesh.errors_mm.empty();
    }
  if (!any)
    return {ErrorCode::kInvalidArgument, "--Figure.surface_color is '" + std::string(EnumName(color)) +
                                             "', but there is no surface; name the folder of one with --surface"};
  if (color == SurfaceColor::kError && !any_error)
    return {
        ErrorCode::kInsufficient,
        "the surface cannot be colored by its error: the true surface is not known in any frame of its mesh; name a "
        "sequence with depth images or pairs with --sequence"};
  return Status::Ok();
}

MeshPainter::MeshPainter(const View& view, SurfaceColor color) : view_(view), color_(color) {
  bool any = false;
  for (const ViewedRun& run : view.runs) {
    std::vector<Prepared>& meshes = prepared_.emplace_back();
    for (const ViewedMesh& mesh : run.meshes) {
      any = true;
      meshes.push_back(
          {color == SurfaceColor::kImage ? TextureLevels(mesh.surface.texture_jpeg) : std::vector<cv::Mat>(),
           SeamlessTriangles(mesh.surface.mesh)});
    }
  }
  if (!any || color == SurfaceColor::kImage) return;
  range_ = RangeOfMeshes(view, color);
  scale_ = ScaleOf(color, range_, view.in_millimeters);
}

const ViewedMesh* MeshPainter::Find(std::size_t run_index, int frame_idx) const {
  const ViewedRun& run = view_.runs[run_index];
  const ViewedFrame* frame = FindFrame(run, frame_idx);
  if (frame == nullptr || !frame->world_from_cam) return nullptr;
  const auto mesh = std::ranges::find_if(run.meshes, [&](const ViewedMesh& candidate) {
    return candidate.surface.submap == frame->row.submap && IsKnownIn(candidate.surface, frame_idx);
  });
  return mesh == run.meshes.end() ? nullptr : &*mesh;
}

std::optional<MeshPicture> MeshPainter::Paint(std::size_t run_index, int frame_idx, const Orbit& orbit,
                                              const Panel& panel) const {
  const ViewedMesh* mesh = Find(run_index, frame_idx);
  if (mesh == nullptr) return std::nullopt;
  const Prepared& prepared = prepared_[run_index][static_cast<std::size_t>(mesh - view_.runs[run_index].meshes.data())];
  const std::vector<Triangle>& seamless = prepared.seamless;
  const SeenMesh seen = SeeMesh(PositionsAt(mesh->surface, frame_idx), seamless, orbit);
  const cv::Size size(static_cast<int>(std::lround(kPictureScale * panel.width)),
                      static_cast<int>(std::lround(kPictureScale * panel.height)));
  const LitMesh lit(seen, seamless, orbit.Eye(), size);
  if (color_ == SurfaceColor::kImage) {
    const TextureColors texture(mesh->surface.mesh, prepared.texture, seen);
    return lit.Picture([&](std::size_t t, const Eigen::Vector3f& weights) { return texture.At(t, weights); });
  }
  const std::vector<float> values = MeshValues(*mesh, color_, frame_idx, seen.positions, seamless);
  return lit.Picture([&](std::size_t t, const Eigen::Vector3f& weights) {
    const auto [red, green, blue] =
        ColorAt(scale_->map, (Mean(values, seamless[t], weights) - range_.low) / (range_.high - range_.low));
    return cv::Vec3f(blue, green, red);
  });
}

}  // namespace pliant
