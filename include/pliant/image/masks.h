// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Which pixels show the scene. Three things do not: what a given mask excludes, specular highlights (they move with the
// light, not with the tissue), and the dark surroundings of an endoscope's round or octagonal field of view. A valid
// mask is CV_8UC1, 255 = usable, 0 = not. Equations: docs/method.md, eq. P13.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"

namespace pliant {

class StateArchive;

struct MaskOptions {
  Switch highlights = Switch::kOn;
  int highlight_level = 235;           // gray levels: brighter is saturated, whatever its color
  int highlight_near_level = 190;      // gray levels: brighter AND pale AND brighter than its surroundings
  double highlight_saturation = 0.25;  // (max - min) / max of B, G, R: below this a bright pixel is pale
  double highlight_contrast = 40;      // gray levels above the local median that make a near-saturated pixel specular
  int highlight_dilation_px = 3;       // the halo of a highlight moves with it
  Switch border = Switch::kOn;
  int border_level = 16;       // gray levels: the surroundings are darker than this
  int border_dilation_px = 4;  // the rim is blurred and does not move with the scene

  void List(OptionTable& table);  // group "Masks"
};

// The pixels that are highlights (255) in an 8-bit image with 1 or 3 channels, dilated.
cv::Mat HighlightMask(const cv::Mat& image, const MaskOptions& options);

// The dark surroundings (255): dark regions that touch the image border and frame the image (its corners or whole
// sides), dilated. A dark lumen in the middle is kept, and so is a dark region that merely runs out of one side.
cv::Mat DarkBorderMask(const cv::Mat& gray, const MaskOptions& options);

// Everything together: 255 where a pixel is usable. `given` is empty, or CV_8UC1 of the image's size with 0 = ignore
// (another size or type is the caller's error).
cv::Mat ValidMask(const cv::Mat& image, const cv::Mat& given, const MaskOptions& options);

// A valid mask with its integral image: how much of a square is usable, in constant time.
class SupportMask {
 public:
  SupportMask() = default;                     // everything is usable, inside and outside
  explicit SupportMask(const cv::Mat& valid);  // CV_8UC1, 0 = not usable; nothing outside is usable

  bool unrestricted() const { return integral_.empty(); }
  // Share of usable pixels in [x - radius, x + radius] x [y - radius, y + radius], 0..1.
  double Fraction(int x, int y, int radius) const;
  bool Valid(int x, int y) const;
  void Serialize(StateArchive& archive);
  const cv::Mat& valid() const { return valid_; }

 private:
  cv::Mat valid_;
  cv::Mat integral_;  // CV_32SC1, one larger than valid_ each way
};

// Usable only where the whole square of 2 radius + 1 pixels is usable and inside the image.
cv::Mat ErodeMask(const cv::Mat& valid, int radius_px);

}  // namespace pliant
