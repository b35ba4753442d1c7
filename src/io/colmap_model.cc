// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <limits>
#include <optional>

#include "io/colmap_pixels.h"
#include "io/text.h"
#include "pliant/io/colmap.h"
#include "pliant/io/run_reader.h"

namespace pliant {
namespace {

// Track elements held at once: 8 bytes each.
constexpr std::int64_t kMostTrackElements = 4'000'000;

// One of the model's files in one or both formats.
class ModelFile {
 public:
  static Result<ModelFile> Create(const std::string& folder, const std::string& name, ColmapFormat format) {
    ModelFile file;
    if (format != ColmapFormat::kBinary) {
      auto text = OutputFile::Create(folder + "/" + name + ".txt");
      if (!text.ok()) return text.status();
      file.text_file_ = std::move(text).value();
    }
    if (format != ColmapFormat::kText) {
      auto binary = OutputFile::Create(folder + "/" + name + ".bin");
      if (!binary.ok()) return binary.status();
      file.binary_file_ = std::move(binary).value();
    }
    return file;
  }
  // Where rows are put together; what is put where no file is wanted is thrown away.
  std::string text;
  std::string binary;

  Status Flush() {
    if (Status status = Put(text_file_, &text); !status.ok()) return status;
    return Put(binary_file_, &binary);
  }
  Status Close() {
    for (auto* entry : {&text_file_, &binary_file_}) {
      if (!entry->has_value()) continue;
      std::string& rest = entry == &text_file_ ? text : binary;
      if (Status status = (*entry)->Append(rest); !status.ok()) return status;
      if (Status status = (*entry)->Close(); !status.ok()) return status;
    }
    return Status::Ok();
  }

 private:
  static Status Put(std::optional<OutputFile>& file, std::string* buffer) {
    if (file) return file->AppendWhenLarge(buffer);
    buffer->clear();
    return Status::Ok();
  }
  std::optional<OutputFile> text_file_;
  std::optional<OutputFile> binary_file_;
};

void AppendSpaced(std::string* out, double value, int decimals) {
  out->push_back(' ');
  AppendFixed(out, value, decimals);
}

Status WriteCamera(const std::string& folder, ColmapFormat format, const Camera& camera) {
  auto file = ModelFile::Create(folder, "cameras", format);
  if (!file.ok()) return file.status();
  std::vector<double> params(camera.params().begin(), camera.params().end());
  ShiftPrincipalPoint(camera.model_id(), kColmapPixelShift, params);
  file->text =
      "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
      "# Number of cameras: 1\n1 " +
      std::string(camera.model_name()) + " " + std::to_string(camera.width()) + " " + std::to_string(camera.height());
  for (const double param : params) file->text += " " + FormatDouble(param);
  file->text += "\n";
  AppendBytes(&file->binary, 1, 8);
  AppendBytes(&file->binary, 1, 4);
  AppendBytes(&file->binary, static_cast<std::uint64_t>(camera.model_id()), 4);
  AppendBytes(&file->binary, static_cast<std::uint64_t>(camera.width()), 8);
  AppendBytes(&file->binary, static_cast<std::uint64_t>(camera.height()), 8);
  for (const double param : params) AppendDouble(&file->binary, param);
  return file->Close();
}

std::uint32_t ImageId(int frame_idx) { return static_cast<std::uint32_t>(frame_idx) + 1; }

void AppendImage(ModelFile* file, const ColmapImage& image, std::span<const PointObservation> observations) {
  const Eigen::Quaterniond& q = image.cam_from_world.rotation;
  AppendInt(&file->text, ImageId(image.frame_idx));
  AppendBytes(&file->binary, ImageId(image.frame_idx), 4);
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) {
    AppendSpaced(&file->text, value, 9);
    AppendDouble(&file->binary, value);
  }
  for (const double value : image.cam_from_world.translation) {
    AppendSpaced(&file->text, value, 6);
    AppendDouble(&file->binary, value);
  }
  file->text += " 1 " + image.name + "\n";
  AppendBytes(&file->binary, 1, 4);
  file->binary.append(image.name).push_back('\0');
  AppendBytes(&file->binary, observations.size(), 8);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const PointObservation& o = observations[i];
    if (i > 0) file->text.push_back(' ');
    AppendFixed(&file->text, o.pixel.x() + kColmapPixelShift, 4);
    AppendSpaced(&file->text, o.pixel.y() + kColmapPixelShift, 4);
    file->text.push_back(' ');
    AppendInt(&file->text, o.id.value);
    for (const double pixel : o.pixel) AppendDouble(&file->binary, pixel + kColmapPixelShift);
    AppendBytes(&file->binary, static_cast<std::uint64_t>(o.id.value), 8);
  }
  file->text.push_back('\n');
}

// Goes through a run's observations frame by frame.
template <class Function>
Status ForEachFrame(const std::string& run_path, const Function& function) {
  auto reader = ObservationReader::Open(run_path);
  if (!reader.ok()) return reader.status();
  while (true) {
    auto frame = reader->Next();
    if (!frame.ok()) return frame.status();
    if (!frame->has_value()) return Status::Ok();
    if (Status status = function(**frame); !status.ok()) return status;
  }
}

Status WriteImages(const std::string& folder, ColmapFormat format, std::span<const ColmapImage> images,
                   const std::string& run_path) {
  auto file = ModelFile::Create(folder, "images", format);
  if (!file.ok()) return file.status();
  file->text =
      "# Image list with two lines of data per image:\n"
      "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
      "# Number of images: " +
      std::to_string(images.size()) + "\n";
  AppendBytes(&file->binary, images.size(), 8);
  std::size_t next = 0;
  // Images without observations are images too.
  const auto append_until = [&](int frame_idx) {
    for (; next < images.size() && images[next].frame_idx < frame_idx; ++next) AppendImage(&*file, images[next], {});
  };
  Status status = ForEachFrame(run_path, [&](const FrameObservations& frame) {
    append_until(frame.frame_idx);
    if (next < images.size() && images[next].frame_idx == frame.frame_idx)
      AppendImage(&*file, images[next++], frame.observations);
    return file->Flush();
  });
  if (!status.ok()) return status;
  append_until(std::numeric_limits<int>::max());
  return file->Close();
}

struct TrackElement {
  std::uint32_t image_id;
  std::uint32_t keypoint_idx;
};

// The tracks of consecutive points, one after the other in one array.
Result<std::vector<TrackElement>> Tracks(std::span<const ColmapPoint> points, const std::string& run_path) {
  std::vector<std::int64_t> next;   // where each point's next element goes
  std::vector<std::int64_t> limit;  // where its elements end
  std::int64_t total = 0;
  for (const ColmapPoint& point : points) {
    next.push_back(total);
    limit.push_back(total += point.num_observations);
  }
  Status mismatch(ErrorCode::kMismatch, "the observations in " + Quoted(run_path) + " are not those that were counted");
  std::vector<TrackElement> elements(static_cast<std::size_t>(total));
  const Status status = ForEachFrame(run_path, [&](const FrameObservations& frame) {
    auto point = points.begin();
    for (std::size_t i = 0; i < frame.observations.size(); ++i) {
      const PointId id = frame.observations[i].id;
      point = std::lower_bound(point, points.end(), id,
                               [](const ColmapPoint& p, PointId wanted) { return p.point.id < wanted; });
      if (point == points.end()) break;
      if (point->point.id != id) continue;
      const auto idx = static_cast<std::size_t>(point - points.begin());
      if (next[idx] == limit[idx]) return mismatch;
      elements[static_cast<std::size_t>(next[idx]++)] = {ImageId(frame.frame_idx), static_cast<std::uint32_t>(i)};
    }
    return Status::Ok();
  });
  if (!status.ok()) return status;
  if (next != limit) return mismatch;
  return elements;
}

void AppendPoint(ModelFile* file, const ColmapPoint& point, std::span<const TrackElement> track) {
  AppendInt(&file->text, point.point.id.value);
  AppendBytes(&file->binary, static_cast<std::uint64_t>(point.point.id.value), 8);
  for (const double coordinate : point.point.position) {
    AppendSpaced(&file->text, coordinate, 6);
    AppendDouble(&file->binary, coordinate);
  }
  for (const std::uint8_t channel : point.point.rgb) {
    file->text.push_back(' ');
    AppendInt(&file->text, channel);
    AppendBytes(&file->binary, channel, 1);
  }
  AppendSpaced(&file->text, point.error_px, 4);
  AppendDouble(&file->binary, point.error_px);
  AppendBytes(&file->binary, track.size(), 8);
  for (const TrackElement& element : track) {
    for (const std::uint32_t value : {element.image_id, element.keypoint_idx}) {
      file->text.push_back(' ');
      AppendInt(&file->text, value);
      AppendBytes(&file->binary, value, 4);
    }
  }
  file->text.push_back('\n');
}

Status WritePoints(const std::string& folder, ColmapFormat format, std::span<const ColmapPoint> all_points,
                   const std::string& run_path) {
  auto file = ModelFile::Create(folder, "points3D", format);
  if (!file.ok()) return file.status();
  std::vector<ColmapPoint> points;
  for (const ColmapPoint& point : all_points)
    if (point.num_observations > 0) points.push_back(point);
  file->text =
      "# 3D point list with one line of data per point:\n"
      "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
      "# Number of points: " +
      std::to_string(points.size()) +
      "\n# Positions are undeformed: the scene moved, so this model is not consistent with bundle adjustment\n";
  AppendBytes(&file->binary, points.size(), 8);
  std::size_t begin = 0;
  while (begin < points.size()) {
    std::int64_t total = points[begin].num_observations;
    std::size_t end = begin + 1;
    while (end < points.size() && total + points[end].num_observations <= kMostTrackElements)
      total += points[end++].num_observations;
    const std::span<const ColmapPoint> range(points.data() + begin, end - begin);
    const auto elements = Tracks(range, run_path);
    if (!elements.ok()) return elements.status();
    std::size_t first = 0;
    for (const ColmapPoint& point : range) {
      const auto length = static_cast<std::size_t>(point.num_observations);
      AppendPoint(&*file, point, std::span(*elements).subspan(first, length));
      first += length;
      if (Status status = file->Flush(); !status.ok()) return status;
    }
    begin = end;
  }
  return file->Close();
}

}  // namespace

Status WriteColmapModel(const std::string& folder, ColmapFormat format, const Camera& camera,
                        std::span<const ColmapImage> images, std::span<const ColmapPoint> points,
                        const std::string& run_path) {
  if (Status status = WriteCamera(folder, format, camera); !status.ok()) return status;
  if (Status status = WriteImages(folder, format, images, run_path); !status.ok()) return status;
  return WritePoints(folder, format, points, run_path);
}

}  // namespace pliant
