// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/tracked_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/image/brightness.h"
#include "pliant/surface/mesh_geometry.h"
#include "pliant/surface/placed_mesh.h"
#include "surface/depth_holes.h"
#include "surface/mesh_seam.h"
#include "surface/rest_motion.h"

namespace pliant {
namespace {

constexpr double kMinKnown = 0.5;  // of the pixels around a node
constexpr int kMinPiece = 20;      // triangles of a connected piece
constexpr std::int32_t kNoVertex = -1;
constexpr std::int32_t kInside = -2;  // the mesh is there, and does not end

// Whether the distances of a triangle's corners are those of one surface.
bool IsOneSurface(std::span<const Eigen::Vector3d> in_cam, const Triangle& triangle, double largest_step) {
  const auto distance = [&](std::size_t k) { return in_cam[static_cast<std::size_t>(triangle[k])].norm(); };
  const auto [least, largest] = std::minmax({distance(0), distance(1), distance(2)});
  return largest - least <= largest_step * least;
}

struct Votes {
  // Of a vertex's position along the rays: the sums of inverse variances, and of inverse standard deviations.
  double weight = 0;
  double root_weight = 0;
  int confirmed = 1;
  int contradicted = 0;

  void Add(double sigma) {
    weight += 1.0 / (sigma * sigma);
    root_weight += 1.0 / sigma;
  }
  // Of the weighted mean of depths that are all wrong alike, since they rest on the same points.
  float Sigma() const { return static_cast<float>(root_weight / weight); }
  bool IsGood() const { return contradicted <= confirmed; }
};

// A depth of a frame, and its standard deviation.
struct Measured {
  double depth = 0;  // 0: none
  double sigma = 0;  // of the distance, relative

  // Of the distance of a point, together with that of its motion.
  double SigmaOf(const Eigen::Vector3d& in_cam, double motion_error) const {
    return std::hypot(sigma * in_cam.norm(), motion_error);
  }
};

// What the pixels around say, where half of them know it: the median.
Measured MeasuredAround(const DenseDepth& dense, const Eigen::Vector2d& pixel, double step_px) {
  if (dense.depth.empty()) return {};
  const auto first = [&](double center) { return std::max(0, static_cast<int>(std::ceil(center - 0.5 * step_px))); };
  const auto last = [&](double center, int size) {
    return std::min(size - 1, static_cast<int>(std::ceil(center + 0.5 * step_px)) - 1);
  };
  std::vector<double> depths;
  std::vector<double> sigmas;
  int pixels = 0;
  for (int y = first(pixel.y()); y <= last(pixel.y(), dense.depth.rows); ++y)
    for (int x = first(pixel.x()); x <= last(pixel.x(), dense.depth.cols); ++x) {
      ++pixels;
      if (!(dense.depth.at<float>(y, x) > 0.0F) || !(dense.sigma.at<float>(y, x) > 0.0F)) continue;
      depths.push_back(dense.depth.at<float>(y, x));
      sigmas.push_back(dense.sigma.at<float>(y, x));
    }
  if (depths.empty() || static_cast<double>(depths.size()) < kMinKnown * pixels) return {};
  // One of the depths: at a contour the mean of two is that of no surface.
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::ranges::nth_element(depths, middle);
  return {*middle, Median(std::move(sigmas))};
}

// Whether a vertex belongs to a piece of at least `least` triangles.
std::vector<bool> InLargePieces(const Mesh& mesh, int least) {
  std::vector<std::size_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root_of = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& triangle : mesh.triangles)
    for (const std::int32_t v : triangle)
      parent[root_of(static_cast<std::size_t>(v))] = root_of(static_cast<std::size_t>(triangle[0]));
  std::vector<int> triangles(mesh.vertices.size(), 0);
  for (const Triangle& triangle : mesh.triangles) ++triangles[root_of(static_cast<std::size_t>(triangle[0]))];
  std::vector<bool> in_large;
  for (std::size_t v = 0; v < parent.size(); ++v) in_large.push_back(triangles[root_of(v)] >= least);
  return in_large;
}

// Vertices that were bad when triangles were added beside them, and are good again, may have two sheets of triangles:
// the later ones go.
void DropSecondSheets(std::vector<Triangle>* triangles) {
  DirectedEdges edges;
  std::erase_if(*triangles, [&](const Triangle& triangle) {
    if (edges.ContainsAnyOf(triangle)) return true;
    edges.Add(triangle);
    return false;
  });
}

// The vertices that a frame has at the nodes of its grid.
struct Grid {
  std::vector<std::int32_t> vertex;  // row by row; kNoVertex: no surface there, or one that is hidden; kInside
  std::vector<Measured> measured;
};

}  // namespace

struct TrackedMesh::State {
  Camera camera;
  RestPositions rest;
  int threads = 1;
  cv::Size nodes = {};
  double step_px = 1;
  Mesh mesh = {};
  std::vector<Votes> votes = {};

  std::vector<Eigen::Vector3d> Moved(const RestMotion& motion) const;
  PlacedMesh Place(const Rigid3& cam_from_world, std::span<const Eigen::Vector3d> positions) const;
  void Confirm(const SurfaceView& view, const DenseDepth& dense, const PlacedMesh& placed, double motion_error);
  std::int32_t VertexAt(const PlacedMesh& placed, const MeshSeam& seam, int column, int row, const Measured& measured,
                        double motion_error) const;
  Grid Compare(const DenseDepth& dense, const PlacedMesh& placed, const MeshSeam& seam, double motion_error) const;
  void AddVertices(const SurfaceView& view, const RestMotion& motion, Grid* grid, PlacedMesh* placed);
  void AddTriangles(const Grid& grid, const PlacedMesh& placed, MeshSeam* seam);

  // What is wrong, as far as is known, hides nothing.
  std::vector<bool> GoodVertices() const {
    std::vector<bool> good;
    for (const Votes& vote : votes) good.push_back(vote.IsGood());
    return good;
  }
  double LargestStep() const { return step_px * LargestStepOfASurface(camera.MeanFocalLengthPx()); }

  Eigen::Vector2d PixelOf(int column, int row) const { return {column * step_px, row * step_px}; }
  std::size_t NodeIndex(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(nodes.width) + static_cast<std::size_t>(column);
  }
};

// The vertices, world frame.
std::vector<Eigen::Vector3d> TrackedMesh::State::Moved(const RestMotion& motion) const {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) positions.push_back(vertex.cast<double>());
  const std::vector<Eigen::Vector3d> displacements = motion.Displacements(positions, threads);
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] += displacements[v];
  return positions;
}

PlacedMesh TrackedMesh::State::Place(const Rigid3& cam_from_world, std::span<const Eigen::Vector3d> positions) const {
  std::vector<Eigen::Vector3d> in_cam;
  for (const Eigen::Vector3d& position : positions) in_cam.push_back(cam_from_world * position);
  return PlaceMesh(camera, std::move(in_cam), mesh.triangles, GoodVertices(), step_px);
}

// (V11) Depths of vertices that are there already.
void TrackedMesh::State::Confirm(const SurfaceView& view, const DenseDepth& dense, const PlacedMesh& placed,
                                 double motion_error) {
  const Eigen::Matrix3d world_from_cam = view.cam_from_world.RotationMatrix().transpose();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!placed.IsInImage(camera, v)) continue;
    const Measured measured = MeasuredAround(dense, *placed.pixels[v], step_px);
    if (!(measured.depth > 0.0)) continue;
    const double own = measured.SigmaOf(placed.in_cam[v], motion_error);
    const double tolerance = DepthTolerance(placed.in_cam[v], own, mesh.sigmas[v]);
    const double difference = measured.depth - placed.depths[v];
    if (difference > tolerance) ++votes[v].contradicted;
    if (std::abs(difference) > tolerance || placed.IsHidden(mesh.triangles, v, tolerance)) continue;
    ++votes[v].confirmed;
    votes[v].Add(own);
    const Eigen::Vector3d along = placed.in_cam[v] * (difference / placed.depths[v]);
    mesh.vertices[v] += (world_from_cam * along / (own * own * votes[v].weight)).cast<float>();
    mesh.sigmas[v] = votes[v].Sigma();
  }
}

// The vertex of the mesh's border that a node's depth belongs to, nearest in the image; kNoVertex: it shows a surface
// that is not there yet.
std::int32_t TrackedMesh::State::VertexAt(const PlacedMesh& placed, const MeshSeam& seam, int column, int row,
                                          const Measured& measured, double motion_error) const {
  const auto tolerance_at = [&](std::int32_t v) {
    const Eigen::Vector3d& in_cam = placed.in_cam[static_cast<std::size_t>(v)];
    return DepthTolerance(in_cam, measured.SigmaOf(in_cam, motion_error), mesh.sigmas[static_cast<std::size_t>(v)]);
  };
  const auto distance_px = [&](std::int32_t v) {
    return (*placed.pixels[static_cast<std::size_t>(v)] - PixelOf(column, row)).norm();
  };
  const std::int32_t t = placed.raster.triangle.at<std::int32_t>(row, column);
  const bool is_covered = t != kNoTriangle;
  if (is_covered) {
    const std::int32_t nearest = std::ranges::min(mesh.triangles[static_cast<std::size_t>(t)], {}, distance_px);
    if (placed.raster.depth.at<float>(row, column) - measured.depth > tolerance_at(nearest)) return kNoVertex;
  }
  std::int32_t vertex = is_covered ? kInside : kNoVertex;
  double least = 0.0;
  for (const std::int32_t v : seam.BorderAround(column, row, is_covered ? 1 : 0)) {
    if (std::abs(placed.depths[static_cast<std::size_t>(v)] - measured.depth) >
        std::max(tolerance_at(v), LargestStep() * measured.depth))
      continue;
    if (vertex >= 0 && distance_px(v) >= least) continue;
    vertex = v;
    least = distance_px(v);
  }
  return vertex;
}

Grid TrackedMesh::State::Compare(const DenseDepth& dense, const PlacedMesh& placed, const MeshSeam& seam,
                                 double motion_error) const {
  Grid grid;
  for (int row = 0; row < nodes.height; ++row)
    for (int column = 0; column < nodes.width; ++column) {
      const Measured measured = MeasuredAround(dense, PixelOf(column, row), step_px);
      const std::int32_t vertex =
          measured.depth > 0.0 ? VertexAt(placed, seam, column, row, measured, motion_error) : kNoVertex;
      grid.vertex.push_back(vertex);
      grid.measured.push_back(measured);
    }
  return grid;
}

void TrackedMesh::State::AddVertices(const SurfaceView& view, const RestMotion& motion, Grid* grid,
                                     PlacedMesh* placed) {
  const Rigid3 world_from_cam = view.cam_from_world.Inverse();
  std::vector<Eigen::Vector3d> positions;
  for (int row = 0; row < nodes.height; ++row)
    for (int column = 0; column < nodes.width; ++column) {
      const std::size_t node = NodeIndex(column, row);
      const Measured& measured = grid->measured[node];
      if (!(measured.depth > 0.0) || grid->vertex[node] != kNoVertex) continue;
      const Eigen::Vector2d pixel = PixelOf(column, row);
      const auto ray = camera.Unproject(pixel);
      if (!ray) continue;
      const Eigen::Vector3d in_cam = *ray * (measured.depth / ray->z());
      grid->vertex[node] = static_cast<std::int32_t>(placed->in_cam.size());
      placed->in_cam.push_back(in_cam);
      placed->pixels.emplace_back(pixel);
      placed->depths.push_back(measured.depth);
      positions.push_back(world_from_cam * in_cam);
      mesh.rgb.push_back(ColorAt(view.image, pixel));
      const double sigma = measured.SigmaOf(in_cam, motion.error());
      mesh.sigmas.push_back(static_cast<float>(sigma));
      votes.emplace_back();
      votes.back().Add(sigma);
    }
  for (const Eigen::Vector3d& position : motion.Undeformed(positions, threads))
    mesh.vertices.push_back(position.cast<float>());
}

void TrackedMesh::State::AddTriangles(const Grid& grid, const PlacedMesh& placed, MeshSeam* seam) {
  const auto add = [&](std::array<std::size_t, 3> corners) {
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = grid.vertex[corners[k]];
      if (triangle[k] < 0) return;
    }
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return;
    if (IsOneSurface(placed.in_cam, triangle, LargestStep()) && seam->Take(triangle, placed))
      mesh.triangles.push_back(triangle);
  };
  for (int row = 0; row + 1 < nodes.height; ++row)
    for (int column = 0; column + 1 < nodes.width; ++column) {
      const std::size_t here = NodeIndex(column, row);
      const std::size_t below = NodeIndex(column, row + 1);
      add({here, below, here + 1});
      add({below, below + 1, here + 1});
    }
}

TrackedMesh::TrackedMesh(const Camera& camera, RestPositions rest, int columns, int threads)
    : state_(std::make_unique<State>(State{.camera = camera, .rest = std::move(rest), .threads = threads})) {
  state_->step_px = std::max(1.0, static_cast<double>(camera.width()) / columns);
  state_->nodes = {static_cast<int>(std::floor((camera.width() - 1) / state_->step_px)) + 1,
                   static_cast<int>(std::floor((camera.height() - 1) / state_->step_px)) + 1};
}

TrackedMesh::TrackedMesh(TrackedMesh&&) noexcept = default;
TrackedMesh& TrackedMesh::operator=(TrackedMesh&&) noexcept = default;
TrackedMesh::~TrackedMesh() = default;

void TrackedMesh::Add(const SurfaceView& view, const DenseDepth& dense) {
  const auto motion = RestMotion::Create(state_->rest, view.observations);
  if (!motion) return;
  PlacedMesh placed = state_->Place(view.cam_from_world, state_->Moved(*motion));
  state_->Confirm(view, dense, placed, motion->error());
  MeshSeam seam(placed, state_->mesh.triangles, state_->GoodVertices(), state_->LargestStep());
  Grid grid = state_->Compare(dense, placed, seam, motion->error());
  state_->AddVertices(view, *motion, &grid, &placed);
  state_->AddTriangles(grid, placed, &seam);
}

void TrackedMesh::Finish() {
  state_->mesh = PartOfMesh(state_->mesh, state_->GoodVertices());
  DropSecondSheets(&state_->mesh.triangles);
  state_->mesh = PartOfMesh(state_->mesh, InLargePieces(state_->mesh, kMinPiece));
  state_->votes.clear();
  state_->mesh.normals = VertexNormals(state_->mesh.vertices, state_->mesh.triangles);
}

const Mesh& TrackedMesh::undeformed() const { return state_->mesh; }

std::optional<MeshInFrame> TrackedMesh::InFrame(const SurfaceView& view, const DenseDepth& dense) const {
  const auto motion = RestMotion::Create(state_->rest, view.observations);
  if (!motion) return std::nullopt;
  MeshInFrame result;
  result.positions = state_->Moved(*motion);
  const PlacedMesh placed = state_->Place(view.cam_from_world, result.positions);
  for (std::size_t v = 0; v < result.positions.size(); ++v) {
    const double own = std::hypot(state_->mesh.sigmas[v], motion->error());
    result.sigmas.push_back(static_cast<float>(own));
    result.views.push_back(VertexView::kOutOfView);
    if (!placed.IsInImage(state_->camera, v)) continue;
    const Measured measured = MeasuredAround(dense, *placed.pixels[v], state_->step_px);
    const double tolerance = DepthTolerance(placed.in_cam[v], measured.SigmaOf(placed.in_cam[v], 0.0), own);
    if (placed.IsHidden(state_->mesh.triangles, v, tolerance)) continue;
    const bool has_depth = measured.depth > 0.0;
    if (has_depth && std::abs(measured.depth - placed.depths[v]) > tolerance) continue;
    result.views.back() = has_depth ? VertexView::kMeasured : VertexView::kInView;
  }
  return result;
}

}  // namespace pliant
