// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images that arrive while they are tracked: of a camera that is plugged in, of a stream over the network, or from a
// pipe. Those that tracking takes are recorded as a native sequence (docs/formats.md), since tracking goes back to
// earlier images, and since reports, surfaces and refinements are made of them afterwards.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/datasets/given_images.h"
#include "pliant/io/run_summary.h"

namespace pliant {

// What becomes of the images that arrive while tracking is busy.
enum class LiveFrames {
  kNewest,  // the newest one is tracked next, and those before it are skipped and counted
  kAll,     // every image is tracked: a pipe waits, a camera or a stream falls behind
};
template <>
struct EnumNames<LiveFrames> {
  static constexpr std::array kNames = {std::pair{LiveFrames::kNewest, std::string_view("newest")},
                                        std::pair{LiveFrames::kAll, std::string_view("all")}};
};

struct LiveInputOptions {
  LiveFrames frames = LiveFrames::kNewest;
  double timeout_s = 10;  // without an image, after which the source counts as stalled
  // newest: Tracking.handover_frames, at least; and General.max_frames_back is 0: nothing holds tracking up.
  int handover_frames = 30;

  void List(OptionTable& table);  // group "LiveInput"
};

// Whether an image path names such a source and no file: "device:N" (Video4Linux), "-" (standard input), or an address
// whose protocol is rtsp, rtmp, http, https, udp, tcp or srt.
bool IsLiveSource(const std::filesystem::path& path);

// Where the images of a live run are recorded: beside the run.
std::filesystem::path RecordingOf(const std::string& run_path);

struct LiveRequest {
  std::filesystem::path source;
  std::filesystem::path camera_path;     // as that of a SequenceRequest
  std::filesystem::path recording_path;  // folder that becomes a native sequence; one that is there is replaced
  LiveInputOptions options = {};
  const std::atomic<bool>* stop = nullptr;  // becomes true when no further image is to be taken; may be null
};

// Times are those of arrival in seconds after the first image; with LiveFrames::kAll, number / rate. All functions may
// be called from several threads.
class LiveSource final : public ImageSource {
 public:
  // Opens the source, waits for its first image, reads the calibration and makes the folder of the recording, in this
  // order. Fails with kNotFound (no such device, no calibration), kUnreadable (no images come, or none that can be
  // decoded), kMismatch (a calibration of another size), kInvalidArgument (one of image pairs, which are not read
  // live), kInterrupted (`stop` became true) or kUnwritable.
  static Result<std::shared_ptr<LiveSource>> Open(const LiveRequest& request);
  ~LiveSource() override;

  // These images with their calibration; `self` is what Open gave.
  static std::shared_ptr<const GivenImages> Given(const std::shared_ptr<LiveSource>& self);

  int count() const override { return 0; }
  bool IsLive() const override { return true; }
  // One that was taken before is read from the recording. The next one is waited for; nothing when the source has ended
  // or `stop` is true. Fails with kUnreadable where the source has stalled, and with kUnwritable where an image could
  // not be recorded.
  Result<std::optional<cv::Mat>> Read(int idx) override;
  // Of an image that was taken.
  std::optional<double> TimestampS(int idx) const override;
  std::optional<std::chrono::steady_clock::time_point> Arrived(int idx) const override;

  int Passed() const override;

  // So far.
  StreamCounts counts() const;

  // Waits until all images that were taken are recorded. Fails with kUnwritable where one could not be.
  Status FinishRecording();

 private:
  struct State;
  explicit LiveSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pliant
