// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/mesh_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"
#include "pliant/image/brightness.h"
#include "pliant/surface/mesh_geometry.h"

namespace pliant {
namespace {

constexpr double kMinGain = 0.01;    // of an image: what it shows better, by what all images together can show
constexpr double kSwitchGain = 1.5;  // of a triangle, for which it leaves the image that it has
constexpr int kBorderPx = 2;         // around the used part of an image
constexpr int kSwatchPx = 4;         // side of the square of one color
constexpr int kNoView = -1;
constexpr int kMinBrightness = 8;  // gray levels: below, ratios are noise

using Corners = std::array<Eigen::Vector2d, 3>;

// The triangles of the mesh in an image.
struct SeenTriangles {
  std::vector<Corners> corners;  // px
  std::vector<double> score;     // 0: not seen, or not valid
};

bool IsValid(const TextureView& view, const Eigen::Vector2d& pixel) {
  const auto x = static_cast<int>(std::lround(pixel.x()));
  const auto y = static_cast<int>(std::lround(pixel.y()));
  if (x < 0 || y < 0 || x >= view.image.cols || y >= view.image.rows) return false;
  return view.valid.empty() || view.valid.at<std::uint8_t>(y, x) != 0;
}

SeenTriangles TrianglesIn(const Camera& camera, const TextureView& view, const Mesh& mesh) {
  std::vector<Eigen::Vector3d> in_cam;
  for (const Eigen::Vector3d& position : view.mesh.positions) in_cam.push_back(view.cam_from_world * position);
  const std::vector<std::optional<Eigen::Vector2d>> pixels = camera.Project(in_cam);
  SeenTriangles seen;
  for (const Triangle& triangle : mesh.triangles) {
    Corners corners;
    bool is_seen = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangle[k]);
      is_seen = is_seen && view.mesh.views[v] != VertexView::kOutOfView && pixels[v] && IsValid(view, *pixels[v]);
      if (is_seen) corners[k] = *pixels[v];
    }
    seen.corners.push_back(corners);
    seen.score.push_back(0.0);
    if (!is_seen || !IsValid(view, (corners[0] + corners[1] + corners[2]) / 3.0)) continue;
    const Eigen::Vector2d a = corners[1] - corners[0];
    const Eigen::Vector2d b = corners[2] - corners[0];
    // Facing the camera, triangles are counted against the y axis, which points down.
    seen.score.back() = std::max(0.0, -(a.x() * b.y() - a.y() * b.x())) * view.sharpness;
  }
  return seen;
}

// What an image would show better than `best`, summed over the triangles.
double GainOf(const SeenTriangles& seen, const std::vector<double>& best) {
  double gain = 0.0;
  for (std::size_t t = 0; t < best.size(); ++t) gain += std::max(0.0, seen.score[t] - best[t]);
  return gain;
}

// Positions of the images, those that show most first, until another one shows hardly anything better.
std::vector<std::size_t> ChooseViews(const std::vector<SeenTriangles>& seen, std::size_t triangles) {
  std::vector<double> best(triangles, 0.0);
  std::vector<std::size_t> chosen;
  double total = 0.0;
  while (chosen.size() < seen.size()) {
    std::vector<double> gains;
    for (const SeenTriangles& view : seen) gains.push_back(GainOf(view, best));
    const auto most = std::ranges::max_element(gains);
    if (!(*most > kMinGain * total)) break;
    total += *most;
    chosen.push_back(static_cast<std::size_t>(most - gains.begin()));
    for (std::size_t t = 0; t < triangles; ++t) best[t] = std::max(best[t], seen[chosen.back()].score[t]);
  }
  return chosen;
}

// Of every triangle, the position in `chosen`, or kNoView.
std::vector<int> AssignViews(const std::vector<SeenTriangles>& seen, const std::vector<std::size_t>& chosen,
                             std::size_t triangles) {
  std::vector<int> assigned(triangles, kNoView);
  std::vector<double> score(triangles, 0.0);
  for (std::size_t c = 0; c < chosen.size(); ++c)
    for (std::size_t t = 0; t < triangles; ++t) {
      const double here = seen[chosen[c]].score[t];
      if (!(here > kSwitchGain * score[t])) continue;
      assigned[t] = static_cast<int>(c);
      score[t] = here;
    }
  return assigned;
}

double BrightnessAt(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const auto [red, green, blue] = ColorAt(image, pixel);
  return (red + green + blue) / 3.0;
}

// Factors that make the images equally bright, in the median, where they show the same triangles.
std::vector<double> GainsOf(std::span<const TextureView> views, const std::vector<SeenTriangles>& seen,
                            const std::vector<std::size_t>& chosen) {
  std::vector<double> gains;
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    std::vector<double> logs;
    const SeenTriangles& here = seen[chosen[c]];
    for (std::size_t other = 0; other < c; ++other)
      for (std::size_t t = 0; t < here.score.size(); ++t) {
        if (!(here.score[t] > 0.0) || !(seen[chosen[other]].score[t] > 0.0)) continue;
        const double own = BrightnessAt(views[chosen[c]].image, here.corners[t][0]);
        const double wanted =
            gains[other] * BrightnessAt(views[chosen[other]].image, seen[chosen[other]].corners[t][0]);
        if (own > kMinBrightness && wanted > kMinBrightness) logs.push_back(std::log(wanted / own));
      }
    gains.push_back(logs.empty() ? 1.0 : std::exp(Median(std::move(logs))));
  }
  return gains;
}

// A rectangle of an image, and where it is in the texture.
struct Piece {
  cv::Rect of_image;
  cv::Point at;
};

cv::Rect UsedPart(const SeenTriangles& seen, const std::vector<int>& assigned, int view, cv::Size image) {
  Eigen::Vector2d least(image.width, image.height);
  Eigen::Vector2d largest(0.0, 0.0);
  for (std::size_t t = 0; t < assigned.size(); ++t) {
    if (assigned[t] != view) continue;
    for (const Eigen::Vector2d& corner : seen.corners[t]) {
      least = least.cwiseMin(corner);
      largest = largest.cwiseMax(corner);
    }
  }
  if (least.x() > largest.x()) return {};  // nothing is taken from it
  const cv::Point first(static_cast<int>(std::floor(least.x())) - kBorderPx,
                        static_cast<int>(std::floor(least.y())) - kBorderPx);
  const cv::Point last(static_cast<int>(std::ceil(largest.x())) + kBorderPx + 1,
                       static_cast<int>(std::ceil(largest.y())) + kBorderPx + 1);
  return cv::Rect(first, last) & cv::Rect({0, 0}, image);
}

// Lays the pieces side by side in rows, high ones first; returns the size of all.
cv::Size LayOut(std::vector<Piece>* pieces) {
  double area = 0.0;
  int width = 1;
  for (const Piece& piece : *pieces) {
    area += piece.of_image.area();
    width = std::max(width, piece.of_image.width);
  }
  width = std::max(width, static_cast<int>(std::ceil(std::sqrt(area))));
  std::vector<Piece*> by_height;
  for (Piece& piece : *pieces) by_height.push_back(&piece);
  std::ranges::stable_sort(by_height, std::greater<>(), [](const Piece* piece) { return piece->of_image.height; });
  cv::Point next(0, 0);
  int bottom = 0;
  for (Piece* piece : by_height) {
    if (next.x + piece->of_image.width > width) next = {0, bottom};
    piece->at = next;
    next.x += piece->of_image.width;
    bottom = std::max(bottom, next.y + piece->of_image.height);
  }
  return {width, std::max(1, bottom)};
}

cv::Mat InColor(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat color;
  cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
  return color;
}

cv::Scalar MeanColor(const Mesh& mesh, const Triangle& triangle) {
  cv::Scalar bgr(0, 0, 0);
  for (const std::int32_t v : triangle) {
    const auto& rgb = mesh.rgb[static_cast<std::size_t>(v)];
    for (int c = 0; c < 3; ++c) bgr[c] += rgb[static_cast<std::size_t>(2 - c)] / 3.0;
  }
  return bgr;
}

// Squares of one color for the triangles that no image shows: their number across.
int SwatchesAcross(const std::vector<int>& assigned) {
  const auto count = static_cast<double>(std::ranges::count(assigned, kNoView));
  return static_cast<int>(std::ceil(std::sqrt(count)));
}

}  // namespace

cv::Mat MakeTexture(const Camera& camera, std::span<const TextureView> views, int max_size, Mesh* mesh) {
  std::vector<SeenTriangles> seen;
  for (const TextureView& view : views) seen.push_back(TrianglesIn(camera, view, *mesh));
  const std::vector<std::size_t> chosen = ChooseViews(seen, mesh->triangles.size());
  const std::vector<int> assigned = AssignViews(seen, chosen, mesh->triangles.size());
  const std::vector<double> gains = GainsOf(views, seen, chosen);

  std::vector<Piece> pieces;
  for (std::size_t c = 0; c < chosen.size(); ++c)
    pieces.push_back({UsedPart(seen[chosen[c]], assigned, static_cast<int>(c), {camera.width(), camera.height()}), {}});
  const int across = SwatchesAcross(assigned);
  pieces.push_back({{0, 0, across * kSwatchPx, across * kSwatchPx}, {}});
  const cv::Size size = LayOut(&pieces);

  cv::Mat texture(size, CV_8UC3, cv::Scalar::all(0));
  for (std::size_t c = 0; c < chosen.size(); ++c) {
    if (pieces[c].of_image.empty()) continue;
    InColor(views[chosen[c]].image)(pieces[c].of_image)
        .convertTo(texture(cv::Rect(pieces[c].at, pieces[c].of_image.size())), CV_8U, gains[c]);
  }
  int swatch = 0;
  mesh->texture_uvs.assign(mesh->triangles.size(), {});
  for (std::size_t t = 0; t < assigned.size(); ++t) {
    Corners corners;
    if (assigned[t] == kNoView) {
      const cv::Rect square(pieces.back().at + kSwatchPx * cv::Point(swatch % across, swatch / across),
                            cv::Size(kSwatchPx, kSwatchPx));
      texture(square).setTo(MeanColor(*mesh, mesh->triangles[t]));
      corners.fill({square.x + kSwatchPx / 2.0 - 0.5, square.y + kSwatchPx / 2.0 - 0.5});
      ++swatch;
    } else {
      const auto c = static_cast<std::size_t>(assigned[t]);
      const cv::Point offset = pieces[c].at - pieces[c].of_image.tl();
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = seen[chosen[c]].corners[t][k] + Eigen::Vector2d(offset.x, offset.y);
    }
    for (std::size_t k = 0; k < 3; ++k)
      mesh->texture_uvs[t][k] = (corners[k].array() + 0.5).cast<float>() /
                                Eigen::Array2f(static_cast<float>(size.width), static_cast<float>(size.height));
  }
  const double shrink = static_cast<double>(max_size) / std::max(size.width, size.height);
  if (shrink < 1.0) cv::resize(texture, texture, {}, shrink, shrink, cv::INTER_AREA);
  return texture;
}

}  // namespace pliant
