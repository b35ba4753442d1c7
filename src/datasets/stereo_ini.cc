// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "datasets/calibration_files.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// "[Section]" and "key = value" lines: numbers by "Section.key"; what is no number is passed over.
Result<std::map<std::string, double>> ReadIni(const fs::path& file) {
  auto reader = LineReader::Open(file.string());
  if (!reader.ok()) return reader.status();
  std::map<std::string, double> values;
  std::string section;
  std::string_view line;
  while (reader->Next(&line)) {
    const std::string text = Trimmed(line);
    if (text.empty() || text.front() == ';' || text.front() == '#') continue;
    if (text.front() == '[' && text.back() == ']') {
      section = Trimmed(std::string_view(text).substr(1, text.size() - 2));
      continue;
    }
    const std::size_t equals = text.find('=');
    double value = 0;
    if (equals != std::string::npos && ParseDouble(Trimmed(std::string_view(text).substr(equals + 1)), &value))
      values[section + "." + Trimmed(std::string_view(text).substr(0, equals))] = value;
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return values;
}

class Ini {
 public:
  Ini(fs::path file, std::map<std::string, double> values) : file_(std::move(file)), values_(std::move(values)) {}

  double Get(const std::string& key) {
    const auto found = values_.find(key);
    if (found != values_.end()) return found->second;
    if (missing_.empty()) missing_ = key;
    return 0;
  }
  bool Has(const std::string& key) const { return values_.contains(key); }
  Status Complete() const {
    if (missing_.empty()) return Status::Ok();
    return {ErrorCode::kUnreadable, file_.string() + " has no number " + Quoted(missing_) + "; copy it again"};
  }

 private:
  fs::path file_;
  std::map<std::string, double> values_;
  std::string missing_;
};

StereoCalibration::Eye EyeOf(const std::string& section, Ini* ini) {
  constexpr int kMaxCoefficients = 8;
  StereoCalibration::Eye eye{ini->Get(section + ".fc_x"),
                             ini->Get(section + ".fc_y"),
                             ini->Get(section + ".cc_x"),
                             ini->Get(section + ".cc_y"),
                             {}};
  for (int k = 0; k < kMaxCoefficients && ini->Has(section + ".kc_" + std::to_string(k)); ++k)
    eye.distortion.push_back(ini->Get(section + ".kc_" + std::to_string(k)));
  // OpenCV takes 4, 5 or 8.
  if (eye.distortion.size() < 4)
    eye.distortion.resize(4, 0.0);
  else if (eye.distortion.size() > 5)
    eye.distortion.resize(8, 0.0);
  return eye;
}

}  // namespace

Result<StereoCalibration> ReadStereoIni(const fs::path& file) {
  auto values = ReadIni(file);
  if (!values.ok()) return values.status();
  Ini ini(file, *std::move(values));
  StereoCalibration calibration{EyeOf("StereoLeft", &ini), EyeOf("StereoRight", &ini), {}, {}, false};
  Eigen::Matrix3d turn;
  for (int k = 0; k < 9; ++k) turn(k / 3, k % 3) = ini.Get("StereoRight.R_" + std::to_string(k));
  Eigen::Vector3d t;
  for (int k = 0; k < 3; ++k) t[k] = ini.Get("StereoRight.T_" + std::to_string(k));
  calibration.image_size = ToImageSize(ini.Get("StereoLeft.res_x"), ini.Get("StereoLeft.res_y"));
  if (Status status = ini.Complete(); !status.ok()) return status;
  if (!calibration.image_size)
    return Status(ErrorCode::kUnreadable, file.string() + ": res_x and res_y of StereoLeft are no size of an image");
  if (!(turn * turn.transpose()).isIdentity(1e-3))
    return Status(ErrorCode::kUnreadable, file.string() + ": R_0 to R_8 of StereoRight are not a rotation");
  calibration.right_from_left = Rigid3(turn, t.norm() < kShortestBaseline_mm ? Eigen::Vector3d(kMeter_mm * t) : t);
  return calibration;
}

}  // namespace pliant
