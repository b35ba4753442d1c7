// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images one after the other: those of a list of files, or of a video.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

class VideoIndex;

class ImageStream {
 public:
  virtual ~ImageStream() = default;

  virtual const std::filesystem::path& path() const = 0;  // the folder, or the video
  // How many; of a video the container's word, 0 where it says none.
  virtual int count() const = 0;
  // False: a video, whose count may be off.
  virtual bool count_is_exact() const = 0;
  // Images a second, where the source says it.
  virtual std::optional<double> fps() const = 0;
  // The name of the file, or NNNNNN.png for an image of a video.
  virtual std::string Name(int idx) const = 0;
  // For messages: "the image FILE", "frame 7 of the video FILE".
  virtual std::string Title(int idx) const = 0;
  // What the images' size is said to be, or that of image `idx`; nothing where it cannot be seen.
  virtual std::optional<cv::Size> SizeAt(int idx) const = 0;

  // The size of the file of image `idx`, before any change of it; nothing where there is no file. Fails as Read does
  // where the file is cut off or no image; it is decoded only where its head and end do not tell.
  virtual Result<std::optional<cv::Size>> StoredSize(int /*idx*/) const { return std::optional<cv::Size>(); }

  // The largest value in the file of image `idx`, if its values have 16 bits; nothing else, or where it cannot be read.
  virtual std::optional<int> Largest16BitValue(int /*idx*/) const { return std::nullopt; }

  // 8-bit, gray or BGR; nothing beyond the end. `idx` may not be smaller than the time before. Fails with kNotFound or
  // kUnreadable; a list of files can be read on after that, a video that breaks off ends.
  virtual Result<std::optional<cv::Mat>> Read(int idx) = 0;
  // Whether Read has failed for image `idx` because it is damaged, and the next one may be read.
  virtual bool IsDamaged(int /*idx*/) const { return false; }
  // When the image that Read gave last was taken, by the source's own word; nothing where it says nothing.
  virtual std::optional<double> RecordedS() const { return std::nullopt; }
  // The time of image `idx`, which was read, seconds; nothing: it goes by its number.
  virtual std::optional<double> TimestampS(int /*idx*/) const { return std::nullopt; }
};

// At least one file; `folder` is where they lie.
std::unique_ptr<ImageStream> StreamFiles(std::filesystem::path folder, std::vector<std::filesystem::path> files);
// The images of a folder in natural order. Errors as ListImages.
Result<std::unique_ptr<ImageStream>> StreamFolder(const std::filesystem::path& folder);
// Through OpenCV's FFmpeg back end. What is passed over is decoded and dropped, since seeking is not exact in most
// containers; but far ahead it is sought where `index`, which learns from what is read, knows the frame and the video
// gives the same one. `index` is that of this file; null: none. A video
// that promises clearly more frames than can be decoded fails once with kUnreadable. Fails
// with kUnreadable.
Result<std::unique_ptr<ImageStream>> StreamVideo(const std::filesystem::path& file,
                                                 std::shared_ptr<VideoIndex> index = nullptr);

}  // namespace pliant
