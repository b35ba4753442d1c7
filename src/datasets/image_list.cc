// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/image_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <span>
#include <system_error>
#include <utility>

#include "datasets/image_file.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

constexpr std::array<std::string_view, 6> kImageEndings = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff"};
constexpr std::array<std::string_view, 5> kDepthEndings = {".png", ".tif", ".tiff", ".npy", ".exr"};

std::span<const std::string_view> EndingsOf(CompanionKind kind) {
  if (kind == CompanionKind::kImages) return kImageEndings;
  const std::span<const std::string_view> all = kDepthEndings;
  return kind == CompanionKind::kDepthPriors ? all : all.first(all.size() - 1);  // without .exr
}

// "png, jpg".
std::string ListText(std::span<const std::string_view> endings) {
  return CommaSeparated(endings, [](std::string_view ending) { return ending.substr(1); });
}

bool HasEnding(const fs::path& path, std::span<const std::string_view> endings) {
  if (path.filename().string().starts_with('.')) return false;
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::find(endings, extension) != endings.end();
}

// The digits at `at` without leading zeros; moves `at` past them.
std::string_view TakeNumber(std::string_view text, std::size_t* at) {
  while (*at < text.size() && text[*at] == '0') ++*at;
  const std::size_t begin = *at;
  while (*at < text.size() && IsDigit(text[*at])) ++*at;
  return text.substr(begin, *at - begin);
}

}  // namespace

bool NaturalLess(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string_view m = TakeNumber(a, &i);
      const std::string_view n = TakeNumber(b, &j);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;
}

Result<std::vector<fs::path>> ListImages(const fs::path& folder, CompanionKind kind) {
  const auto endings = EndingsOf(kind);
  std::error_code error;
  if (!fs::exists(folder, error))
    return Status(ErrorCode::kNotFound, "there is no folder " + folder.string() + "; check the path");
  if (!fs::is_directory(folder, error))
    return Status(ErrorCode::kUnreadable, folder.string() + " is a file where a folder of images is expected");
  std::vector<fs::path> images;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error))
    if (std::error_code ignored; HasEnding(entry->path(), endings) && !entry->is_directory(ignored))
      images.push_back(entry->path());
  if (error)
    return Status(ErrorCode::kUnreadable,
                  "cannot list the folder " + folder.string() + " (" + error.message() + "); check its permissions");
  if (images.empty())
    return Status(ErrorCode::kNotFound,
                  "the folder " + folder.string() + " holds no image (" + ListText(endings) + "); check the path");
  // Names are written into lines of text files, COLMAP's among them, and into JSON.
  for (const fs::path& image : images) {
    const std::string name = image.filename().string();
    if (name.find_first_of("\n\r") != std::string::npos)
      return Status(ErrorCode::kInvalidArgument,
                    "the folder " + folder.string() + " holds an image whose name has a line break; rename it");
    if (!IsUtf8(name))
      return Status(ErrorCode::kInvalidArgument, "the folder " + folder.string() + " holds an image whose name, " +
                                                     Quoted(name) + ", is not UTF-8; rename it");
  }
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return NaturalLess(a.filename().string(), b.filename().string());
  });
  return images;
}

Result<FrameRange> FrameRange::From(const SequenceRequest& request) {
  if (request.start < 0)
    return Status(ErrorCode::kInvalidArgument,
                  "start is " + std::to_string(request.start) + "; frames are counted from 0");
  if (request.stride < 1)
    return Status(ErrorCode::kInvalidArgument, "stride is " + std::to_string(request.stride) + "; it is at least 1");
  if (request.end != -1 && request.end <= request.start)
    return Status(ErrorCode::kInvalidArgument, "end is " + std::to_string(request.end) + " and start is " +
                                                   std::to_string(request.start) +
                                                   "; end is one past the last frame, or -1 for all");
  // A longer stride than this leaves one frame; bounded, the number after it does not overflow.
  const int stride = std::min(request.stride, std::numeric_limits<int>::max() - request.start);
  return FrameRange{request.start, request.end, std::max(stride, 1)};
}

Result<FrameRange> FrameRange::Within(int count, const fs::path& source) const {
  if (start >= count)
    return Status(ErrorCode::kInvalidArgument, "start is " + std::to_string(start) + ", but " + source.string() +
                                                   " has " + std::to_string(count) + " frames, counted from 0");
  return FrameRange{start, end == -1 ? count : std::min(end, count), stride};
}

std::vector<std::string> Stems(const ImageStream& images) {
  std::vector<std::string> stems;
  for (int idx = 0; idx < std::max(images.count(), 1); ++idx)
    stems.push_back(fs::path(images.Name(idx)).stem().string());
  return stems;
}

void WarnOfGaps(const std::vector<int>& numbers, const fs::path& folder, std::vector<std::string>* warnings) {
  int step = std::numeric_limits<int>::max();
  for (std::size_t k = 1; k < numbers.size(); ++k) step = std::min(step, numbers[k] - numbers[k - 1]);
  if (numbers.size() < 2 || step < 1) return;
  int missing = 0;
  int first = -1;
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    const int gap = (numbers[k] - numbers[k - 1]) / step - 1;
    if (gap > 0 && first < 0) first = numbers[k - 1] + step;
    missing += gap;
  }
  if (missing > 0)
    warnings->push_back("in " + folder.string() + " " + std::to_string(missing) + " images are missing, the first is " +
                        "number " + std::to_string(first) + "; frames are those that are there, counted from 0");
}

void WarnOfGaps(const ImageStream& images, std::vector<std::string>* warnings) {
  std::vector<int> numbers;
  for (const std::string& stem : Stems(images)) {
    const std::size_t digits = stem.find_last_not_of("0123456789") + 1;
    int number = 0;
    if (digits == stem.size() || !ParseInt(stem.substr(digits), &number)) return;
    numbers.push_back(number);
  }
  // Times and chosen frames are no counters: those go on by one step but for a few gaps of whole steps.
  std::map<int, std::size_t> steps;
  for (std::size_t k = 1; k < numbers.size(); ++k) ++steps[numbers[k] - numbers[k - 1]];
  if (steps.empty() || steps.begin()->first < 1 || 2 * steps.begin()->second < numbers.size()) return;
  if (std::any_of(steps.begin(), steps.end(), [&](const auto& step) { return step.first % steps.begin()->first != 0; }))
    return;
  WarnOfGaps(numbers, images.path(), warnings);
}

Result<CompanionImages> CompanionImages::Open(std::string what, const fs::path& path,
                                              const std::vector<std::string>& frame_stems, Counts counts,
                                              CompanionKind kind) {
  CompanionImages companion;
  companion.what_ = std::move(what);
  companion.path_ = path;
  std::error_code error;
  if (fs::is_regular_file(path, error)) {
    companion.one_for_all_ = true;
    companion.files_ = {path};
    return companion;
  }
  Result<std::vector<fs::path>> files = ListImages(path, kind);
  if (!files.ok()) return files.status();
  companion.files_ = *std::move(files);
  for (const fs::path& file : companion.files_) companion.file_of_stem_.emplace(file.stem().string(), file);
  companion.by_stem_ = std::any_of(frame_stems.begin(), frame_stems.end(), [&companion](const std::string& stem) {
    return companion.file_of_stem_.contains(stem);
  });
  if (!companion.by_stem_ && counts == Counts::kMustAgree && companion.files_.size() != frame_stems.size())
    return Status(ErrorCode::kMismatch, "the folder " + path.string() + " has " +
                                            std::to_string(companion.files_.size()) + " " + companion.what_ +
                                            " images for " + std::to_string(frame_stems.size()) +
                                            " frames, and no name matches; name each like its frame");
  return companion;
}

fs::path CompanionImages::Find(int frame_idx, const std::string& frame_stem) const {
  if (one_for_all_) return files_.front();
  if (by_stem_) {
    const auto found = file_of_stem_.find(frame_stem);
    return found == file_of_stem_.end() ? fs::path() : found->second;
  }
  return frame_idx >= 0 && frame_idx < static_cast<int>(files_.size()) ? files_[static_cast<std::size_t>(frame_idx)]
                                                                       : fs::path();
}

Result<fs::path> CompanionImages::Require(int frame_idx, const std::string& frame_name) const {
  fs::path file = Find(frame_idx, fs::path(frame_name).stem().string());
  if (file.empty())
    return Status(ErrorCode::kNotFound, "the folder " + path_.string() + " has no " + what_ + " for the frame " +
                                            frame_name + " (number " + std::to_string(frame_idx) +
                                            "); add it or leave the folder out");
  return file;
}

Status CheckFrameMaskSize(const fs::path& mask, cv::Size size, cv::Size images) {
  if (size == images) return Status::Ok();
  return {ErrorCode::kMismatch, "the mask " + mask.string() + " is " + SizeText(size.width, size.height) +
                                    ", but the images are " + SizeText(images.width, images.height) +
                                    "; masks have the size of the images, before pairs are rectified"};
}

Result<cv::Mat> ReadFrameMask(const CompanionImages& masks, int frame_idx, const std::string& frame_name, int width,
                              int height) {
  const Result<fs::path> file = masks.Require(frame_idx, frame_name);
  if (!file.ok()) return file.status();
  Result<cv::Mat> mask = ReadMaskImage(*file);
  if (!mask.ok()) return mask;
  if (Status status = CheckFrameMaskSize(*file, mask->size(), {width, height}); !status.ok()) return status;
  return mask;
}

}  // namespace pliant
