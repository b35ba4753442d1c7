// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether images are fit to be tracked: what their own changes say of repeated images, uneven times, overlays that are
// burned in, and masks the wrong way round. Every threshold is a share of what the recording itself changes by, so that
// none depends on its noise, its compression or its light. A recording in which little changes says little, and nothing
// is reported then.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

class StateArchive;

// Of an image; pixels from `x` to `x` + `width` - 1.
struct PixelRectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

struct ImageCheck {
  int images = 0;
  // Images that show what the one before shows: they differ by a small part of what their neighbors differ by.
  int repeated = 0;
  int damaged = 0;  // frames of a video between them that cannot be decoded
  // Between times that the source itself says; 0: it says none.
  int steps = 0;
  int uneven_steps = 0;      // longer or shorter than the median one by more than half
  double median_step_s = 0;  // of the steps
  double longest_step_s = 0;
  // Whether the images tell of overlays: there are enough of them, and most of the view changes.
  bool tells_overlays = false;
  // Pixels with sharp edges that never change while the rest of the image does.
  std::optional<PixelRectangle> overlay;
  bool has_masks = false;  // that take away enough to be judged
  // What the masks leave is dark and does not change, and what they take away is lit and does.
  bool masks_are_inverted = false;
  double left_level = 0;   // mean gray level of what the masks leave
  double taken_level = 0;  // and of what they take away
  // Of the view, without dark surroundings, that the masks leave; nothing: there are none.
  std::optional<double> left_share;
  // One sentence each: what is wrong, and what to do.
  std::vector<std::string> wrong;
};

// Looks at images of one size as they come, in order. Keeps about a hundred small ones at most.
class ImageChecker {
 public:
  ImageChecker();
  ImageChecker(ImageChecker&&) noexcept;
  ImageChecker& operator=(ImageChecker&&) noexcept;
  ~ImageChecker();

  void Add(const SequenceFrame& frame);
  // Of all that were added.
  ImageCheck Check() const;

  void Serialize(StateArchive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// A sequence whose images are looked at as they are read. All else is said by `source`, which must outlive it.
class CheckedSequence final : public Sequence {
 public:
  explicit CheckedSequence(Sequence& source) : source_(source) {}

  const Camera& camera() const override { return source_.camera(); }
  int size() const override { return source_.size(); }
  Result<std::optional<SequenceFrame>> Next() override;
  Result<std::optional<cv::Mat>> Depth(int frame_idx) const override { return source_.Depth(frame_idx); }
  std::optional<Rigid3> WorldFromCamera(int frame_idx) const override { return source_.WorldFromCamera(frame_idx); }
  std::optional<PhotometricCalibration> Photometric() const override { return source_.Photometric(); }
  std::optional<double> BaselineMm() const override { return source_.BaselineMm(); }
  Result<std::optional<cv::Mat>> Right() override { return source_.Right(); }
  Status CheckFiles() const override { return source_.CheckFiles(); }
  std::optional<double> TimestampS(int frame_idx) const override { return source_.TimestampS(frame_idx); }
  std::optional<std::string> Name(int frame_idx) const override { return source_.Name(frame_idx); }
  std::vector<std::string> Warnings() const override { return source_.Warnings(); }

  // Of what was read so far.
  ImageCheck Check() const { return checker_.Check(); }

  // What is known of the images; not the source.
  void Serialize(StateArchive& archive) { checker_.Serialize(archive); }

 private:
  Sequence& source_;
  bool failed_ = false;  // the run ends there; what is read ahead after it says nothing of it
  ImageChecker checker_;
};

}  // namespace pliant
