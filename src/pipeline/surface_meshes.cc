// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/surface_meshes.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pipeline/mesh_writer.h"
#include "pliant/image/sharpness.h"
#include "pliant/io/gltf.h"
#include "pliant/surface/mesh_geometry.h"
#include "pliant/surface/mesh_texture.h"
#include "pliant/surface/tracked_mesh.h"

namespace pliant {
namespace {

constexpr std::size_t kTextureViews = 16;  // images from which a texture is chosen: the sharpest of as many parts
constexpr int kMaxTextureSize = 4096;      // px, which every graphics card can do
constexpr int kTextureQuality = 92;        // of its JPEG file

// A frame with a depth.
struct DenseFrame {
  std::size_t position = 0;  // in MeshSource::frames
  SurfaceFolder::Frame file;
};

// The frames of a submap with a depth, in the order of time.
std::vector<std::vector<DenseFrame>> DenseFramesBySubmap(const MeshSource& source) {
  std::map<int, std::vector<DenseFrame>> submaps;
  for (const SurfaceFolder::Frame& file : source.folder.frames) {
    const auto frame = std::ranges::find(source.frames, file.frame_idx, &PosedFrame::frame_idx);
    if (frame == source.frames.end()) continue;
    const auto position = static_cast<std::size_t>(frame - source.frames.begin());
    submaps[frame->submap].push_back({position, file});
  }
  std::vector<std::vector<DenseFrame>> result;
  for (auto& [submap, frames] : submaps) {
    std::ranges::sort(frames, {}, &DenseFrame::position);
    result.push_back(std::move(frames));
  }
  return result;
}

// What was measured in it.
Result<DenseDepth> ReadDense(const SurfaceFolder& folder, const SurfaceFolder::Frame& file) {
  auto read = ReadSurfaceDepth(folder, file);
  if (!read.ok()) return read.status();
  read->KeepMeasured();
  return DenseDepth{std::move(read->depth), std::move(read->sigma)};
}

// An image from which a texture may be taken.
struct SharpImage {
  DenseFrame frame;
  cv::Mat image;
  cv::Mat valid;
  double sharpness = 0;
};

// The sharpest image of each of kTextureViews parts of the frames.
class SharpImages {
 public:
  explicit SharpImages(std::size_t frames) : frames_(frames) {}

  // The `k`-th of the frames.
  void Add(std::size_t k, const DenseFrame& frame, const SurfaceView& view) {
    cv::Mat gray = view.image;
    if (gray.channels() == 3) cv::cvtColor(view.image, gray, cv::COLOR_BGR2GRAY);
    const double sharpness = Sharpness(gray, view.valid);
    const std::size_t part = k * std::min(frames_, kTextureViews) / frames_;
    if (part == images_.size()) images_.emplace_back();
    if (images_[part].image.empty() || sharpness > images_[part].sharpness)
      images_[part] = {frame, view.image, view.valid, sharpness};
  }

  const std::vector<SharpImage>& images() const { return images_; }

 private:
  std::size_t frames_;
  std::vector<SharpImage> images_;
};

class MeshMaker {
 public:
  MeshMaker(const MeshSource& source, const SurfaceRunOptions& options, int threads,
            const std::vector<DenseFrame>& frames, const std::function<bool()>& go_on)
      : source_(source),
        options_(options),
        frames_(frames),
        go_on_(go_on),
        tracked_(source.folder.camera, RestPositionsOf(source, source.frames[frames.front().position].submap),
                 options.mesh_columns, threads),
        images_(frames.size()) {}

  Status Make(MeshWriter* writer) {
    if (Status status = Build(); !status.ok() || stopped_) return status;
    mesh_ = tracked_.undeformed();
    if (mesh_.triangles.empty()) return Status::Ok();
    if (options_.gltf || options_.obj)
      if (Status status = MakeTextureOfImages(); !status.ok()) return status;
    if (Status status = writer->WriteUndeformed(mesh_, texture_jpeg_); !status.ok()) return status;
    if (Status status = WriteFrames(writer); !status.ok() || stopped_ || !options_.gltf) return status;
    return WriteGlb(
        writer->FileName("surface", ".glb").string(),
        {mesh_, texture_jpeg_, keys_, CameraPath(), source_.folder.camera, PosedOf(frames_.front()).submap, gaps_});
  }

  bool stopped() const { return stopped_; }
  bool has_mesh() const { return !mesh_.triangles.empty(); }

 private:
  // Points that the run's map does not have, as that of a killed run, rest where they were seen first.
  static RestPositions RestPositionsOf(const MeshSource& source, int submap) {
    RestPositions rest;
    for (const auto& [id, point] : source.known.points) rest[id] = point.position;
    for (const PosedFrame& frame : source.frames)
      if (frame.submap == submap)
        for (const PointObservation& observation : frame.observations)
          rest.try_emplace(observation.id, observation.position);
    return rest;
  }

  Status Build() {
    auto sequence = OpenSequence(source_.images);
    if (!sequence.ok()) return sequence.status();
    RunViews views(*std::move(sequence), source_.frames, source_.known, options_.masks);
    for (std::size_t k = 0; k < frames_.size() && !stopped_; ++k) {
      const std::size_t position = frames_[k].position;
      if (Status status = views.ReadUntil(position, [&](std::size_t other) { return other == position; }); !status.ok())
        return status;
      const auto dense = ReadDense(source_.folder, frames_[k].file);
      if (!dense.ok()) return dense.status();
      tracked_.Add(views.At(position), *dense);
      images_.Add(k, frames_[k], views.At(position));
      views.ForgetUnless([](std::size_t) { return false; });
      stopped_ = !go_on_();
    }
    tracked_.Finish();
    return Status::Ok();
  }

  const PosedFrame& PosedOf(const DenseFrame& frame) const { return source_.frames[frame.position]; }

  std::optional<MeshInFrame> InFrame(const PosedFrame& frame, const DenseDepth& dense) const {
    return tracked_.InFrame({{}, {}, frame.cam_from_world, frame.observations}, dense);
  }

  Status MakeTextureOfImages() {
    std::vector<TextureView> views;
    for (const SharpImage& sharp : images_.images()) {
      const auto dense = ReadDense(source_.folder, sharp.frame.file);
      if (!dense.ok()) return dense.status();
      const PosedFrame& frame = PosedOf(sharp.frame);
      auto in_frame = InFrame(frame, *dense);
      if (!in_frame) continue;
      views.push_back({sharp.image, sharp.valid, frame.cam_from_world, *std::move(in_frame), sharp.sharpness});
    }
    std::vector<unsigned char> jpeg;
    cv::imencode(".jpg", MakeTexture(source_.folder.camera, views, kMaxTextureSize, &mesh_), jpeg,
                 {cv::IMWRITE_JPEG_QUALITY, kTextureQuality});
    texture_jpeg_.assign(jpeg.begin(), jpeg.end());
    return Status::Ok();
  }

  Status WriteFrames(MeshWriter* writer) {
    for (std::size_t k = 0; k < frames_.size() && !stopped_; ++k) {
      const auto dense = ReadDense(source_.folder, frames_[k].file);
      if (!dense.ok()) return dense.status();
      const PosedFrame& frame = PosedOf(frames_[k]);
      const auto now = InFrame(frame, *dense);
      if (!now) continue;
      const DeformedMesh deformed{mesh_, *now, frame.cam_from_world, frame.timestamp_s};
      if (Status status = writer->WriteFrame(std::filesystem::path(frames_[k].file.file_name).stem(), deformed);
          !status.ok())
        return status;
      KeepKey(k, {frame.frame_idx, frame.timestamp_s, deformed.Vertices()});
      stopped_ = !go_on_() && k + 1 < frames_.size();
    }
    return writer->Finish();
  }

  // Of frames as even in time as the `k`-th is among all, and of both ends of gaps, as far as these are not too many.
  void KeepKey(std::size_t k, MeshKey key) {
    const std::size_t most = std::min<std::size_t>(frames_.size(), static_cast<std::size_t>(options_.animation_keys));
    const bool is_even = even_keys_ < most && k * (most - 1) >= even_keys_ * (frames_.size() - 1);
    if (is_even) ++even_keys_;
    const auto gap = last_ ? GapBetween(*last_, key) : std::nullopt;
    if (gap) gaps_.push_back(*gap);
    const bool is_end = gap && keys_.size() + 2 <= 2 * most;
    if (is_end && keys_.back().frame_idx != last_->frame_idx) keys_.push_back(*last_);
    if (is_even || is_end) keys_.push_back(key);
    last_ = std::move(key);
  }

  // Of two frames of which no one in between has a mesh: whether one was to have it.
  std::optional<MotionGap> GapBetween(const MeshKey& last, const MeshKey& next) const {
    MotionGap gap{last.frame_idx, next.frame_idx, last.time_s, last.time_s, next.time_s};
    bool is_gap = false;
    for (auto row = std::ranges::upper_bound(source_.read, last.frame_idx, {}, &RunFrame::frame_idx);
         row != source_.read.end() && row->frame_idx < next.frame_idx; ++row) {
      is_gap = is_gap || source_.chosen.empty() || source_.chosen.contains(row->frame_idx);
      gap.held_until_s = row->timestamp_s;
    }
    return is_gap ? std::optional(gap) : std::nullopt;
  }

  std::vector<CameraKey> CameraPath() const {
    std::vector<CameraKey> path;
    for (const DenseFrame& frame : frames_) {
      const PosedFrame& posed = PosedOf(frame);
      path.push_back({posed.timestamp_s, posed.cam_from_world.Inverse()});
    }
    return path;
  }

  const MeshSource& source_;
  const SurfaceRunOptions& options_;
  const std::vector<DenseFrame>& frames_;
  const std::function<bool()>& go_on_;
  bool stopped_ = false;
  TrackedMesh tracked_;
  SharpImages images_;
  Mesh mesh_;  // undeformed
  std::string texture_jpeg_;
  std::vector<MeshKey> keys_;
  std::size_t even_keys_ = 0;
  std::optional<MeshKey> last_;  // frame with a mesh
  std::vector<MotionGap> gaps_;
};

}  // namespace

Result<MadeMeshes> MakeMeshes(const MeshSource& source, const SurfaceRunOptions& options, int threads,
                              const MeshProgress& go_on) {
  const auto submaps = DenseFramesBySubmap(source);
  MadeMeshes made;
  made.submaps = static_cast<int>(submaps.size());
  int total = 0;
  for (const auto& frames : submaps) total += 2 * static_cast<int>(frames.size());
  made.stopped = !go_on(0, total);
  int done = 0;
  const std::function<bool()> step = [&] { return go_on(++done, total); };
  for (std::size_t k = 0; k < submaps.size() && !made.stopped; ++k) {
    const std::string suffix = submaps.size() > 1 ? "_" + std::to_string(k) : "";
    MeshWriter writer(source.folder.path, suffix, {.obj = options.obj, .vtk = options.vtk});
    MeshMaker maker(source, options, threads, submaps[k], step);
    if (Status status = maker.Make(&writer); !status.ok()) return status;
    made.stopped = maker.stopped();
    made.meshes += maker.has_mesh() ? 1 : 0;
  }
  return made;
}

}  // namespace pliant
