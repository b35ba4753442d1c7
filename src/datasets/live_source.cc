// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/live_source.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "datasets/data_set.h"
#include "datasets/frame_grabber.h"
#include "datasets/image_file.h"
#include "datasets/stream_errors.h"
#include "pliant/base/parallel.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/native_writer.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kPoll = std::chrono::milliseconds(50);  // how late a stop is seen
constexpr std::size_t kMaxUnwrittenBytes = 256 << 20;  // of images; tracking waits for the recorder then

double SecondsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::size_t SizeInBytes(const cv::Mat& image) { return image.total() * image.elemSize(); }

// Of which only the size of the images is known, for the search of their calibration.
class ImagesOfSize final : public ImageStream {
 public:
  ImagesOfSize(fs::path source, cv::Size size, std::optional<double> fps)
      : source_(std::move(source)), size_(size), fps_(fps) {}

  const fs::path& path() const override { return source_; }
  int count() const override { return 0; }
  bool count_is_exact() const override { return false; }
  std::optional<double> fps() const override { return fps_; }
  std::string Name(int idx) const override { return native::FrameFileName(idx); }
  std::string Title(int /*idx*/) const override { return "the first image of " + SourceName(source_.string()); }
  std::optional<cv::Size> SizeAt(int /*idx*/) const override { return size_; }
  Result<std::optional<cv::Mat>> Read(int /*idx*/) override { return std::optional<cv::Mat>(); }

 private:
  fs::path source_;
  cv::Size size_;
  std::optional<double> fps_;
};

struct LiveCalibration {
  SourceCalibration calibration;
  std::vector<std::string> warnings;
};

Result<LiveCalibration> CalibrationOf(const LiveRequest& request, cv::Size size, std::optional<double> fps) {
  SequenceRequest of_images;
  of_images.camera_path = request.camera_path.empty() ? fs::path(native::kCameraFile) : request.camera_path;
  std::error_code error;
  if (request.camera_path.empty() && !fs::is_regular_file(of_images.camera_path, error))
    return Status(ErrorCode::kNotFound, "there is no calibration for " + SourceName(request.source.string()) +
                                            ": no file camera.yaml in the working folder; name one with --camera, or "
                                            "make one with pliant calibrate");
  auto data_set = Calibrated(of_images, std::make_unique<ImagesOfSize>(request.source, size, fps));
  if (!data_set.ok()) return data_set.status();
  if (data_set->right)
    return Status(ErrorCode::kInvalidArgument,
                  of_images.camera_path.string() +
                      " is the calibration of a pair, and pairs are not read live; record them, and track the file");
  const Camera& camera = data_set->calibration.camera;
  if (camera.width() != size.width || camera.height() != size.height)
    return Status(ErrorCode::kMismatch, "the calibration " + of_images.camera_path.string() + " is for images of " +
                                            SizeText(camera.width(), camera.height()) + ", but those of " +
                                            SourceName(request.source.string()) + " are " +
                                            SizeText(size.width, size.height) + "; give the calibration of these");
  return LiveCalibration{std::move(data_set->calibration), std::move(data_set->warnings)};
}

struct Arrival {
  cv::Mat image;
  Clock::time_point time;
};

}  // namespace

// Three threads meet here: one receives, one records, and those of tracking read.
struct LiveSource::State {
  explicit State(LiveRequest of) : request(std::move(of)) {}
  ~State() {
    is_closing = true;
    changed.notify_all();
    if (receiver.joinable()) receiver.join();
    if (recorder.joinable()) recorder.join();
  }

  bool IsStopped() const { return is_closing || (request.stop != nullptr && *request.stop); }
  void Receive();
  void Record();
  // Waits for the next image, which stays. Nothing at the end. `lock` is of `mutex`.
  Result<bool> HasNext(std::unique_lock<std::mutex>& lock);
  // Waits until at most so many images are not recorded yet, or one cannot be.
  Status WaitForRecorder(std::size_t most, std::unique_lock<std::mutex>& lock);
  Result<std::optional<cv::Mat>> Take(std::unique_lock<std::mutex>& lock);
  StreamCounts CountsWithRate() const;

  const LiveRequest request;
  std::unique_ptr<FrameGrabber> grabber;
  std::optional<LiveCalibration> calibration;
  std::optional<NativeWriter> writer;  // used by `recorder` alone

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::optional<Arrival> next;
  bool has_ended = false;       // nothing will come any more
  Status ended = Status::Ok();  // why, where it is no end
  std::optional<Clock::time_point> first_arrival, last_arrival;
  StreamCounts counts;
  std::vector<Clock::time_point> arrivals;        // of the images that were taken
  std::vector<double> times_s;                    // of these
  std::deque<std::pair<int, cv::Mat>> unwritten;  // of those, in order
  Status written = Status::Ok();                  // what became of recording them

  std::atomic<bool> is_closing = false;
  std::thread receiver, recorder;
};

void LiveSource::State::Receive() {
  while (!IsStopped()) {
    std::optional<cv::Mat> image = grabber->Grab();
    std::unique_lock lock(mutex);
    const auto now = Clock::now();
    counts.damaged = grabber->damaged();
    if (!image) break;
    if (!first_arrival) first_arrival = now;
    last_arrival = now;
    if (request.options.frames == LiveFrames::kAll)
      while (next && !IsStopped()) changed.wait_for(lock, kPoll);
    else if (next)
      ++counts.skipped;
    ++counts.received;
    next = Arrival{*std::move(image), now};
    changed.notify_all();
  }
  const std::lock_guard lock(mutex);
  has_ended = true;
  ended = grabber->status();
  changed.notify_all();
}

void LiveSource::State::Record() {
  LowerThreadPriority();  // to code an image takes as long as to track it
  std::unique_lock lock(mutex);
  while (true) {
    while (unwritten.empty() && !is_closing) changed.wait_for(lock, kPoll);
    if (unwritten.empty()) return;
    const auto [idx, image] = unwritten.front();
    const double time_s = times_s[static_cast<std::size_t>(idx)];
    lock.unlock();
    const Status status = writer->Write({.timestamp_s = time_s, .image = image});
    lock.lock();
    if (!status.ok()) {
      written = status;
      changed.notify_all();
      return;
    }
    unwritten.pop_front();
    changed.notify_all();
  }
}

Result<bool> LiveSource::State::HasNext(std::unique_lock<std::mutex>& lock) {
  const auto begin = Clock::now();
  const auto silence_s = [&] { return SecondsBetween(std::max(begin, last_arrival.value_or(begin)), Clock::now()); };
  while (!next) {
    if (IsStopped()) return false;
    if (!ended.ok()) return ended;
    if (has_ended) return false;
    if (silence_s() > request.options.timeout_s + 2)  // the decoder's own time-out comes first
      return SentNothing(request.source.string(), request.options.timeout_s);
    changed.wait_for(lock, kPoll);
  }
  return !IsStopped();
}

Status LiveSource::State::WaitForRecorder(std::size_t most, std::unique_lock<std::mutex>& lock) {
  while (unwritten.size() > most && written.ok()) changed.wait_for(lock, kPoll);
  return written;
}

Result<std::optional<cv::Mat>> LiveSource::State::Take(std::unique_lock<std::mutex>& lock) {
  const auto has_next = HasNext(lock);
  if (!has_next.ok()) return has_next.status();
  if (!*has_next) return std::optional<cv::Mat>();
  const std::size_t most = std::max<std::size_t>(1, kMaxUnwrittenBytes / SizeInBytes(next->image));
  if (Status status = WaitForRecorder(most, lock); !status.ok()) return status;
  const int idx = static_cast<int>(times_s.size());
  arrivals.push_back(next->time);
  times_s.push_back(request.options.frames == LiveFrames::kAll ? idx / calibration->calibration.Fps()
                                                               : SecondsBetween(*first_arrival, next->time));
  const cv::Mat image = std::exchange(next, std::nullopt)->image;
  unwritten.emplace_back(idx, image);
  changed.notify_all();
  return std::optional(image);
}

StreamCounts LiveSource::State::CountsWithRate() const {
  StreamCounts result = counts;
  result.fps = calibration->calibration.Fps();
  result.measured =
      request.options.frames == LiveFrames::kNewest && counts.received > 1 && *last_arrival > *first_arrival;
  if (result.measured)
    result.fps = static_cast<double>(counts.received - 1) / SecondsBetween(*first_arrival, *last_arrival);
  return result;
}

void LiveInputOptions::List(OptionTable& table) {
  table.BeginGroup("LiveInput", "images of a camera, a stream or a pipe, which arrive while they are tracked");
  table.AddChoice("frames", &frames,
                  "newest: those that arrive while tracking is busy are skipped and counted; all: every one is "
                  "tracked, a pipe waits, a camera falls behind");
  table.Add("handover_frames", &handover_frames, "frames",
            "newest: minimum of Tracking.handover_frames; frames before the first map are not tracked backwards", 0,
            1000);
  table.Add("timeout_s", &timeout_s, "s", "without an image, after which the run ends", 0.5, 3600);
}

bool IsLiveSource(const fs::path& path) {
  constexpr std::array kBegins = {"device:", "rtsp://", "rtmp://", "http://", "https://", "udp://", "tcp://", "srt://"};
  std::string name = path.string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name == "-" || std::ranges::any_of(kBegins, [&](const char* begin) { return name.starts_with(begin); });
}

fs::path RecordingOf(const std::string& run_path) {
  return fs::path(run_path + "/").parent_path().string() + "_recording";
}

LiveSource::LiveSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
LiveSource::~LiveSource() = default;

Result<std::shared_ptr<LiveSource>> LiveSource::Open(const LiveRequest& request) {
  auto owned = std::make_unique<State>(request);
  State& state = *owned;
  auto grabber =
      FrameGrabber::Open(request.source.string(), request.options.timeout_s, [&state] { return state.IsStopped(); });
  if (!grabber.ok()) return grabber.status();
  state.grabber = *std::move(grabber);
  state.receiver = std::thread([&state] { state.Receive(); });
  cv::Size size;
  {
    std::unique_lock lock(state.mutex);
    const auto has_first = state.HasNext(lock);
    if (!has_first.ok()) return has_first.status();
    if (!*has_first && state.IsStopped())
      return Status(ErrorCode::kInterrupted, "stopped on request before the first image");
    if (!*has_first)
      return Status(ErrorCode::kUnreadable,
                    SourceName(request.source.string()) + " ends before its first image; check what it sends");
    size = state.next->image.size();
  }
  auto calibration = CalibrationOf(request, size, state.grabber->fps());
  if (!calibration.ok()) return calibration.status();
  state.calibration = *std::move(calibration);

  const SourceCalibration& source = state.calibration->calibration;
  CameraFile camera{.camera = source.camera, .fps = source.Fps()};
  camera.photometric = source.photometric;
  auto writer = NativeWriter::Create(request.recording_path, camera);
  if (!writer.ok()) return writer.status();
  state.writer.emplace(*std::move(writer));
  state.recorder = std::thread([&state] { state.Record(); });
  return std::shared_ptr<LiveSource>(new LiveSource(std::move(owned)));
}

std::shared_ptr<const GivenImages> LiveSource::Given(const std::shared_ptr<LiveSource>& self) {
  const LiveCalibration& of = *self->state_->calibration;
  GivenImages given{.camera = of.calibration.camera, .photometric = of.calibration.photometric, .images = self};
  given.fps = of.calibration.Fps();
  given.warnings = of.warnings;
  return std::make_shared<const GivenImages>(std::move(given));
}

Result<std::optional<cv::Mat>> LiveSource::Read(int idx) {
  State& state = *state_;
  std::unique_lock lock(state.mutex);
  while (std::cmp_less(state.times_s.size(), idx)) {
    auto passed_over = state.Take(lock);
    if (!passed_over.ok() || !passed_over->has_value()) return passed_over;
  }
  if (std::cmp_equal(state.times_s.size(), idx)) return state.Take(lock);
  if (!state.written.ok()) return state.written;
  for (const auto& [number, image] : state.unwritten)
    if (number == idx) return std::optional(image);
  lock.unlock();
  Result<cv::Mat> image = ReadImage(state.request.recording_path / native::kImageFolder / native::FrameFileName(idx));
  if (!image.ok()) return image.status();
  return std::optional(*std::move(image));
}

std::optional<double> LiveSource::TimestampS(int idx) const {
  const std::lock_guard lock(state_->mutex);
  return idx >= 0 && std::cmp_less(idx, state_->times_s.size())
             ? std::optional(state_->times_s[static_cast<std::size_t>(idx)])
             : std::nullopt;
}

std::optional<Clock::time_point> LiveSource::Arrived(int idx) const {
  const std::lock_guard lock(state_->mutex);
  return idx >= 0 && std::cmp_less(idx, state_->arrivals.size())
             ? std::optional(state_->arrivals[static_cast<std::size_t>(idx)])
             : std::nullopt;
}

int LiveSource::Passed() const {
  const std::lock_guard lock(state_->mutex);
  return state_->has_ended ? 0 : static_cast<int>(state_->arrivals.size());
}

StreamCounts LiveSource::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->CountsWithRate();
}

Status LiveSource::FinishRecording() {
  std::unique_lock lock(state_->mutex);
  return state_->WaitForRecorder(0, lock);
}

}  // namespace pliant
