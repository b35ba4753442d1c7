// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/sized_scene.h"

#include "pliant/base/parallel.h"

namespace pliant {
namespace {

// (V3) With the field of the motion, in the world, made into the view's own numbers.
MatchingView ViewOf(const Scene& scene, std::size_t v, const SizedCamera& camera, double smoothing_px) {
  const SurfaceView& other = *scene.others[v];
  const Rigid3 other_from_reference = other.cam_from_world * scene.reference.cam_from_world.Inverse();
  const Eigen::Matrix3f rotation = other_from_reference.RotationMatrix().cast<float>();
  const Eigen::Matrix3f from_world = other.cam_from_world.RotationMatrix().cast<float>();
  const Eigen::Vector3f translation = other_from_reference.translation.cast<float>();
  const double step = static_cast<double>(scene.grid_width) / camera.size().width;
  MatchingView view{MakeMatchingImage(other.image, other.valid, camera.size(), smoothing_px),
                    cv::Mat(camera.size(), CV_32FC3), scene.motions[v].field.ToImage(camera.size(), step),
                    cv::Vec3f(translation.x(), translation.y(), translation.z())};
  for (int y = 0; y < camera.size().height; ++y) {
    const auto* ray = camera.rays.ptr<float>(y);
    auto* at_infinity = view.at_infinity.ptr<float>(y);
    auto* motion = view.by_inverse_distance.ptr<float>(y);
    for (int x = 0; x < camera.size().width; ++x, ray += 3, at_infinity += 3, motion += 3) {
      Eigen::Map<Eigen::Vector3f> direction(at_infinity);
      direction = rotation * Eigen::Map<const Eigen::Vector3f>(ray);
      Eigen::Map<Eigen::Vector3f> moved(motion);
      moved = (from_world * moved + translation).eval();
    }
  }
  return view;
}

}  // namespace

SizedCamera::SizedCamera(const Camera& c) : camera(c), rays(c.height(), c.width(), CV_32FC3, cv::Scalar::all(0)) {
  for (int y = 0; y < camera.height(); ++y)
    for (int x = 0; x < camera.width(); ++x)
      if (const auto ray = camera.Unproject({x, y}))
        rays.at<cv::Vec3f>(y, x) = {static_cast<float>(ray->x()), static_cast<float>(ray->y()),
                                    static_cast<float>(ray->z())};
}

SizedScene::SizedScene(const Scene& scene, const SizedCamera& sized, const Comparison& how, int threads)
    : camera(sized),
      reference(MakeReferenceWindows(
          MakeMatchingImage(scene.reference.image, scene.reference.valid, sized.size(), how.smoothing_px),
          how.window_px, how.noise_variance)),
      views(scene.others.size()) {
  ParallelFor(
      static_cast<int>(views.size()), threads,
      [&](int v) {
        const auto at = static_cast<std::size_t>(v);
        views[at] = ViewOf(scene, at, sized, how.smoothing_px);
      },
      1);
}

}  // namespace pliant
