// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How good a run's first map is: what an initializer is measured by, before tracking improves or degrades it. Of the
// points that the map has in one frame, each with its depth z in the run's camera and the true depth z^gt of the
// surface at the pixel where it was seen (surface_error.h):
//   r_i = z_i / z_i^gt,   s = 1 / median r_i,   e_i = | s r_i - 1 |
// A monocular map has no scale, so it gets the best one; a point that is wrong moves s no further than its rank. No
// point is left out but those without truth. Beside it stands the null: the same pixels at one constant depth.
//
// Two frames are looked at. The DECLARED one, in which the map was made, is the headline: the scene may have deformed
// since the reference, and it is from here, with these points and this camera, that tracking goes on. The REFERENCE is
// the one that a map of a rigid scene is made for: where the reference is right and the declared frame is not, the map
// is good and too old.
//
// The camera's motion from one to the other is compared as a rotation and a direction of translation (a monocular map
// knows no length). Where the scene deforms, part of it is a gauge: what the scene does as a whole may be told as the
// camera's, and no image can say which it was.
#pragma once

#include <optional>
#include <span>

#include "pliant/base/status.h"
#include "pliant/evaluation/point_error.h"
#include "pliant/evaluation/run_input.h"
#include "pliant/evaluation/trajectory_error.h"

namespace pliant {

struct RelativeDepthFigures {
  double scale = 1;  // s; 1 where the median ratio is not positive
  double median = 0;
  double rmse = 0;
  double p90 = 0;  // 90 % of the errors are not larger
};

struct FirstMapDepth {
  int frame_idx = 0;
  int points = 0;
  LeftOutCounts left_out;  // observations without truth
  RelativeDepthFigures estimate;
  RelativeDepthFigures null;
};

// The declared frame's camera as seen from the reference's.
struct FirstMapMotion {
  double rotation_error_deg = 0;
  double true_rotation_deg = 0;  // what a camera that does not turn scores
  std::optional<double>
      direction_error_deg;  // of the translation, in the reference frame; nothing: a camera stood still
  double true_translation_mm = 0;
};

struct FirstMapError {
  FirstMapFrames frames;
  int frames_waited = 0;                   // read after the reference, the declared one included; 0: a map at once
  int frames_before = 0;                   // read before the declared one, those of references given up among them
  FirstMapDepth declared;                  // the headline
  std::optional<FirstMapDepth> reference;  // nothing: none of the points seen there has truth
  std::optional<FirstMapMotion> motion;    // nothing: the two frames are one, or have no true poses
  double initialize_total_ms = 0;          // what the initializer took, from the run's first frame to the declared one
  double initialize_largest_ms = 0;        // and in one frame at most
};

// What is known of one of the two frames; nothing where the sequence has no truth for it.
struct FirstMapTruth {
  std::optional<PairedFrame> surface;
  std::optional<PosePair> poses;
};

// From which frames the run has its first map; nothing where it does not say.
std::optional<FirstMapFrames> FindFirstMap(std::span<const EvaluationFrame> frames);

// `frames`: all that the run read. Fails with kNotFound where the run does not say from which frames its first map is,
// or the sequence has no depth for the declared one, and with kInsufficient where no point in it has true depth.
Result<FirstMapError> ComputeFirstMapError(std::span<const EvaluationFrame> frames, const FirstMapTruth& reference,
                                           const FirstMapTruth& declared);

}  // namespace pliant
