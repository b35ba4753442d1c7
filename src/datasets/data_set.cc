// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/data_set.h"

#include <algorithm>
#include <limits>
#include <string>

#include <opencv2/imgproc.hpp>

#include "datasets/depth_prior_file.h"
#include "datasets/image_file.h"
#include "datasets/image_list.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Of the frames that are read, how many have none where others have one; `has` says it of a frame.
template <class Has>
void WarnOfMissing(const std::string& what, const FrameRange& range, const DataSet& data_set, const Has& has,
                   std::vector<std::string>* warnings) {
  int missing = 0;
  int first = -1;
  for (int idx = range.start; idx < range.end; idx += range.stride) {
    if (has(static_cast<std::size_t>(idx))) continue;
    if (missing++ == 0) first = idx;
  }
  if (missing > 0)
    warnings->push_back(std::to_string(missing) + " of " + std::to_string(range.Count()) + " images have no " + what +
                        ", the first is " + data_set.images->Name(first) + " (frame " + std::to_string(first) + ")");
}

// Data of 10, 12 or 14 bits in images of 16 bits that were not scaled look black. `range` is that of known images.
void WarnOfUnscaledValues(const FrameRange& range, const ImageStream& images, std::vector<std::string>* warnings) {
  constexpr int kLeast = 1 << 14;
  constexpr int kCompared = 3;  // images: one may be dark
  int largest = 0;
  for (int k = 0; k < kCompared && range.Count() > 0; ++k) {
    const int position = (range.Count() - 1) * k / (kCompared - 1);
    const auto value = images.Largest16BitValue(range.start + position * range.stride);
    if (!value || *value >= kLeast) return;
    largest = std::max(largest, *value);
  }
  if (largest == 0) return;
  int full = 255;  // of as many bits as are used
  while (full < largest) full = 2 * full + 1;
  warnings->push_back("the 16-bit images in " + images.path().string() + " use only values up to " +
                      std::to_string(largest) + " of 65535, and are dark: if " + std::to_string(full) +
                      " is full scale, scale them by " + std::to_string(65535 / full) + ", or write 8-bit images");
}

// What the range is of these images: of a video by its container's word.
FrameRange ByItsWord(const FrameRange& range, const ImageStream& images) {
  if (images.count() == 0) return range;
  const auto known = range.Within(images.count(), images.path());
  return known.ok() ? *known : FrameRange{range.start, range.start, range.stride};
}

Status CheckStoredSizes(const ImageStream& images, const FrameRange& range) {
  std::optional<std::pair<int, cv::Size>> first;
  for (int idx = range.start; idx < range.end; idx += range.stride) {
    const auto stored = images.StoredSize(idx);
    if (!stored.ok()) return stored.status();
    if (!stored->has_value()) continue;
    const cv::Size size = **stored;
    if (!first) first = {idx, size};
    if (size != first->second)
      return {ErrorCode::kMismatch, images.Title(idx) + " is " + SizeText(size.width, size.height) + ", but " +
                                        images.Name(first->first) + " is " +
                                        SizeText(first->second.width, first->second.height) +
                                        "; the size may not change within a sequence"};
  }
  return Status::Ok();
}

class DataSetSequence final : public Sequence {
 public:
  DataSetSequence(DataSet data_set, const FrameRange& range)
      : data_set_(std::move(data_set)), range_(range), next_idx_(range.start) {}

  Status CheckFirstImage() const;
  Status CheckMasks(const CompanionImages& masks) const;
  Status OpenMasks();
  Status CheckFirstDepthPrior();
  Status OpenDepthPriors(const std::filesystem::path& folder);

  const Camera& camera() const override { return data_set_.calibration.camera; }
  int size() const override { return KnownRange().Count(); }
  Result<std::optional<SequenceFrame>> Next() override;
  Status CheckFiles() const override;
  std::optional<PhotometricCalibration> Photometric() const override { return data_set_.calibration.photometric; }
  std::optional<double> BaselineMm() const override;
  std::optional<double> Fps() const override { return data_set_.calibration.fps; }
  Result<std::optional<cv::Mat>> Right() override;
  Result<std::optional<cv::Mat>> Depth(int frame_idx) const override;
  std::optional<Rigid3> WorldFromCamera(int frame_idx) const override;
  std::optional<double> TimestampS(int frame_idx) const override;
  std::optional<std::string> Name(int frame_idx) const override;
  std::vector<std::string> Warnings() const override { return data_set_.warnings; }

 private:
  ImageStream& images() const { return *data_set_.images; }
  FrameRange KnownRange() const { return ByItsWord(range_, images()); }
  CompanionImages::Counts Counts() const {
    return images().count_is_exact() ? CompanionImages::Counts::kMustAgree : CompanionImages::Counts::kMayDiffer;
  }
  Status CheckSize(const cv::Mat& image, const std::string& title) const;
  double TimeOf(int idx) const;
  // Masks are drawn on the images as they are, before they are rectified.
  cv::Size MaskSize() const {
    return data_set_.warp ? data_set_.warp->raw : cv::Size(camera().width(), camera().height());
  }
  Result<cv::Mat> Mask(int idx, const std::string& name) const;
  Result<cv::Mat> RawMask(int idx) const;
  fs::path DepthPriorFile(int idx) const;
  Result<cv::Mat> DepthPrior(int idx) const;

  DataSet data_set_;
  FrameRange range_;
  int next_idx_;
  int last_idx_ = -1;  // the frame that Next gave last
  std::optional<CompanionImages> masks_;
  std::optional<CompanionImages> depth_priors_;
};

// A calibration of other images is the commonest mistake: it is told before anything runs. A first image that cannot
// be decoded is Next's to report.
Status DataSetSequence::CheckFirstImage() const {
  const std::optional<cv::Size> size = images().SizeAt(range_.start);
  if (!size || *size == cv::Size(camera().width(), camera().height())) return Status::Ok();
  const bool turned = size->width == camera().height() && size->height == camera().width();
  const std::string turn = images().count_is_exact() ? "; the EXIF orientation of images is ignored"
                                                     : "; the rotation in the metadata of a video is applied";
  const bool twice = (size->width == 2 * camera().width()) != (size->height == 2 * camera().height());
  return {ErrorCode::kMismatch,
          "the calibration " + data_set_.calibration.path.string() + " is for images of " +
              SizeText(camera().width(), camera().height()) + ", but " + images().Title(range_.start) + " is " +
              SizeText(size->width, size->height) + "; give the calibration of these images" +
              (twice ? ", or of both cameras where an image holds a pair" : "") + (turned ? turn : "")};
}

// A video may end before its container says so: there only a gap before a frame that has a mask is one for certain.
Status DataSetSequence::CheckMasks(const CompanionImages& masks) const {
  const bool exact = images().count_is_exact();
  const FrameRange range = KnownRange();
  Status missing = Status::Ok();
  for (int idx = range.start; idx < range.end; idx += range.stride) {
    const auto found = masks.Require(idx, images().Name(idx));
    if (!found.ok() && exact) return found.status();
    if (found.ok() && !missing.ok()) return missing;
    if (!found.ok() && missing.ok()) missing = found.status();
  }
  return Status::Ok();
}

Status DataSetSequence::OpenMasks() {
  if (data_set_.mask_path.empty()) return Status::Ok();
  Result<CompanionImages> masks = CompanionImages::Open("mask", data_set_.mask_path, Stems(images()), Counts());
  if (!masks.ok()) return masks.status();
  if (Status status = CheckMasks(*masks); !status.ok()) return status;
  masks_ = *std::move(masks);
  return Status::Ok();
}

// Images may be without one.
Status DataSetSequence::OpenDepthPriors(const fs::path& folder) {
  if (folder.empty()) return Status::Ok();
  if (data_set_.warp)
    return {ErrorCode::kMismatch,
            "the images of this sequence are rectified as they are read, and the depth priors in " + folder.string() +
                " are not; write the rectified images with pliant dataset convert, and make the priors of them"};
  std::error_code error;
  if (!fs::is_directory(folder, error) && fs::exists(folder, error))
    return {ErrorCode::kMismatch, folder.string() + " is one file; depth priors are a folder with a file an image"};
  Result<CompanionImages> priors =
      CompanionImages::Open("depth prior", folder, Stems(images()), Counts(), CompanionKind::kDepthPriors);
  if (!priors.ok()) return priors.status();
  depth_priors_ = *std::move(priors);
  if (!images().count_is_exact() && !depth_priors_->by_name())
    return {ErrorCode::kMismatch, "how many images there are is not known before the last, so the depth priors in " +
                                      folder.string() + " belong to them by name; name the first one like its image, " +
                                      images().Name(0)};
  if (!images().count_is_exact() && DepthPriorFile(0).empty() && !DepthPriorFile(1).empty())
    data_set_.warnings.push_back("the depth priors in " + folder.string() +
                                 " begin with number 1, and the first image is " + images().Name(0) +
                                 ": if the first prior is that image's, all come one image late");
  if (images().count_is_exact())
    WarnOfMissing(
        "depth prior", KnownRange(), data_set_,
        [&](std::size_t idx) { return !DepthPriorFile(static_cast<int>(idx)).empty(); }, &data_set_.warnings);
  return CheckFirstDepthPrior();
}

// A network that was given the wrong images, or whose output was converted wrongly, is wrong in all of them.
Status DataSetSequence::CheckFirstDepthPrior() {
  const FrameRange range = KnownRange();
  for (int idx = range.start; idx < range.end; idx += range.stride) {
    const fs::path file = DepthPriorFile(idx);
    if (file.empty()) continue;
    const Result<cv::Mat> prior = DepthPrior(idx);
    if (!prior.ok()) return prior.status();
    if (const std::string_view why = WhySaysNothing(*prior); !why.empty())
      data_set_.warnings.push_back("the depth prior " + file.string() + " says nothing of depth: it has " +
                                   std::string(why) + "; check what the network was given, and what was written");
    return Status::Ok();
  }
  return Status::Ok();
}

Status DataSetSequence::CheckFiles() const {
  const FrameRange range = KnownRange();
  if (Status status = CheckStoredSizes(images(), range); !status.ok()) return status;
  if (BaselineMm())
    if (Status status = CheckStoredSizes(*data_set_.right, range); !status.ok()) return status;
  if (!masks_) return Status::Ok();
  for (int idx = range.start; idx < range.end; idx += range.stride) {
    const fs::path mask = masks_->Find(idx, fs::path(images().Name(idx)).stem().string());
    const Result<cv::Size> size = SizeOfImageFile(mask);
    if (!size.ok()) return size.status();
    if (Status status = CheckFrameMaskSize(mask, *size, MaskSize()); !status.ok()) return status;
  }
  return Status::Ok();
}

Status DataSetSequence::CheckSize(const cv::Mat& image, const std::string& title) const {
  if (image.cols == camera().width() && image.rows == camera().height()) return Status::Ok();
  return {ErrorCode::kMismatch, title + " is " + SizeText(image) + ", but the calibration and the first image are " +
                                    SizeText(camera().width(), camera().height()) +
                                    "; the size may not change within a sequence"};
}

Result<std::optional<SequenceFrame>> DataSetSequence::Next() {
  if (range_.end != -1 && next_idx_ >= range_.end) return std::optional<SequenceFrame>();
  const int idx = next_idx_;
  constexpr int kLast = std::numeric_limits<int>::max();
  next_idx_ = idx > kLast - range_.stride ? kLast : idx + range_.stride;  // also where it fails: the next may be read
  last_idx_ = idx;
  Result<std::optional<cv::Mat>> image = images().Read(idx);
  if (!image.ok()) return images().IsDamaged(idx) ? Next() : image.status();
  if (!image->has_value()) return std::optional<SequenceFrame>();
  if (Status status = CheckSize(**image, images().Title(idx)); !status.ok()) return status;
  SequenceFrame frame;
  frame.frame_idx = idx;
  frame.name = images().Name(idx);
  frame.timestamp_s = TimeOf(idx);
  frame.image = **std::move(image);
  frame.recorded_s = data_set_.timestamps_s.empty() ? images().RecordedS() : std::optional(frame.timestamp_s);
  Result<cv::Mat> mask = Mask(idx, frame.name);
  if (!mask.ok()) return mask.status();
  frame.mask = *std::move(mask);
  Result<cv::Mat> depth_prior = DepthPrior(idx);
  if (!depth_prior.ok()) return depth_prior.status();
  frame.depth_prior = *std::move(depth_prior);
  return std::optional<SequenceFrame>(std::move(frame));
}

Result<cv::Mat> DataSetSequence::Mask(int idx, const std::string& name) const {
  if (!masks_) return RawMask(idx);
  const cv::Size size = MaskSize();
  Result<cv::Mat> mask = ReadFrameMask(*masks_, idx, name, size.width, size.height);
  if (!mask.ok()) return mask;
  if (data_set_.warp) mask = data_set_.warp->ApplyNearest(*mask);
  if (!data_set_.inside.empty()) mask = cv::Mat(*mask & data_set_.inside);
  return mask;
}

// Of the size of the raw images, or smaller; as they are given.
Result<cv::Mat> DataSetSequence::RawMask(int idx) const {
  const auto file = data_set_.raw_masks.find(idx);
  if (file == data_set_.raw_masks.end()) return data_set_.inside;
  Result<cv::Mat> raw = ReadMaskImage(file->second);
  if (!raw.ok()) return raw;
  cv::Mat mask;
  cv::resize(*raw, mask, MaskSize(), 0, 0, cv::INTER_NEAREST);
  if (data_set_.warp) mask = data_set_.warp->ApplyNearest(mask);
  if (!data_set_.inside.empty()) mask &= data_set_.inside;
  return mask;
}

fs::path DataSetSequence::DepthPriorFile(int idx) const {
  return depth_priors_->Find(idx, fs::path(images().Name(idx)).stem().string());
}

Result<cv::Mat> DataSetSequence::DepthPrior(int idx) const {
  const fs::path file = depth_priors_ ? DepthPriorFile(idx) : fs::path();
  if (file.empty()) return cv::Mat();
  return ReadDepthPrior(file, camera().width(), camera().height());
}

std::optional<double> DataSetSequence::BaselineMm() const {
  return data_set_.right ? data_set_.calibration.baseline_mm : std::nullopt;
}

Result<std::optional<cv::Mat>> DataSetSequence::Right() {
  if (!BaselineMm() || last_idx_ < 0) return std::optional<cv::Mat>();
  Result<std::optional<cv::Mat>> right = data_set_.right->Read(last_idx_);
  if (!right.ok() && data_set_.right->IsDamaged(last_idx_)) return std::optional<cv::Mat>();
  if (!right.ok() || !right->has_value()) return right;
  if (Status status = CheckSize(**right, data_set_.right->Title(last_idx_)); !status.ok()) return status;
  return right;
}

Result<std::optional<cv::Mat>> DataSetSequence::Depth(int frame_idx) const {
  // Of the images, which another thread may be reading, it asks only what does not change.
  if (frame_idx < 0 || frame_idx >= static_cast<int>(data_set_.depth_files.size()) ||
      data_set_.depth_files[static_cast<std::size_t>(frame_idx)].empty())
    return std::optional<cv::Mat>();
  Result<cv::Mat> depth_mm = data_set_.read_depth(data_set_.depth_files[static_cast<std::size_t>(frame_idx)]);
  if (!depth_mm.ok()) return depth_mm.status();
  if (depth_mm->cols != camera().width() || depth_mm->rows != camera().height())
    return Status(ErrorCode::kMismatch, "the depth image of " + images().Title(frame_idx) + " is " +
                                            SizeText(*depth_mm) + ", but the images are " +
                                            SizeText(camera().width(), camera().height()) +
                                            "; depth has the images' size");
  return std::optional<cv::Mat>(*std::move(depth_mm));
}

std::optional<Rigid3> DataSetSequence::WorldFromCamera(int frame_idx) const {
  if (frame_idx < 0 || frame_idx >= static_cast<int>(data_set_.world_from_cam.size())) return std::nullopt;
  return data_set_.world_from_cam[static_cast<std::size_t>(frame_idx)];
}

std::optional<double> DataSetSequence::TimestampS(int frame_idx) const {
  if (frame_idx < 0 || (images().count_is_exact() && images().count() > 0 && frame_idx >= images().count()))
    return std::nullopt;
  return TimeOf(frame_idx);
}

double DataSetSequence::TimeOf(int idx) const {
  const auto k = static_cast<std::size_t>(idx);
  if (k < data_set_.timestamps_s.size()) return data_set_.timestamps_s[k];
  return images().TimestampS(idx).value_or(idx / data_set_.calibration.Fps());
}

std::optional<std::string> DataSetSequence::Name(int frame_idx) const {
  return TimestampS(frame_idx) ? std::optional(images().Name(frame_idx)) : std::nullopt;
}

void WarnOfMissingTruth(const FrameRange& range, DataSet* data_set) {
  std::vector<std::string>* warnings = &data_set->warnings;
  if (const auto& files = data_set->depth_files; !files.empty())
    WarnOfMissing(
        "depth image", range, *data_set, [&](std::size_t k) { return k < files.size() && !files[k].empty(); },
        warnings);
  if (const auto& poses = data_set->world_from_cam; !poses.empty())
    WarnOfMissing(
        "pose", range, *data_set, [&](std::size_t k) { return k < poses.size() && poses[k].has_value(); }, warnings);
}

// Where the number of frames is an estimate: by reading.
Status CheckStart(const FrameRange& range, ImageStream* images) {
  if (images->count_is_exact() || images->count() == 0 || range.start < images->count()) return Status::Ok();
  const auto first = images->Read(range.start);
  if (!first.ok()) return images->IsDamaged(range.start) ? Status::Ok() : first.status();
  if (first->has_value()) return Status::Ok();
  return {ErrorCode::kInvalidArgument,
          "start is " + std::to_string(range.start) + ", but " + images->path().string() + " has fewer frames"};
}

}  // namespace

Result<std::unique_ptr<Sequence>> ReadDataSet(DataSet data_set, const SequenceRequest& request) {
  Result<FrameRange> range = FrameRange::From(request);
  // Containers without an index estimate their number of frames: how far a video goes is known when it has been read.
  if (range.ok() && data_set.images->count() > 0 && data_set.images->count_is_exact())
    range = range->Within(data_set.images->count(), data_set.images->path());
  if (!range.ok()) return range.status();
  if (Status status = CheckStart(*range, data_set.images.get()); !status.ok()) return status;
  const FrameRange known = ByItsWord(*range, *data_set.images);
  WarnOfMissingTruth(known, &data_set);
  WarnOfUnscaledValues(known, *data_set.images, &data_set.warnings);
  auto sequence = std::make_unique<DataSetSequence>(std::move(data_set), *range);
  if (Status status = sequence->CheckFirstImage(); !status.ok()) return status;
  if (Status status = sequence->OpenMasks(); !status.ok()) return status;
  if (Status status = sequence->OpenDepthPriors(request.depth_prior_path); !status.ok()) return status;
  return std::unique_ptr<Sequence>(std::move(sequence));
}

}  // namespace pliant
