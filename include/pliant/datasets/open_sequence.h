// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One door to every source of images. Which one it is follows from what lies at `image_path`:
//   a folder with a subfolder images/   native sequence: camera.yaml, images/, and where they exist masks/, depth/,
//                                       right/, groundtruth.txt, times.txt (docs/formats.md), or a folder of COLMAP
//   a folder of a known data set        its images, depth, poses and pairs (docs/datasets.md)
//   any other folder                    its png, jpg, jpeg, bmp, tif and tiff files in natural order (2 before 10)
//   a file                              a video, decoded by FFmpeg, forward only
// Images become 8-bit with one or three channels: 16-bit ones are scaled by 1/257 (the same for every image, so that
// brightness stays comparable), an alpha channel is dropped, EXIF rotation is ignored (the calibration knows none).
// Timestamps: times.txt, else frame number / fps with the fps of the calibration file (a video: of the container).
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pliant/base/status.h"
#include "pliant/datasets/given_images.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

class VideoIndex;

struct SequenceRequest {
  std::filesystem::path image_path = {};  // folder of images, video file or native sequence
  // Calibration, or an assumed camera (pliant/camera/assumed_camera.h); empty: camera.yaml in image_path, for a video
  // beside the file, else the data set's own.
  std::filesystem::path camera_path = {};
  // One that is tried where none is named, and that of the images is missing or does not fit.
  std::filesystem::path spare_camera_path = {};
  std::filesystem::path mask_path = {};  // folder of masks, or one image for all frames; empty: the sequence's masks/
  // Folder of depth images of another program, by the images' names; empty: none. Images may be without one.
  std::filesystem::path depth_prior_path = {};
  int start = 0;   // first frame, by its number in the source
  int end = -1;    // one past the last frame; -1: to the end
  int stride = 1;  // every stride-th frame from `start` on
  // Instead of what lies at image_path, and of a calibration; null: none. Where image_path is not empty, these images
  // are recorded there.
  std::shared_ptr<const GivenImages> given = nullptr;
  // Where images are read several times: what was learned of a video's frames, to find them sooner; null: nothing.
  std::shared_ptr<VideoIndex> video_index = nullptr;

  // The same with all frames.
  SequenceRequest Whole() const;
  // Whether the images arrive while they are read.
  bool IsLive() const { return given && given->images->IsLive(); }
};

// Opens the source and checks all that can be seen without decoding every frame: the calibration, the first image's
// size, that every frame has its mask, times.txt and groundtruth.txt. Masks belong to images by file stem (a video's
// frame n is NNNNNN); where no stem agrees, by their order. In a mask 0 is ignored; in a JPEG mask, below 128.
// Errors, each naming the file: kNotFound (nothing there, no images, no calibration, no mask for a frame), kUnreadable
// (cannot be listed, opened or decoded; a garbled line, with its number), kMismatch (sizes or counts that disagree),
// kInvalidArgument (start, end, stride, an unknown camera model).
// Next() of the result fails for the frame that cannot be read and goes on after it; damaged frames of a video it
// leaves out.
Result<std::unique_ptr<Sequence>> OpenSequence(const SequenceRequest& request);

struct DataSetKind {
  std::string_view name;  // as in docs/datasets.md
  std::string_view what;  // for people
};

// What lies at a path, without reading it. Fails with kNotFound or kUnreadable.
Result<DataSetKind> RecognizeDataSet(const std::filesystem::path& path);

}  // namespace pliant
