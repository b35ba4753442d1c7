// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/check_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/find_overlay.h"
#include "pliant/base/state_archive.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/image/pyramid.h"
#include "pliant/image/serialize.h"

namespace pliant {
namespace {

constexpr int kGridColumns = 320;  // at least; small enough to be fast, large enough to keep letters

// Repeated images. Each pair of consecutive images is compared with the pairs around it, of which the changes of the
// larger ones count: in a recording that was converted to three times its rate two of three pairs are repeated.
constexpr int kNeighbors = 6;              // pairs on either side
constexpr double kNeighborQuantile = 0.8;  // of their changes
constexpr double kRepeatedShare = 0.15;  // of that change: below it an image is repeated; re-encoding leaves up to 0.1
constexpr double kLightOffShare = 0.2;   // of the recording's median level
constexpr int kMinRepeated = 3;
constexpr int kMaxConvertedRow = 15;        // from 4 to 60 images a second; what is longer stands still
constexpr double kMinRepeatedShare = 0.05;  // of the images; fewer are single dropped frames

constexpr double kUnevenFactor = 1.5;  // of the median step
constexpr int kMinUneven = 3;
constexpr double kMinUnevenShare = 0.05;  // of the steps

// Masks the wrong way round: what they leave is less than this part of what they take away, in level and in change.
constexpr double kInvertedShare = 0.35;
constexpr double kMinTakenShare = 0.2;  // of the pixels: less is a tool or an overlay, not the surroundings of a view

// Masks that leave less than this part of the view, whose pixels are not darker than a part of its bright ones.
constexpr double kMinLeftShare = 0.25;
constexpr double kBrightQuantile = 0.95;
constexpr double kDarkShare = 0.15;

constexpr std::size_t kMaxSamples = 128;  // for overlays and masks, spread over all images

std::string ShareText(int part, int all, const char* what) {
  return std::to_string(part) + " of " + std::to_string(all) + " " + what + " (" +
         FormatNumber("%.0f", 100.0 * part / all) + " %)";
}

// How two images differ, gray levels.
struct Change {
  double mean = 0;
  double median = 0;
  double level = 0;   // mean of the darker image
  int frame_idx = 0;  // of the later image
  void Serialize(StateArchive& archive) { archive.Members<4>(*this); }
};

Change ChangeBetween(const cv::Mat& a, const cv::Mat& b, int frame_idx) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  std::array<std::size_t, 256> counts{};
  for (int y = 0; y < difference.rows; ++y)
    for (int x = 0; x < difference.cols; ++x) ++counts[difference.at<std::uint8_t>(y, x)];
  std::size_t below = 0;
  std::size_t median = 0;
  while (below + counts[median] <= difference.total() / 2) below += counts[median++];
  return {cv::mean(difference)[0], static_cast<double>(median), std::min(cv::mean(a)[0], cv::mean(b)[0]), frame_idx};
}

// Mean levels and changes of the two sides of masks, summed over samples.
struct MaskSide {
  double pixels = 0;
  double level = 0;
  double change = 0;
  void Serialize(StateArchive& archive) { archive.Members<3>(*this); }
};

void AddSide(const GridSample& before, const GridSample& sample, int of_value, MaskSide* side) {
  cv::Mat where = (sample.valid != 0) == of_value;
  if (before.valid.size() == where.size()) where &= (before.valid != 0) == of_value;
  cv::Mat difference;
  cv::absdiff(before.gray, sample.gray, difference);
  const int pixels = cv::countNonZero(where);
  side->pixels += pixels;
  side->level += pixels * cv::mean(sample.gray, where)[0];
  side->change += pixels * cv::mean(difference, where)[0];
}

// Without images in which the light is off: they say nothing of the others.
std::vector<Change> LitChanges(const std::vector<Change>& changes) {
  std::vector<double> levels;
  for (const Change& change : changes) levels.push_back(change.level);
  const double least = kLightOffShare * Median(std::move(levels));
  std::vector<Change> lit;
  for (const Change& change : changes)
    if (change.level > least) lit.push_back(change);
  return lit;
}

// Images in a row that show what the one before shows.
struct RepeatedRow {
  int first_frame_idx = 0;
  int last_frame_idx = 0;
  int images = 0;
};

std::vector<RepeatedRow> RepeatedRows(const std::vector<Change>& changes) {
  const int pairs = static_cast<int>(changes.size());
  std::vector<RepeatedRow> rows;
  bool follows = false;
  for (int k = 0; k < pairs; ++k) {
    std::vector<double> means;
    std::vector<double> medians;
    for (int j = std::max(0, k - kNeighbors); j < std::min(pairs, k + kNeighbors + 1); ++j) {
      means.push_back(changes[static_cast<std::size_t>(j)].mean);
      medians.push_back(changes[static_cast<std::size_t>(j)].median);
    }
    const Change& change = changes[static_cast<std::size_t>(k)];
    const bool is_repeated = change.mean <= kRepeatedShare * Quantile(std::move(means), kNeighborQuantile) &&
                             change.median <= kRepeatedShare * Quantile(std::move(medians), kNeighborQuantile);
    if (is_repeated && !follows) rows.push_back({change.frame_idx, change.frame_idx, 0});
    follows = is_repeated;
    if (!is_repeated) continue;
    rows.back().last_frame_idx = change.frame_idx;
    ++rows.back().images;
  }
  return rows;
}

// A slide, or a recording that stood still.
void JudgeStill(const std::vector<RepeatedRow>& rows, ImageCheck* check) {
  const auto longest = std::ranges::max_element(rows, {}, &RepeatedRow::images);
  if (longest == rows.end() || longest->images <= kMaxConvertedRow) return;
  check->wrong.push_back("the image stands still from frame " + std::to_string(longest->first_frame_idx - 1) + " to " +
                         std::to_string(longest->last_frame_idx) +
                         ", as a slide or a recording that froze does, and nothing is tracked across it; give a part "
                         "without it (--start, --end)");
}

void JudgeRepeated(const std::vector<Change>& changes, ImageCheck* check) {
  const std::vector<RepeatedRow> rows = RepeatedRows(changes);
  JudgeStill(rows, check);
  int images = static_cast<int>(changes.size()) + 1;
  int repeated = 0;
  int most_in_a_row = 0;
  for (const RepeatedRow& row : rows) {
    check->repeated += row.images;
    if (row.images > kMaxConvertedRow) {
      images -= row.images;
    } else {
      repeated += row.images;
      most_in_a_row = std::max(most_in_a_row, row.images);
    }
  }
  if (repeated < kMinRepeated || repeated < kMinRepeatedShare * images) return;
  const double share = static_cast<double>(repeated) / images;
  const int period = static_cast<int>(std::lround(1 / std::max(1 - share, 0.01)));
  const bool every_nth = period >= 2 && most_in_a_row < period && std::abs(share - (1 - 1.0 / period)) < 0.03;
  check->wrong.push_back(
      ShareText(repeated, images, "images") +
      " repeat the one before: the video was converted to a higher rate, or images were lost in recording, and points "
      "seem to stop and then jump; " +
      (every_nth ? "give --stride " + std::to_string(period) + ", or convert the original at its own rate"
                 : "leave them out (mkdir -p images && ffmpeg -i VIDEO -vf mpdecimate -fps_mode passthrough "
                   "images/%06d.png), or convert "
                   "the original at its own rate; a --stride may help"));
}

void JudgeTimes(const std::vector<double>& steps_s, ImageCheck* check) {
  check->steps = static_cast<int>(steps_s.size());
  if (steps_s.empty()) return;
  const double median_s = Median(steps_s);
  check->median_step_s = median_s;
  check->longest_step_s = *std::max_element(steps_s.begin(), steps_s.end());
  check->uneven_steps = static_cast<int>(std::count_if(steps_s.begin(), steps_s.end(), [&](double step_s) {
    return step_s > kUnevenFactor * median_s || kUnevenFactor * step_s < median_s;
  }));
  if (check->uneven_steps < kMinUneven || check->uneven_steps < kMinUnevenShare * check->steps) return;
  check->wrong.push_back(ShareText(check->uneven_steps, check->steps, "steps between time stamps") +
                         " differ from the median one of " + FormatNumber("%.3g", 1000 * median_s) +
                         " ms by more than half, the longest is " + FormatNumber("%.3g", 1000 * check->longest_step_s) +
                         " ms: the frame rate varies, points jump where images are missing, and the times of a video "
                         "are counted at one rate; record at a constant rate, or give a part without gaps (--start, "
                         "--end), or a sequence with times.txt");
}

void JudgeDamaged(ImageCheck* check) {
  if (check->damaged <= 0) return;
  check->wrong.push_back(ShareText(check->damaged, check->damaged + check->images, "frames") +
                         " are damaged and left out, where points jump; copy the recording again, or convert it anew");
}

void JudgeMasks(const MaskSide& left, const MaskSide& taken, ImageCheck* check) {
  if (left.pixels == 0 || taken.pixels == 0 || taken.pixels < kMinTakenShare * (left.pixels + taken.pixels)) return;
  check->has_masks = true;
  check->left_level = left.level / left.pixels;
  check->taken_level = taken.level / taken.pixels;
  check->masks_are_inverted = check->left_level < kInvertedShare * check->taken_level &&
                              left.change / left.pixels < kInvertedShare * taken.change / taken.pixels;
  if (!check->masks_are_inverted) return;
  check->wrong.push_back("the masks seem to be the wrong way round: what they leave is dark (gray level " +
                         FormatNumber("%.0f", check->left_level) +
                         " on average) and hardly changes, and what they take away "
                         "is lit (" +
                         FormatNumber("%.0f", check->taken_level) +
                         ") and does; in a mask 0 is what is ignored, so invert them");
}

// Where any of the images is lit, 255; everywhere if none is. The rest is the dark surroundings of a round view.
cv::Mat LitView(const std::vector<GridSample>& samples) {
  cv::Mat brightest = samples.front().gray.clone();
  for (const GridSample& sample : samples) brightest = cv::max(brightest, sample.gray);
  std::vector<double> levels;
  for (int y = 0; y < brightest.rows; ++y)
    for (int x = 0; x < brightest.cols; ++x) levels.push_back(brightest.at<std::uint8_t>(y, x));
  return brightest >= kDarkShare * Quantile(std::move(levels), kBrightQuantile);
}

void JudgeLeft(const std::vector<GridSample>& samples, ImageCheck* check) {
  if (samples.empty()) return;
  const cv::Mat view = LitView(samples);
  const double all = static_cast<double>(samples.size()) * cv::countNonZero(view);
  double left = 0;
  bool has_masks = false;
  for (const GridSample& sample : samples) {
    has_masks = has_masks || !sample.valid.empty();
    left += cv::countNonZero(sample.valid.empty() ? view : cv::Mat(view & (sample.valid != 0)));
  }
  if (!has_masks || all == 0) return;
  check->left_share = left / all;
  if (check->masks_are_inverted || *check->left_share >= kMinLeftShare) return;
  check->has_masks = true;
  check->wrong.push_back("the masks leave " + FormatNumber("%.0f", 100 * *check->left_share) +
                         " % of the image: are they the wrong way round? in a mask 0 is what is ignored, and all else "
                         "is used; invert masks in which tools are white");
}

void JudgeOverlay(ImageCheck* check) {
  if (!check->overlay) return;
  const PixelRectangle& found = *check->overlay;
  const auto number = [](int value) { return std::to_string(value); };
  check->wrong.push_back("sharp edges in the " + number(found.width) + "x" + number(found.height) + " pixels from (" +
                         number(found.x) + ", " + number(found.y) +
                         ") on never change while the rest of the image does: text or a logo that is burned in, and "
                         "points on it stand still; mask it out with --mask_path");
}

}  // namespace

struct ImageChecker::State {
  int step = 1;  // of the grid
  int images = 0;
  cv::Mat last;  // on the grid
  std::vector<Change> changes;
  std::optional<double> last_time_s;
  std::vector<double> steps_s;
  int first_idx = 0;
  int last_idx = 0;
  int step_idx = 0;  // the smallest; 0: there is one image
  std::vector<GridSample> samples;
  int sample_every = 1;
  MaskSide left;
  MaskSide taken;

  void AddTime(const std::optional<double>& time_s) {
    // A decoder may not know the time of the last images.
    if (time_s && last_time_s && *time_s > *last_time_s) steps_s.push_back(*time_s - *last_time_s);
    last_time_s = time_s;
  }

  void AddSample(const cv::Mat& gray, const cv::Mat& mask) {
    GridSample sample = SampleGrid(gray, mask, step);
    if (!samples.empty() && !sample.valid.empty()) {
      AddSide(samples.back(), sample, 255, &left);
      AddSide(samples.back(), sample, 0, &taken);
    }
    samples.push_back(std::move(sample));
    if (samples.size() < kMaxSamples) return;
    std::size_t kept = 0;  // every second one; as many may follow
    for (std::size_t k = 0; k < samples.size(); k += 2) std::swap(samples[kept++], samples[k]);
    samples.resize(kept);
    sample_every *= 2;
  }
};

ImageChecker::ImageChecker() : state_(std::make_unique<State>()) {}
ImageChecker::ImageChecker(ImageChecker&&) noexcept = default;
ImageChecker& ImageChecker::operator=(ImageChecker&&) noexcept = default;
ImageChecker::~ImageChecker() = default;

void ImageChecker::Add(const SequenceFrame& frame) {
  State& state = *state_;
  const cv::Mat gray = ToGray(frame.image);
  if (state.images == 0) state.step = std::max(1, gray.cols / kGridColumns);
  cv::Mat grid = GridOf(gray, state.step);
  if (state.images > 0) state.changes.push_back(ChangeBetween(state.last, grid, frame.frame_idx));
  state.last = std::move(grid);
  state.AddTime(frame.recorded_s);
  if (state.images % state.sample_every == 0) state.AddSample(gray, frame.mask);
  if (state.images == 0) state.first_idx = frame.frame_idx;
  if (const int step = frame.frame_idx - state.last_idx; state.images > 0)
    state.step_idx = state.step_idx == 0 ? step : std::min(state.step_idx, step);
  state.last_idx = frame.frame_idx;
  ++state.images;
}

void ImageChecker::Serialize(StateArchive& archive) { archive.Members<13>(*state_); }

ImageCheck ImageChecker::Check() const {
  ImageCheck check;
  check.images = state_->images;
  JudgeRepeated(LitChanges(state_->changes), &check);
  JudgeTimes(state_->steps_s, &check);
  if (state_->step_idx > 0)
    check.damaged = (state_->last_idx - state_->first_idx) / state_->step_idx + 1 - state_->images;
  JudgeDamaged(&check);
  JudgeMasks(state_->left, state_->taken, &check);
  JudgeLeft(state_->samples, &check);
  if (check.masks_are_inverted) return check;  // what they leave says nothing
  const OverlaySearch search = FindOverlay(state_->samples, state_->step);
  check.tells_overlays = search.tells;
  check.overlay = search.found;
  JudgeOverlay(&check);
  return check;
}

Result<std::optional<SequenceFrame>> CheckedSequence::Next() {
  auto frame = source_.Next();
  failed_ = failed_ || !frame.ok();
  if (!failed_ && frame->has_value()) checker_.Add(**frame);
  return frame;
}

}  // namespace pliant
