// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Folders of images in natural order, the part of them that is read, and the masks that belong to them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "datasets/image_stream.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"

namespace pliant {

// Digits compare as numbers (frame2 before frame10), everything else by byte. A total order: names of equal value
// (frame02, frame2) fall back to bytes.
bool NaturalLess(std::string_view a, std::string_view b);

enum class CompanionKind {
  kImages,       // png, jpg, jpeg, bmp, tif, tiff
  kDepthMaps,    // png, tif, tiff, npy
  kDepthPriors,  // png, tif, tiff, exr, npy
};

// The files of a folder that are of this kind by their endings (hidden ones left out), in natural order of their names.
// Fails with kNotFound (no such folder, or no image in it) and kUnreadable (not a folder, or it cannot be listed).
Result<std::vector<std::filesystem::path>> ListImages(const std::filesystem::path& folder,
                                                      CompanionKind kind = CompanionKind::kImages);

// The frames of a request: start, start + stride, ... below end.
struct FrameRange {
  int start = 0;
  int end = -1;  // -1: not bounded
  int stride = 1;

  // Fails with kInvalidArgument when a number makes no sense in itself.
  static Result<FrameRange> From(const SequenceRequest& request);
  // Bounded by the frames there are; fails with kInvalidArgument when none is left.
  Result<FrameRange> Within(int count, const std::filesystem::path& source) const;
  // Number of frames of a bounded range.
  int Count() const { return end > start ? 1 + (end - start - 1) / stride : 0; }
};

// The names of a stream's images without their ending; of one whose count is not known the first one's.
std::vector<std::string> Stems(const ImageStream& images);

// Says in `warnings` how many numbers are left out of a folder's images; those of every Nth frame leave out none.
void WarnOfGaps(const std::vector<int>& numbers, const std::filesystem::path& folder,
                std::vector<std::string>* warnings);
// The same of the numbers that the names of a stream's images end with, where they count.
void WarnOfGaps(const ImageStream& images, std::vector<std::string>* warnings);

// The image file of every frame in one folder, by stem, or by order where no stem agrees.
class CompanionImages {
 public:
  enum class Counts { kMustAgree, kMayDiffer };  // where the order decides

  // `what` names them in messages ("mask"). A folder, or one file that serves every frame. Fails with kNotFound or
  // kUnreadable as ListImages, with kMismatch when the order decides and the counts disagree.
  static Result<CompanionImages> Open(std::string what, const std::filesystem::path& path,
                                      const std::vector<std::string>& frame_stems, Counts counts,
                                      CompanionKind kind = CompanionKind::kImages);

  // Whether files belong to frames by their names.
  bool by_name() const { return by_stem_; }
  // The file for a frame; empty: there is none.
  std::filesystem::path Find(int frame_idx, const std::string& frame_stem) const;
  // As Find, but none is an error, kNotFound.
  Result<std::filesystem::path> Require(int frame_idx, const std::string& frame_name) const;

 private:
  std::string what_;
  std::filesystem::path path_;
  bool one_for_all_ = false;
  bool by_stem_ = false;
  std::vector<std::filesystem::path> files_;
  std::map<std::string, std::filesystem::path> file_of_stem_;
};

// Fails with kMismatch where a mask has not the size of the images.
Status CheckFrameMaskSize(const std::filesystem::path& mask, cv::Size size, cv::Size images);
// The mask of one frame, checked against the camera's size (kMismatch).
Result<cv::Mat> ReadFrameMask(const CompanionImages& masks, int frame_idx, const std::string& frame_name, int width,
                              int height);

}  // namespace pliant
