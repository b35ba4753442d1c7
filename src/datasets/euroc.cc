// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// EuRoC MAV (Burri et al., IJRR 2016) and what is written like it: mav0/cam0 and mav0/cam1 with data.csv (ns, file),
// data/ and sensor.yaml; mav0/state_groundtruth_estimate0/data.csv, world from body, meters. A pose belongs to the
// image nearest in time, within 20 ms.
#include <cmath>
#include <map>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "datasets/formats.h"
#include "datasets/set_files.h"
#include "io/yaml.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr double kNanosecond_s = 1e-9;

fs::path RootOf(const fs::path& path) { return IsFolder(path / "mav0") ? path / "mav0" : path; }

struct Sensor {
  StereoCalibration::Eye lens;
  bool fisheye = false;
  ImageSize size;
  Rigid3 body_from_cam;  // mm
  fs::path file;
};

std::vector<double> NumbersOf(const YAML::Node& node) {
  std::vector<double> numbers;
  if (!node.IsSequence()) return numbers;
  for (const YAML::Node& value : node) {
    double number = 0;
    if (!value.IsScalar() || !ParseDouble(value.Scalar(), &number)) return {};
    numbers.push_back(number);
  }
  return numbers;
}

Result<Sensor> ReadSensor(const fs::path& file) {
  const Status unreadable(ErrorCode::kUnreadable,
                          file.string() +
                              " is not EuRoC's description of a camera: it has resolution, intrinsics, "
                              "distortion_model, distortion_coefficients and T_BS");
  auto text = ReadFile(file.string());
  if (!text.ok()) return text.status();
  if (text->starts_with("%YAML")) (*text)[0] = '#';
  const auto parsed = ParseYaml(file.string(), *text);
  if (!parsed.ok() || !parsed->IsMap()) return unreadable;
  const YAML::Node& root = *parsed;
  const auto size = NumbersOf(root["resolution"]);
  const auto lens = NumbersOf(root["intrinsics"]);
  const auto distortion = NumbersOf(root["distortion_coefficients"]);
  const auto body_from_cam =
      root["T_BS"] && root["T_BS"].IsMap() ? NumbersOf(root["T_BS"]["data"]) : std::vector<double>();
  const auto image_size = size.size() == 2 ? ToImageSize(size[0], size[1]) : std::nullopt;
  if (!image_size || lens.size() != 4 || distortion.size() != 4 || body_from_cam.size() != 16) return unreadable;
  auto pose = PoseOfMatrix(file.string() + ": T_BS", body_from_cam);
  if (!pose.ok()) return pose.status();
  pose->translation *= kMeter_mm;
  const YAML::Node named = root["distortion_model"];
  const std::string model = named && named.IsScalar() ? named.Scalar() : "";
  if (model != "equidistant" && model != "radial-tangential" && model != "radtan")
    return Status(ErrorCode::kInvalidArgument,
                  file.string() + " has the distortion_model " + Quoted(model) +
                      ", which is not known; radial-tangential (radtan) and equidistant are");
  return Sensor{{lens[0], lens[1], lens[2], lens[3], distortion}, model == "equidistant", *image_size, *pose, file};
}

struct Listed {
  std::vector<double> times_s;
  std::vector<fs::path> files;
};

Result<Listed> ReadList(const fs::path& camera, std::vector<std::string>* warnings) {
  auto reader = LineReader::Open((camera / "data.csv").string());
  if (!reader.ok()) return reader.status();
  Listed list;
  ListedFiles files;
  std::string_view line;
  while (reader->Next(&line)) {
    if (line.empty() || line.front() == '#') continue;
    const auto fields = Split(line, ',');
    double time_ns = 0;
    if (fields.size() < 2 || !ParseDouble(fields[0], &time_ns))
      return reader->Error("a line has a time in ns and a file");
    const auto name = Split(fields[1], ' ');
    if (name.empty()) return reader->Error("a line has a time in ns and a file");
    const fs::path file = camera / "data" / name.front();
    if (!files.Has(file)) continue;
    list.times_s.push_back(kNanosecond_s * time_ns);
    list.files.push_back(file);
  }
  if (Status status = reader->End(); !status.ok()) return status;
  files.WarnOfMissing(camera / "data.csv", warnings);
  if (list.files.empty())
    return Status(ErrorCode::kNotFound,
                  (camera / "data.csv").string() + " names no image that is there; check the path");
  return list;
}

// Those of both that were taken at the same time; how many others there were.
std::size_t KeepPairs(Listed* left, Listed* right) {
  const std::size_t before = left->files.size() + right->files.size();
  std::map<double, fs::path> right_at;
  for (std::size_t i = 0; i < right->files.size(); ++i) right_at.emplace(right->times_s[i], right->files[i]);
  Listed pairs[2];
  for (std::size_t i = 0; i < left->files.size(); ++i) {
    const auto found = right_at.find(left->times_s[i]);
    if (found == right_at.end()) continue;
    pairs[0].times_s.push_back(left->times_s[i]);
    pairs[0].files.push_back(left->files[i]);
    pairs[1].times_s.push_back(found->first);
    pairs[1].files.push_back(found->second);
  }
  *left = std::move(pairs[0]);
  *right = std::move(pairs[1]);
  return before - left->files.size() - right->files.size();
}

Status AddPoses(const fs::path& file, const Rigid3& body_from_cam, DataSet* data_set) {
  const auto poses = ReadEurocTrajectory(file.string());
  if (!poses.ok()) return poses.status();
  data_set->world_from_cam = PosesAt(data_set->timestamps_s, *poses, kMeter_mm, kMaxDifference_s, body_from_cam);
  return Status::Ok();
}

Result<DataSet> OpenMono(const SequenceRequest& request, const Sensor& eye, std::unique_ptr<ImageStream> images) {
  std::vector<double> params = {eye.lens.fx, eye.lens.fy, eye.lens.cx, eye.lens.cy};
  params.insert(params.end(), eye.lens.distortion.begin(), eye.lens.distortion.end());
  auto camera = Camera::Create(eye.fisheye ? CameraModelId::kOpenCvFisheye : CameraModelId::kOpenCv, eye.size.width,
                               eye.size.height, params);
  if (!camera.ok()) return Status(camera.status().code(), eye.file.string() + ": " + camera.status().message());
  return Calibrated(request, std::move(images), SourceCalibration{*std::move(camera), eye.file});
}

}  // namespace

bool IsEuroc(const fs::path& path) { return IsFile(RootOf(path) / "cam0" / "data.csv"); }

std::string EurocLacks(const fs::path& path) { return IsFolder(path / "mav0") ? "mav0/cam0/data.csv" : ""; }

Result<DataSet> OpenEuroc(const SequenceRequest& request) {
  const fs::path root = RootOf(request.image_path);
  std::vector<std::string> warnings;
  auto left_list = ReadList(root / "cam0", &warnings);
  if (!left_list.ok()) return left_list.status();
  const auto left = ReadSensor(root / "cam0" / "sensor.yaml");
  if (!left.ok()) return left.status();
  Result<DataSet> data_set = Status(ErrorCode::kNotFound, "");
  std::size_t left_over = 0;
  const bool wants_pairs = IsFile(root / "cam1" / "data.csv") && !left->fisheye && request.camera_path.empty();
  std::vector<std::string> of_right;  // those that are missing count as left over
  auto right_list = wants_pairs ? ReadList(root / "cam1", &of_right) : Result<Listed>(Listed());
  if (!right_list.ok() && right_list.status().code() != ErrorCode::kNotFound) return right_list.status();
  if (!right_list.ok()) warnings.push_back("pairs are not read: " + right_list.status().message());
  if (wants_pairs && right_list.ok()) {
    left_over = KeepPairs(&*left_list, &*right_list);
    if (left_list->files.empty())
      return Status(ErrorCode::kMismatch, root.string() + " has no image of cam0 and cam1 of the same time");
    const auto right = ReadSensor(root / "cam1" / "sensor.yaml");
    if (!right.ok()) return right.status();
    const StereoCalibration calibration{left->lens, right->lens, right->body_from_cam.Inverse() * left->body_from_cam,
                                        left->size, false};
    data_set = RectifiedPairs(calibration, left->file, {left->size.width, left->size.height}, PairLayout::kApart,
                              {StreamFiles(root / "cam0" / "data", left_list->files),
                               StreamFiles(root / "cam1" / "data", right_list->files)});
    if (data_set.ok()) data_set->mask_path = request.mask_path;
  } else {
    data_set = OpenMono(request, *left, StreamFiles(root / "cam0" / "data", left_list->files));
  }
  if (!data_set.ok()) return data_set.status();
  data_set->warnings.insert(data_set->warnings.end(), warnings.begin(), warnings.end());
  if (left_over > 0)
    data_set->warnings.push_back(std::to_string(left_over) + " images of cam0 or cam1 in " + root.string() +
                                 " have no image of the other camera at the same time; they are left out");
  data_set->timestamps_s = std::move(left_list->times_s);
  if (const fs::path file = root / "state_groundtruth_estimate0" / "data.csv"; IsFile(file))
    if (Status status = AddPoses(file, left->body_from_cam * data_set->raw_from_given, &*data_set); !status.ok())
      return status;
  return data_set;
}

}  // namespace pliant
