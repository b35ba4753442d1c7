// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/board_search.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pipeline/board_images.h"
#include "pliant/base/parallel.h"

namespace pliant {
namespace {

// The sharpest image of every stretch of a stream, of whatever length: stretches become longer as there are more.
// Images are searched when their stretch has ended, as many at a time as there are threads.
class SharpestImages {
 public:
  // `expected`: images of the stream, where that is known; 0: not.
  SharpestImages(const CalibrationBoard& board, const CalibrateOptions& options, int expected)
      : board_(board),
        threads_(options.threads),
        max_images_(static_cast<std::size_t>(options.max_images)),
        stretch_(std::max(1, (expected + options.max_images - 1) / options.max_images)),
        expected_((expected + stretch_ - 1) / stretch_) {}

  void Add(BoardImage image) {
    if (in_last_ != 0 && in_last_ != stretch_) {
      ++in_last_;
      if (image.sharpness > last_->sharpness) last_ = std::move(image);
      return;
    }
    EndStretch();
    if (images_.size() + waiting_.size() == 2 * max_images_) Halve();
    last_ = std::move(image);
    in_last_ = 1;
  }

  // At most as many as were asked for.
  std::vector<SearchedImage> Take() {
    EndStretch();
    SearchWaiting();
    if (images_.size() > max_images_) Halve();
    return std::move(images_);
  }

  int searched() const { return static_cast<int>(images_.size()); }
  int expected() const { return std::max(expected_, searched()); }

 private:
  void EndStretch() {
    if (last_) waiting_.push_back(*std::exchange(last_, std::nullopt));
    if (waiting_.size() >= static_cast<std::size_t>(threads_)) SearchWaiting();
  }

  void SearchWaiting() {
    const std::size_t before = images_.size();
    images_.resize(before + waiting_.size());
    ParallelFor(
        static_cast<int>(waiting_.size()), threads_,
        [&](int i) { images_[before + static_cast<std::size_t>(i)] = Search(waiting_[static_cast<std::size_t>(i)]); },
        1);
    waiting_.clear();
  }

  SearchedImage Search(const BoardImage& image) const {
    SearchedImage searched{image.name, image.sharpness, {}, {}};
    for (const cv::Mat& gray : image.gray) {
      searched.found.push_back(FindBoard(gray, board_));
      searched.smaller.push_back(AsSearched(gray));
    }
    return searched;
  }

  void Halve() {
    SearchWaiting();
    std::vector<SearchedImage> half;
    for (std::size_t i = 0; i < images_.size(); i += 2) {
      const bool second = i + 1 < images_.size() && images_[i + 1].sharpness > images_[i].sharpness;
      half.push_back(std::move(images_[second ? i + 1 : i]));
    }
    images_ = std::move(half);
    stretch_ *= 2;
  }

  const CalibrationBoard& board_;
  int threads_;
  std::size_t max_images_;
  int stretch_;
  int expected_;                         // stretches
  std::vector<SearchedImage> images_;    // one of every stretch that was searched
  std::vector<BoardImage> waiting_;      // of the stretches after these
  std::optional<BoardImage> last_ = {};  // the sharpest one so far of the last stretch
  int in_last_ = 0;                      // images that it stands for
};

}  // namespace

Result<BoardRecording> SearchBoards(const CalibrateRequest& request, const CalibrateOptions& options,
                                    const JobProgress& progress) {
  if (Status status = CheckBoardIsSupported(request.board); !status.ok()) return status;
  auto reader = BoardImageReader::Open(request);
  if (!reader.ok()) return reader.status();
  SharpestImages sharpest(request.board, options, reader->expected());
  while (true) {
    auto image = reader->Next();
    if (!image.ok()) return image.status();
    if (!*image) break;
    sharpest.Add(**std::move(image));
    const int expected = reader->expected() > 0 ? sharpest.expected() : 0;
    if (Status status = Tell(progress, "search", sharpest.searched(), expected); !status.ok()) return status;
  }
  BoardRecording recording{sharpest.Take(), reader->sizes(), reader->count(), reader->fps()};
  const auto searched = static_cast<int>(recording.images.size());
  if (Status status = Tell(progress, "search", searched, searched); !status.ok()) return status;
  return recording;
}

}  // namespace pliant
