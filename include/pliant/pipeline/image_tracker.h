// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Tracking of images as they come, without a run folder: for programs that have a camera. The pixels of its reports are
// those of the given images, whatever the working image. A run (track.h) does two things more, which need images that
// can be read again: it tracks the frames before the reference of a first map back in time, and it chooses the working
// image by the sequence's first images; here the caller may name some.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/datasets/sequence.h"
#include "pliant/image/working_image.h"
#include "pliant/pipeline/track.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/extensions.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

class ImageTracker {
 public:
  // `examples`: images that follow each other (16 are enough) as the camera will see them, by which the working image
  // is chosen where Image.working is `measured`; without them it is the image itself. Fails with kInvalidArgument for
  // options that need more than images (Oracle, a file of tracks, and an Init.method that starts from depth, pairs or a
  // model), and for a camera that cannot be resized. `extensions` are asked in Process and Finish, in the calling
  // thread; their pixels are those of the working image.
  static Result<ImageTracker> Create(const Camera& camera, const std::optional<PhotometricCalibration>& photometric,
                                     const TrackOptions& options, std::span<const SequenceFrame> examples = {},
                                     const TrackerExtensions& extensions = {});

  // The reports that became final with this frame, in order of time; each frame is reported once. From the reference on
  // reports and their images are held back until there is a map: of WindowInit.last_frame frames, or three times as
  // many where a map waits that is hardly better than one constant depth. Fails with kMismatch for an image or mask
  // that has not the camera's size, and for a depth prior of other sides, and with kInvalidArgument for a time that is
  // not after that of the frame before, and of the second frame for one of another unit (CheckFrameTimes); the frame is
  // passed over then.
  Result<std::vector<FrameReport>> Process(const SequenceFrame& frame);
  // No more frames come: the reports that are held back.
  std::vector<FrameReport> Finish();

  // How many reports are held back.
  std::size_t held_count() const { return tracker_->held().size(); }
  TrackingState state() const { return tracker_->state(); }
  // Lost for so long that no frame will be tracked any more (Tracking.submaps is off).
  bool GaveUp() const { return tracker_->GaveUp(); }
  const WorkingImage& working_image() const { return working_; }

 private:
  ImageTracker(const Camera& source, const Camera& working_camera, const WorkingImage& working,
               const TrackerInputs& inputs, const TrackOptions& options);
  std::vector<FrameReport> ProcessFrom(std::size_t next);
  Status CheckTime(const SequenceFrame& frame) const;
  bool GoBack(std::size_t* next);
  void ForgetFrames();

  Camera camera_;
  WorkingImage working_;
  TrackOptions options_;
  std::unique_ptr<Tracker> tracker_;
  std::vector<SequenceFrame> kept_;         // that are held back: tracking may go back to one of them
  std::optional<double> last_timestamp_s_;  // of the frame before
  int images_ = 0;                          // that were taken
};

}  // namespace pliant
