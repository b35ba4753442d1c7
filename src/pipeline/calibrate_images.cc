// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/calibrate_images.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <map>

#include <unistd.h>

#include "calibration/board_problem.h"
#include "datasets/image_file.h"
#include "pipeline/board_search.h"
#include "pliant/base/files.h"
#include "pliant/base/parallel.h"
#include "pliant/base/text.h"
#include "pliant/calibration/choose_views.h"
#include "pliant/image/masks.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

constexpr std::size_t kImagesForSize = 9;    // in which larger boards are looked for
constexpr std::size_t kImagesForOthers = 5;  // in which boards of other kinds are looked for, one after the other
constexpr int kFewestWithAny = 3;            // that tell a size where few images show the board that was given
constexpr int kFewestCorners = 4 * 5;        // of one that is named: smaller ones are seen in tissue, too

// Whether `larger` is a chessboard of which one of `board`'s size is a part.
bool IsPart(const CalibrationBoard& board, const ChessboardSize& larger) {
  const ChessboardSize own{std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
  return larger != own && larger.longer >= own.longer && larger.shorter >= own.shorter;
}

std::string SizeName(const ChessboardSize& size) {
  return std::to_string(size.longer) + "x" + std::to_string(size.shorter);
}

// At most `most` images that are spread evenly over all of them.
std::vector<cv::Mat> SomeOf(const std::vector<cv::Mat>& images, std::size_t most = kImagesForSize) {
  const auto count = std::min(most, images.size());
  std::vector<cv::Mat> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(images[i * images.size() / count]);
  return some;
}

// How images are looked at once more, where the board may be another one than was said.
struct SecondLook {
  int threads = 1;
  const JobProgress& progress;
};

// What `look` says of each image, `threads` of them at the same time.
template <class Look>
auto InEach(const std::vector<cv::Mat>& images, const SecondLook& how, const Look& look)
    -> Result<std::vector<decltype(look(images.front()))>> {
  const auto count = static_cast<int>(images.size());
  std::vector<decltype(look(images.front()))> answers(images.size());
  for (int begin = 0; begin < count; begin += how.threads) {
    if (Status status = Tell(how.progress, "size", begin, count); !status.ok()) return status;
    ParallelFor(
        std::min(how.threads, count - begin), how.threads,
        [&](int i) {
          const auto idx = static_cast<std::size_t>(begin + i);
          answers[idx] = look(images[idx]);
        },
        1);
  }
  return answers;
}

// The size of chessboard that is seen most often in some of the images.
struct SeenSize {
  ChessboardSize size;
  int images = 0;
  int with_any = 0;  // in which there is a chessboard
  int looked_at = 0;

  bool IsOfMost() const { return 2 * images > with_any && size.longer * size.shorter >= kFewestCorners; }
};

Result<SeenSize> MostSeenSize(const std::vector<cv::Mat>& images, const SecondLook& how) {
  const std::vector<cv::Mat> some = SomeOf(images);
  const auto sizes = InEach(some, how, LargestChessboard);
  if (!sizes.ok()) return sizes.status();
  std::map<std::pair<int, int>, int> images_of_size;
  SeenSize seen;
  seen.looked_at = static_cast<int>(some.size());
  for (const auto& size : *sizes) {
    if (!size) continue;
    ++images_of_size[{size->longer, size->shorter}];
    ++seen.with_any;
  }
  for (const auto& [size, number] : images_of_size)
    if (number >= seen.images) seen = {{size.first, size.second}, number, seen.with_any, seen.looked_at};
  return seen;
}

std::string SeenSentence(const SeenSize& seen, const CalibrationBoard& board) {
  return "a chessboard of " + SizeName(seen.size) + " inner corners is seen in " + std::to_string(seen.images) +
         " of the " + std::to_string(seen.looked_at) + " images that were looked at; if it is yours, give --board " +
         "chessboard:" + SizeName(seen.size) + ":" + FormatDouble(board.spacing_mm);
}

// "the ... is seen in 7 of the 9 images that were looked at; ...": another board than was said, in most of some images.
// Empty where there is none.
Result<std::string> OtherBoard(const std::vector<cv::Mat>& images, const CalibrationBoard& board,
                               const SecondLook& how) {
  if (images.empty()) return std::string();
  const std::vector<cv::Mat> some = SomeOf(images, kImagesForOthers);
  const auto boards = InEach(some, how, [&](const cv::Mat& image) { return SimilarBoard(image, board); });
  if (!boards.ok()) return boards.status();
  std::map<std::string, int> images_of_board;
  for (const auto& seen : *boards) {
    if (!seen) continue;
    const std::string text = seen->Text();
    if (const int number = ++images_of_board[text]; 2 * number > static_cast<int>(some.size()))
      return "the " + seen->Title() + " is seen in most of the " + std::to_string(some.size()) +
             " images that were looked at; if it is yours, give --board " + text;
  }
  return std::string();
}

Result<bool> ShowOtherMarkers(const std::vector<cv::Mat>& images, const CalibrationBoard& board,
                              const SecondLook& how) {
  if (board.kind != BoardKind::kCharuco) return false;
  const auto others =
      InEach(SomeOf(images), how, [&](const cv::Mat& image) { return ShowsOtherMarkers(image, board) ? 1 : 0; });
  if (!others.ok()) return others.status();
  return 2 * std::count(others->begin(), others->end(), 1) > static_cast<std::ptrdiff_t>(others->size());
}

std::string OtherMarkers(const CalibrationBoard& board) {
  return "markers of " + board.dictionary + " are seen, but not those of a board of " +
         std::to_string(board.columns + 1) + "x" + std::to_string(board.rows + 1) +
         " squares, or not in its order: check the numbers of squares along both sides";
}

// Why the board is seen in so few of the images of one camera.
Status NotSeen(const CalibrateRequest& request, const std::string& source, const std::vector<cv::Mat>& images,
               std::size_t seen_in, const SecondLook& how) {
  const CalibrationBoard& board = request.board;
  const std::string where =
      images.size() == 1
          ? " is not in the only image of " + source
          : (seen_in == 0 ? " is in none of the " : " is in only " + std::to_string(seen_in) + " of the ") +
                std::to_string(images.size()) + " images of " + source + " that were searched";
  const std::string sentence = "the " + board.Title() + where + "; ";
  const ChessboardSize own{std::max(board.columns, board.rows), std::min(board.columns, board.rows)};
  if (board.kind == BoardKind::kChessboard) {
    const auto seen = MostSeenSize(images, how);
    if (!seen.ok()) return seen.status();
    if (seen->IsOfMost() && seen->size != own && 2 * seen->images > seen->looked_at)
      return {ErrorCode::kInsufficient, sentence + SeenSentence(*seen, board)};
  }
  const auto other_board = OtherBoard(images, board, how);
  if (!other_board.ok()) return other_board.status();
  if (!other_board->empty()) return {ErrorCode::kInsufficient, sentence + *other_board};
  const auto others = ShowOtherMarkers(images, board, how);
  if (!others.ok()) return others.status();
  if (*others) return {ErrorCode::kInsufficient, sentence + OtherMarkers(board)};
  const auto mirrored = InEach(images, how, [&](const cv::Mat& image) { return IsMirrored(image, board) ? 1 : 0; });
  if (!mirrored.ok()) return mirrored.status();
  if (std::ranges::count(*mirrored, 1) > 0)
    return {ErrorCode::kInsufficient, sentence + "it is in their mirror images: flip them first"};
  return {ErrorCode::kInsufficient, sentence + "check its kind" +
                                        (board.kind == BoardKind::kCharuco ? ", dictionary" : "") +
                                        " and size, and that all of it is in view, sharp and evenly lit"};
}

// A part of a larger board looks like a whole one, but another part in every image. Those in which it is not seen show
// the larger one, too.
Status CheckSize(const CalibrateRequest& request, const std::vector<cv::Mat>& images,
                 const std::vector<cv::Mat>& with_board, const SecondLook& how) {
  const CalibrationBoard& board = request.board;
  const std::string is_part = "the " + board.Title() + " is a part of what the images show: ";
  if (board.kind == BoardKind::kChessboard) {
    const auto of_found = MostSeenSize(with_board, how);
    if (!of_found.ok()) return of_found.status();
    if (of_found->IsOfMost() && 2 * of_found->images > of_found->looked_at && IsPart(board, of_found->size))
      return {ErrorCode::kInsufficient, is_part + SeenSentence(*of_found, board)};
    const auto of_all = MostSeenSize(images, how);
    if (!of_all.ok()) return of_all.status();
    if (of_all->IsOfMost() && of_all->with_any >= kFewestWithAny && IsPart(board, of_all->size))
      return {ErrorCode::kInsufficient, is_part + SeenSentence(*of_all, board)};
    return Status::Ok();
  }
  if (board.kind == BoardKind::kCharuco) {
    const auto others = ShowOtherMarkers(with_board, board, how);
    if (!others.ok()) return others.status();
    if (!*others) return Status::Ok();
    const auto other_board = OtherBoard(with_board, board, how);
    if (!other_board.ok()) return other_board.status();
    return {ErrorCode::kInsufficient, is_part + (other_board->empty() ? OtherMarkers(board) : *other_board)};
  }
  std::map<std::pair<int, int>, int> images_of_size;
  const std::vector<cv::Mat> some = SomeOf(with_board);
  const auto larger_ones = InEach(some, how, [&](const cv::Mat& image) { return LargerCircles(image, board); });
  if (!larger_ones.ok()) return larger_ones.status();
  for (const auto& larger : *larger_ones)
    if (larger) ++images_of_size[{larger->columns, larger->rows}];
  for (const auto& [size, number] : images_of_size)
    if (2 * number > static_cast<int>(some.size()))
      return {ErrorCode::kInsufficient, is_part + std::to_string(size.first) + "x" + std::to_string(size.second) +
                                            " circles are seen in " + std::to_string(number) + " of the " +
                                            std::to_string(some.size()) + " images that were looked at"};
  return Status::Ok();
}

// Without those pixels of the border where all images are dark: an endoscope shows a disc.
void RemoveDark(const std::vector<cv::Mat>& images, const Camera& camera, std::vector<PixelAccuracy>* border) {
  cv::Mat brightest = images.front().clone();
  for (const cv::Mat& image : images) brightest = cv::max(brightest, image);
  const cv::Mat dark = DarkBorderMask(brightest, {});
  const auto scaled = [](double at, int size, int scaled_size) {
    return static_cast<int>(std::lround(at / std::max(1, size - 1) * (scaled_size - 1)));
  };
  std::erase_if(*border, [&](const PixelAccuracy& place) {
    return dark.at<unsigned char>(scaled(place.pixel.y(), camera.height(), dark.rows),
                                  scaled(place.pixel.x(), camera.width(), dark.cols)) != 0;
  });
}

// One camera of the recording, alone. `source` is what messages call its images.
Result<CalibrateSummary> CalibrateOne(const CalibrateRequest& request, const CalibrateOptions& options,
                                      const BoardRecording& recording, std::size_t camera, Lenses lenses,
                                      const std::string& source, const JobProgress& progress) {
  const SecondLook how{options.threads, progress};
  std::vector<BoardView> seen;
  std::vector<std::size_t> image_of_seen;
  std::vector<cv::Mat> all;
  std::vector<cv::Mat> with_board;
  for (std::size_t i = 0; i < recording.images.size(); ++i) {
    const SearchedImage& image = recording.images[i];
    all.push_back(image.smaller[camera]);
    if (!image.found[camera]) continue;
    seen.push_back(*image.found[camera]);
    image_of_seen.push_back(i);
    with_board.push_back(image.smaller[camera]);
  }
  if (seen.size() < kFewestCalibrationViews && 2 * seen.size() <= all.size())
    return NotSeen(request, source, all, seen.size(), how);
  if (Status status = CheckSize(request, all, with_board, how); !status.ok()) return status;

  const cv::Size size = recording.sizes[camera];
  const std::vector<int> chosen = ChooseVariedViews(request.board, seen, size.width, size.height, options.max_views);
  std::vector<BoardView> views;
  for (const int view : chosen) views.push_back(seen[static_cast<std::size_t>(view)]);
  auto calibration =
      CalibrateCamera(request.board, views, size.width, size.height, options.model, options.threads, lenses, progress);
  if (!calibration.ok() && calibration.status().code() == ErrorCode::kInterrupted) return calibration.status();
  if (!calibration.ok()) {
    // Circles of one kind may be taken for those of the other.
    const auto other_board = OtherBoard(with_board, request.board, how);
    if (!other_board.ok()) return other_board.status();
    return Status(calibration.status().code(),
                  source + ": " + (other_board->empty() ? calibration.status().message() : *other_board));
  }

  CalibrateSummary summary{.calibration = *std::move(calibration)};
  summary.images_read = recording.images_read;
  for (const SearchedImage& image : recording.images)
    summary.images.push_back({image.name, image.found[camera] ? ImageUse::kAlike : ImageUse::kNoBoard});
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    CalibrationImage& image = summary.images[image_of_seen[static_cast<std::size_t>(chosen[i])]];
    image.use = summary.calibration.views[i].is_outlier ? ImageUse::kOutlier : ImageUse::kUsed;
    image.view_idx = static_cast<int>(i);
  }
  summary.views = std::move(views);
  RemoveDark(all, summary.calibration.camera, &summary.calibration.border);
  summary.covered_share = CoveredShare(summary.views, summary.calibration);
  summary.advice = CalibrationAdvice(summary.views, summary.calibration);
  return summary;
}

// The most different ones of the moments in which both cameras see all of the board, or the same points of it.
struct BoardPairs {
  std::vector<BoardView> left;
  std::vector<BoardView> right;
};

BoardPairs ChoosePairs(const CalibrateRequest& request, const CalibrateOptions& options,
                       const BoardRecording& recording) {
  BoardPairs both;
  for (const SearchedImage& image : recording.images) {
    if (!image.found[0] || !image.found[1]) continue;
    both.left.push_back(*image.found[0]);
    both.right.push_back(*image.found[1]);
  }
  const cv::Size size = recording.sizes.front();
  BoardPairs chosen;
  for (const int pair : ChooseVariedViews(request.board, both.left, size.width, size.height, options.max_views)) {
    chosen.left.push_back(both.left[static_cast<std::size_t>(pair)]);
    chosen.right.push_back(both.right[static_cast<std::size_t>(pair)]);
  }
  return chosen;
}

// As OpenCV has it: fx, fy, cx, cy and k1, k2, p1, p2.
StereoCalibration::Eye EyeOf(const Camera& camera) {
  auto eye = camera.Visit([](const auto& model) {
    return StereoCalibration::Eye{model.fx(), model.fy(), model.cx(), model.cy(), {0, 0, 0, 0}};
  });
  const std::span<const double> params = camera.params();
  const auto distortion = params.subspan(static_cast<std::size_t>(NumPinholeParams(camera.model_id())));
  std::copy(distortion.begin(), distortion.end(), eye.distortion.begin());
  return eye;
}

}  // namespace

Status CheckCalibrationOutput(const std::filesystem::path& path, ExistingFile existing) {
  std::error_code error;
  if (path.empty() || std::filesystem::is_character_file(path, error) || std::filesystem::is_fifo(path, error))
    return Status::Ok();
  if (std::filesystem::is_directory(path, error))
    return {ErrorCode::kUnwritable, Quoted(path.string()) + " is a folder; name the file to write"};
  if (existing == ExistingFile::kKeep && std::filesystem::exists(path, error))
    return {ErrorCode::kInvalidArgument, Quoted(path.string()) + " is there already; delete it, or give --overwrite"};
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, error))
    return {ErrorCode::kUnwritable, "there is no folder " + Quoted(folder.string()) + "; make it first"};
  errno = 0;
  return access(folder.c_str(), W_OK) == 0 ? Status::Ok() : Unwritable(path);
}

void CalibrateOptions::List(OptionTable& table) {
  table.BeginGroup("Calibrate", "how a camera is calibrated with a board");
  table.AddChoice("model", &model, "camera model; auto: by the error of images that are held out");
  table.Add("max_images", &max_images, "images", "searched for the board: the sharpest of as many stretches", 3, 10000);
  table.Add("max_views", &max_views, "images", "with the board that are used: the most different ones", 3, 1000);
  table.Add("threads", &threads, "-", "images searched, and models fitted, at the same time; never changes the result",
            1, 256);
}

Result<CalibrateSummary> CalibrateImages(const CalibrateRequest& request, const CalibrateOptions& options,
                                         const JobProgress& progress) {
  if (Status status = CheckCalibrationOutput(request.output_path, request.existing); !status.ok()) return status;
  const auto recording = SearchBoards(request, options, progress);
  if (!recording.ok()) return recording.status();
  auto summary =
      CalibrateOne(request, options, *recording, 0, Lenses::kAll, Quoted(request.image_path.string()), progress);
  if (!summary.ok() || request.output_path.empty()) return summary;
  CameraFile file{summary->calibration.camera};
  file.fps = recording->fps;
  if (Status status = WriteCameraFile(request.output_path.string(), file); !status.ok()) return status;
  return summary;
}

Result<CalibratePairsSummary> CalibratePairs(const CalibrateRequest& request, const CalibrateOptions& options,
                                             const JobProgress& progress) {
  if (Status status = CheckCalibrationOutput(request.output_path, request.existing); !status.ok()) return status;
  const auto recording = SearchBoards(request, options, progress);
  if (!recording.ok()) return recording.status();
  if (recording->sizes[0] != recording->sizes[1])
    return Status(ErrorCode::kMismatch,
                  "the left images are " + SizeText(recording->sizes[0].width, recording->sizes[0].height) +
                      " and the right ones " + SizeText(recording->sizes[1].width, recording->sizes[1].height) +
                      "; give both as they were recorded, at one size");
  const bool is_apart = !request.right_path.empty();
  const std::string source = Quoted(request.image_path.string());
  auto left = CalibrateOne(request, options, *recording, 0, Lenses::kPerspective,
                           is_apart ? source : source + " (left)", progress);
  if (!left.ok()) return left.status();
  auto right = CalibrateOne(request, options, *recording, 1, Lenses::kPerspective,
                            is_apart ? Quoted(request.right_path.string()) : source + " (right)", progress);
  if (!right.ok()) return right.status();
  const BoardPairs pairs = ChoosePairs(request, options, *recording);
  auto stereo = CalibrateStereo(request.board, left->calibration.camera, right->calibration.camera, pairs.left,
                                pairs.right, options.threads, progress);
  if (!stereo.ok()) return stereo.status();
  if (!request.output_path.empty()) {
    const StereoCalibration file{EyeOf(stereo->left), EyeOf(stereo->right), stereo->right_from_left,
                                 ImageSize{stereo->left.width(), stereo->left.height()}};
    if (Status status = WriteStereoCalibration(request.output_path.string(), file); !status.ok()) return status;
  }
  return CalibratePairsSummary{*std::move(left), *std::move(right), *std::move(stereo)};
}

}  // namespace pliant
