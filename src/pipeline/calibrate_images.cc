// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/calibrate_images.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>

#include "datasets/image_file.h"
#include "datasets/image_stream.h"
#include "pliant/base/parallel.h"
#include "pliant/base/text.h"
#include "pliant/calibration/choose_views.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/image/pyramid.h"
#include "pliant/image/sharpness.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr int kImagesForSize = 9;      // in which larger chessboards are looked for
constexpr int kFewestCorners = 4 * 5;  // of one that is named: smaller ones are seen in tissue, too

struct Candidate {
  std::string name;
  cv::Mat gray;
  double sharpness = 0;
};

// The sharpest image of every stretch of a stream, of whatever length: stretches become longer as there are more.
class SharpestImages {
 public:
  // `expected`: images of the stream, where that is known; 0: not.
  SharpestImages(int max_images, int expected)
      : max_images_(static_cast<std::size_t>(max_images)),
        stretch_(std::max(1, (expected + max_images - 1) / max_images)) {}

  void Add(Candidate candidate) {
    if (in_last_ == 0 || in_last_ == stretch_) {
      if (candidates_.size() == 2 * max_images_) Halve();
      candidates_.push_back(std::move(candidate));
      in_last_ = 1;
      return;
    }
    ++in_last_;
    if (candidate.sharpness > candidates_.back().sharpness) candidates_.back() = std::move(candidate);
  }

  // At most as many as were asked for.
  std::vector<Candidate> Take() {
    if (candidates_.size() > max_images_) Halve();
    return std::move(candidates_);
  }

 private:
  void Halve() {
    std::vector<Candidate> half;
    for (std::size_t i = 0; i < candidates_.size(); i += 2) {
      const bool second = i + 1 < candidates_.size() && candidates_[i + 1].sharpness > candidates_[i].sharpness;
      half.push_back(std::move(candidates_[second ? i + 1 : i]));
    }
    candidates_ = std::move(half);
    stretch_ *= 2;
    in_last_ = stretch_;
  }

  std::size_t max_images_;
  std::vector<Candidate> candidates_;
  int stretch_;
  int in_last_ = 0;  // images that the last candidate stands for
};

struct ReadImages {
  std::vector<Candidate> candidates;
  int count = 0;
  std::optional<double> fps;
};

Result<std::unique_ptr<ImageStream>> OpenStream(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    if (!fs::exists(path, error))
      return Status(ErrorCode::kNotFound, "there is nothing at " + Quoted(path.string()) +
                                              "; give a folder of images, or a video, of the board");
    return StreamVideo(path);
  }
  const fs::path images = path / native::kImageFolder;
  return StreamFolder(fs::is_directory(images, error) ? images : path);
}

Result<ReadImages> ReadAll(const fs::path& path, int max_images, const CalibrateProgress& progress) {
  auto stream = OpenStream(path);
  if (!stream.ok()) return stream.status();
  SharpestImages sharpest(max_images, (*stream)->count());
  ReadImages read;
  read.fps = (*stream)->fps();
  std::optional<cv::Size> size;
  std::string first_title;
  while (true) {
    if ((*stream)->count_is_exact() && read.count == (*stream)->count()) break;
    auto image = (*stream)->Read(read.count);
    if (!image.ok()) return image.status();
    if (!*image) break;
    if (!size) {
      size = (*image)->size();
      first_title = (*stream)->Title(read.count);
    } else if ((*image)->size() != *size) {
      return Status(ErrorCode::kMismatch, (*stream)->Title(read.count) + " is " + SizeText(**image) + " and " +
                                              first_title + " is " + SizeText(size->width, size->height) +
                                              "; calibrate with images of one size");
    }
    Candidate candidate{(*stream)->Name(read.count), ToGray(**image)};
    candidate.sharpness = Sharpness(candidate.gray, {});
    sharpest.Add(std::move(candidate));
    ++read.count;
    if (!progress(0, 0)) return Status(ErrorCode::kInterrupted, "the calibration was stopped");
  }
  read.candidates = sharpest.Take();
  if (read.candidates.empty())
    return Status(ErrorCode::kUnreadable, Quoted(path.string()) + " has no image; give images of the board");
  return read;
}

// Whether `larger` is a chessboard of which one of `board`'s size is a part.
bool IsPart(const CalibrationBoard& board, const ChessboardSize& larger) {
  const ChessboardSize own{std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
  return larger != own && larger.longer >= own.longer && larger.shorter >= own.shorter;
}

std::string SizeName(const ChessboardSize& size) {
  return std::to_string(size.longer) + "x" + std::to_string(size.shorter);
}

// The size of chessboard that is seen most often in some of the images.
struct SeenSize {
  ChessboardSize size;
  int images = 0;
  int looked_at = 0;
};

SeenSize MostSeenSize(const std::vector<const Candidate*>& candidates, int threads) {
  const int count = std::min(kImagesForSize, static_cast<int>(candidates.size()));
  std::vector<std::optional<ChessboardSize>> sizes(static_cast<std::size_t>(count));
  ParallelFor(
      count, threads,
      [&](int i) {
        const std::size_t at = static_cast<std::size_t>(i) * candidates.size() / static_cast<std::size_t>(count);
        sizes[static_cast<std::size_t>(i)] = LargestChessboard(candidates[at]->gray);
      },
      1);
  std::map<std::pair<int, int>, int> images;
  for (const auto& size : sizes)
    if (size) ++images[{size->longer, size->shorter}];
  SeenSize seen;
  seen.looked_at = count;
  for (const auto& [size, number] : images)
    if (number >= seen.images) seen = {{size.first, size.second}, number, count};
  return seen;
}

std::string SeenSentence(const SeenSize& seen, const CalibrationBoard& board) {
  return "a chessboard of " + SizeName(seen.size) + " inner corners is seen in " + std::to_string(seen.images) +
         " of the " + std::to_string(seen.looked_at) + " images that were looked at; if it is yours, give --board " +
         "chessboard:" + SizeName(seen.size) + ":" + FormatDouble(board.spacing_mm);
}

// Why the board is in none of the images.
Status NotSeen(const CalibrateRequest& request, const std::vector<Candidate>& candidates, int threads) {
  std::string sentence = "the " + request.board.Title() + " is in none of the " + std::to_string(candidates.size()) +
                         " images of " + request.image_path.string() + " that were searched; ";
  std::vector<const Candidate*> all;
  for (const Candidate& candidate : candidates) all.push_back(&candidate);
  if (request.board.kind == BoardKind::kChessboard) {
    const SeenSize seen = MostSeenSize(all, threads);
    if (2 * seen.images > seen.looked_at && seen.size.longer * seen.size.shorter >= kFewestCorners)
      return {ErrorCode::kInsufficient, sentence + SeenSentence(seen, request.board)};
  }
  if (std::any_of(all.begin(), all.end(),
                  [&](const Candidate* candidate) { return IsMirrored(candidate->gray, request.board); }))
    return {ErrorCode::kInsufficient, sentence + "it is in their mirror images: flip them first"};
  return {ErrorCode::kInsufficient,
          sentence + "check its kind and size, and that all of it is in view, sharp and evenly lit"};
}

// A part of a larger chessboard looks like a whole one, but another part in every image.
Status CheckSize(const CalibrateRequest& request, const std::vector<const Candidate*>& with_board, int threads) {
  if (request.board.kind != BoardKind::kChessboard) return Status::Ok();
  const SeenSize seen = MostSeenSize(with_board, threads);
  if (2 * seen.images <= seen.looked_at || !IsPart(request.board, seen.size)) return Status::Ok();
  return {ErrorCode::kInsufficient,
          "the " + request.board.Title() + " is a part of what the images show: " + SeenSentence(seen, request.board)};
}

struct Detections {
  std::vector<std::optional<BoardView>> of_candidate;
  bool stopped = false;
};

Detections FindBoards(const std::vector<Candidate>& candidates, const CalibrationBoard& board, int threads,
                      const CalibrateProgress& progress) {
  Detections found;
  found.of_candidate.resize(candidates.size());
  std::mutex mutex;
  int done = 0;
  ParallelFor(
      static_cast<int>(candidates.size()), threads,
      [&](int i) {
        const auto idx = static_cast<std::size_t>(i);
        {
          const std::scoped_lock lock(mutex);
          if (found.stopped) return;
        }
        found.of_candidate[idx] = FindBoard(candidates[idx].gray, board);
        const std::scoped_lock lock(mutex);
        ++done;
        if (!progress(done, static_cast<int>(candidates.size()))) found.stopped = true;
      },
      1);
  return found;
}

}  // namespace

void CalibrateOptions::List(OptionTable& table) {
  table.BeginGroup("Calibrate", "how a camera is calibrated with a board");
  table.AddChoice("model", &model, "camera model; auto: by the error of images that are held out");
  table.Add("max_images", &max_images, "images", "searched for the board: the sharpest of as many stretches", 3, 10000);
  table.Add("max_views", &max_views, "images", "with the board that are used: the most different ones", 3, 1000);
  table.Add("threads", &threads, "-", "images searched, and models fitted, at the same time; never changes the result",
            1, 256);
}

Result<CalibrateSummary> CalibrateImages(const CalibrateRequest& request, const CalibrateOptions& options,
                                         const CalibrateProgress& progress) {
  if (Status status = CheckBoardIsSupported(request.board); !status.ok()) return status;
  auto read = ReadAll(request.image_path, options.max_images, progress);
  if (!read.ok()) return read.status();
  const std::vector<Candidate>& candidates = read->candidates;
  const Detections found = FindBoards(candidates, request.board, options.threads, progress);
  if (found.stopped) return Status(ErrorCode::kInterrupted, "the calibration was stopped");

  std::vector<BoardView> seen;
  std::vector<std::size_t> candidate_of_seen;
  std::vector<const Candidate*> with_board;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!found.of_candidate[i]) continue;
    seen.push_back(*found.of_candidate[i]);
    candidate_of_seen.push_back(i);
    with_board.push_back(&candidates[i]);
  }
  if (seen.empty()) return NotSeen(request, candidates, options.threads);
  if (Status status = CheckSize(request, with_board, options.threads); !status.ok()) return status;

  const cv::Size size = candidates.front().gray.size();
  const std::vector<int> chosen = ChooseVariedViews(request.board, seen, size.width, size.height, options.max_views);
  std::vector<BoardView> views;
  for (const int view : chosen) views.push_back(seen[static_cast<std::size_t>(view)]);
  auto calibration = CalibrateCamera(request.board, views, size.width, size.height, options.model, options.threads);
  if (!calibration.ok())
    return Status(calibration.status().code(), request.image_path.string() + ": " + calibration.status().message());

  CalibrateSummary summary{.calibration = *std::move(calibration)};
  summary.images_read = read->count;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    summary.images.push_back({candidates[i].name, found.of_candidate[i] ? ImageUse::kAlike : ImageUse::kNoBoard});
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    CalibrationImage& image = summary.images[candidate_of_seen[static_cast<std::size_t>(chosen[i])]];
    image.use = summary.calibration.views[i].is_outlier ? ImageUse::kOutlier : ImageUse::kUsed;
    image.view_idx = static_cast<int>(i);
  }
  summary.views = std::move(views);
  summary.covered_share = CoveredShare(summary.views, summary.calibration);
  summary.advice = CalibrationAdvice(summary.views, summary.calibration);
  if (!request.output_path.empty()) {
    CameraFile file{summary.calibration.camera};
    file.fps = read->fps;
    if (Status status = WriteCameraFile(request.output_path.string(), file); !status.ok()) return status;
  }
  return summary;
}

}  // namespace pliant
