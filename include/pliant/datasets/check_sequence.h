// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a sequence's own images say of themselves (check_images.h) and of its truth: poses against depth, the rows of
// stereo pairs, and depth against the baseline. A flipped handedness, a wrong unit and a transposed matrix each leave a
// trace of their own. A scene that deforms is no obstacle: images a few frames apart are compared.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/datasets/check_images.h"
#include "pliant/datasets/sequence.h"

namespace pliant {

struct CheckOptions {
  int base_frames = 5;    // from which images are warped into later ones, spread over the sequence
  int max_points = 2000;  // in each, on a grid
  bool poses = true;      // are checked as well
  bool images = true;     // are checked as well, all of them
};

// How well images warped by depth and poses fit, were the poses meant otherwise.
struct PoseReading {
  std::string name;    // "as they are", "camera from world", "y is flipped", ...
  double scale = 1.0;  // by which translations were multiplied
  // Correlation of the fine structure of the images, mean over the pairs: 1 is perfect, about 0 unrelated. What falls
  // outside of the other image counts as 0.
  double correlation = 0;
};

struct PoseCheck {
  int pairs = 0;         // of images compared
  PoseReading as_given;  // the poses as the sequence gives them
  PoseReading best;      // of all readings
  // Whether the poses are right as given; nothing where the images do not tell (too little motion or structure).
  std::optional<bool> right;
};

struct StereoCheck {
  int matches = 0;
  bool enough = false;             // to tell anything
  double median_row_error_px = 0;  // |v_left - v_right|
  double share_right_way = 0;      // of the matches whose disparity is positive
  // Depth of the depth images by that of the disparities, median; nothing where there is no depth.
  std::optional<double> depth_ratio;
};

struct SequenceCheck {
  std::optional<PoseCheck> poses;     // nothing: no poses, or no depth
  std::optional<StereoCheck> stereo;  // nothing: no pairs
  std::optional<ImageCheck> images;   // nothing: they were not to be checked
  // One sentence each: what is wrong, and what to do.
  std::vector<std::string> wrong;
};

// Reads all frames; without `images` those up to the last one that is compared. The task of `progress` is "check".
// Fails as Sequence::Next, Right and Depth, and with kInterrupted by `progress`.
Result<SequenceCheck> CheckSequence(Sequence& sequence, const CheckOptions& options = {},
                                    const JobProgress& progress = {});

}  // namespace pliant
