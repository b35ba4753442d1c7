// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/view_images.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include <Eigen/Core>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/image/pyramid.h"
#include "viewer/frame_images.h"

namespace pliant {
namespace {

constexpr int kPatchSide = 11;
constexpr double kMinContrast = 1.0;  // standard deviation in gray levels, below which a patch says nothing of gain

using Patch = Eigen::Matrix<float, kPatchSide * kPatchSide, 1>;

std::optional<Patch> PatchAt(const cv::Mat& gray, const Eigen::Vector2f& pixel) {
  Patch patch;
  int i = 0;
  for (int dy = -kPatchSide / 2; dy <= kPatchSide / 2; ++dy) {
    for (int dx = -kPatchSide / 2; dx <= kPatchSide / 2; ++dx) {
      const auto value = SampleBilinear(gray, pixel.x() + dx, pixel.y() + dy);
      if (!value) return std::nullopt;
      patch[i++] = static_cast<float>(*value);
    }
  }
  return patch;
}

// Each point's first patch, of one run.
using FirstPatches = std::unordered_map<PointId, Patch>;

void AddBrightness(const cv::Mat& gray, FirstPatches* first, ViewedFrame* frame) {
  for (ViewedObservation& o : frame->observations) {
    const std::optional<Patch> patch = PatchAt(gray, o.pixel);
    if (!patch) continue;
    const Patch& reference = first->emplace(o.id, *patch).first->second;
    const Patch from_mean = reference.array() - reference.mean();
    if (from_mean.squaredNorm() < kMinContrast * kMinContrast * kPatchSide * kPatchSide) continue;
    o.gain = from_mean.dot(*patch) / from_mean.squaredNorm();
    o.bias = patch->mean() - o.gain * reference.mean();
  }
}

double Megabytes(const ViewImages& images) {
  double bytes = 0;
  for (const std::string& jpeg : images.jpeg) bytes += static_cast<double>(jpeg.size());
  return bytes * 4 / 3 / 1e6;  // in base64
}

void LeaveOutEverySecond(ViewImages* images) {
  ViewImages kept{images->width, images->height, images->scale, {}, {}};
  for (std::size_t i = 0; i < images->jpeg.size(); i += 2) {
    kept.frame_idx.push_back(images->frame_idx[i]);
    kept.jpeg.push_back(std::move(images->jpeg[i]));
  }
  *images = std::move(kept);
}

}  // namespace

cv::Mat Shrink(const cv::Mat& image, int width_px) {
  if (image.cols <= width_px) return image;
  const double scale = static_cast<double>(width_px) / image.cols;
  cv::Mat small;
  cv::resize(image, small, cv::Size(width_px, std::max(1, static_cast<int>(std::lround(scale * image.rows)))), 0, 0,
             cv::INTER_AREA);
  return small;
}

std::string ToJpeg(const cv::Mat& image, int quality) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

Result<ViewImages> ReadViewImages(const ReportOptions& options, const JobProgress& progress, View* view) {
  std::set<int> wanted;
  for (const ViewedRun& run : view->runs)
    for (const ViewedFrame& frame : run.frames) wanted.insert(frame.row.frame_idx);
  ViewImages images;
  if (wanted.empty()) return images;
  auto source = FrameImages::Open(*view, *wanted.begin());
  if (!source.ok()) return source.status();
  std::vector<FirstPatches> first(view->runs.size());
  std::vector<std::size_t> position(view->runs.size(), 0);
  int done = 0;
  for (const int frame_idx : wanted) {
    if (Status status = Tell(progress, "images", done++, static_cast<int>(wanted.size())); !status.ok()) return status;
    const auto image = source->At(frame_idx);
    if (!image.ok()) {
      view->notes.push_back("later images are not shown: " + image.status().message());
      break;
    }
    if (image->empty()) continue;
    const cv::Mat small = Shrink(*image, options.image_width_px);
    images.width = small.cols;
    images.height = small.rows;
    images.scale = static_cast<double>(small.cols) / image->cols;
    images.frame_idx.push_back(frame_idx);
    images.jpeg.push_back(ToJpeg(small, options.image_quality));
    const cv::Mat gray = ToGray(*image);
    for (std::size_t i = 0; i < view->runs.size(); ++i) {
      std::vector<ViewedFrame>& frames = view->runs[i].frames;
      while (position[i] < frames.size() && frames[position[i]].row.frame_idx < frame_idx) ++position[i];
      if (position[i] < frames.size() && frames[position[i]].row.frame_idx == frame_idx)
        AddBrightness(gray, &first[i], &frames[position[i]]);
    }
  }
  const std::size_t read = images.jpeg.size();
  while (images.jpeg.size() > 1 && Megabytes(images) > options.max_image_mb) LeaveOutEverySecond(&images);
  if (images.jpeg.size() < read)
    view->notes.push_back(std::to_string(images.jpeg.size()) + " of " + std::to_string(read) +
                          " images are in the report (--Report.max_image_mb); the others show the one before");
  return images;
}

}  // namespace pliant
