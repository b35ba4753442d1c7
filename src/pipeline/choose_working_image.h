// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the images of a sequence are resized and smoothed before points are tracked in them: measured, not assumed.
// Where most of the source's own corners last, nothing is changed. Else it is counted, for several sizes and
// smoothings, how many corners of an image are left after some frames. Fewer pixels have less noise, and a patch then
// covers more of the scene; more pixels hold more corners, and a patch follows a finer deformation; the count weighs
// all of this on the recording itself. Larger patches are compared with those of
// the options in the same way, for the noise that is left. Of those whose count is as
// good as the best one, to the accuracy sqrt(n) of a count of n, the one nearest to the source is chosen.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "pliant/datasets/open_sequence.h"
#include "pliant/image/working_image.h"
#include "pliant/pipeline/track.h"

namespace pliant {

// Images that follow each other.
using ImageRun = std::vector<SequenceFrame>;

// Who waits for the images to be looked at.
struct ImageWatch {
  std::function<void(const SequenceFrame&)> on_first = {};  // the first image that is read
  const std::atomic<bool>* stop = nullptr;                  // becomes true when nothing more is to be done; may be null

  bool IsStopped() const { return stop != nullptr && *stop; }
};

// Three runs of 16 images, 60 apart, from the first on that shows a view: what one of them shows may be an exception. A
// view changes from image to image; a title card stands still, and black is black. Where that lasts for half a second
// (15 images), it is passed over; where it lasts for more than 900 images, or the source is live, it is not. Up to
// the first image that cannot be read, and up to 400 MB; empty where there is none, or `watch` is stopped.
std::vector<ImageRun> ReadFirstRuns(const SequenceRequest& request, const ImageWatch& watch = {});

// The source where `options` do not ask for a measurement, or the images do not tell: there are too few, or too few
// corners last in any of them. Images of more than 12 megapixels become images of 12 megapixels. What it gives is of no
// use where `watch` is stopped.
WorkingImage ChooseWorkingImage(const std::vector<ImageRun>& runs, const TrackOptions& options,
                                const ImageWatch& watch = {});

}  // namespace pliant
