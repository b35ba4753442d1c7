// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/live_view.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "pliant/base/parallel.h"
#include "viewer/live_images.h"
#include "viewer/live_run.h"
#include "viewer/loopback_server.h"
#include "viewer/page_asset.h"
#include "viewer/page_data.h"

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kAnswerThreads = 8;  // of which each page that waits for news takes one
constexpr std::chrono::seconds kLongestPause(20);
// At the end: who asked so lately is about to ask again.
constexpr std::chrono::seconds kStillLooking(2);
constexpr std::chrono::milliseconds kLastImages(700);  // for the page to fetch the image of the last frame

int Number(const httplib::Request& request, const char* name) {
  int value = 0;
  return ParseInt(request.get_param_value(name), &value) && value >= 0 ? value : 0;
}

}  // namespace

struct LiveView::Server {
  Server(const LiveRunName& shown, const LiveOptions& options)
      : title(shown.name),
        in_millimeters(shown.in_millimeters),
        images(options.image_width_px, options.image_quality, options.max_image_mb),
        run(shown.name),
        http(kAnswerThreads, LowerThreadPriority) {
    http.Get("/", [this](const auto&, auto* response) {
      SetBody(PageWith({{"format", kPageFormat}, {"live", true}, {"title", title}}), "text/html", response);
    });
    http.Get("/data", [this](const auto& request, auto* response) {
      const std::chrono::milliseconds pause(Number(request, "wait_ms"));
      SetBody(Data(Number(request, "epoch"), Number(request, "from"), pause), "application/json", response);
    });
    http.Get(R"(/image/(\d+)\.jpg)", [this](const auto& request, auto* response) {
      int frame_idx = 0;
      std::string jpeg = ParseInt(request.matches[1].str(), &frame_idx) ? images.At(frame_idx) : std::string();
      if (jpeg.empty())
        response->status = 404;
      else
        SetBody(std::move(jpeg), "image/jpeg", response);
    });
  }

  // What came after the rows that the page has, at the end of the pause or of the run.
  std::string Data(int epoch, int from, Clock::duration pause) {
    View view;
    nlohmann::ordered_json answer;
    LiveRun::Part part;
    {
      std::unique_lock lock(mutex);
      ++waiting;
      changed.wait_for(lock, std::min<Clock::duration>(pause, kLongestPause), [&] { return ended; });
      --waiting;
      const int begin = epoch == run.epoch() && from <= run.rows() ? from : 0;
      answer = {{"epoch", run.epoch()},         {"from", begin}, {"running", !ended},       {"kept", kept},
                {"frames_in_sequence", frames}, {"read", read},  {"state", EnumName(state)}};
      part = run.From(begin);
      view.notes = warnings;
      asked = Clock::now();
      knows_the_end = knows_the_end || ended;
    }
    view.runs.push_back(std::move(part).ToRun());  // without holding up the tracker
    view.camera = view.runs.front().camera;
    view.in_millimeters = view.runs.front().in_millimeters = in_millimeters;
    answer["image_frames"] = images.Frames();
    answer["image_scale"] = images.scale();
    answer["data"] = PageData(view, {}, title);
    return answer.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }

  void WaitForThoseWhoLook() {
    const Clock::time_point end = Clock::now() + kStillLooking;
    while (Clock::now() < end) {
      {
        const std::lock_guard lock(mutex);
        const bool looks = waiting > 0 || (asked && Clock::now() - *asked < kStillLooking);
        if (!looks) return;
        if (knows_the_end) break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::this_thread::sleep_for(kLastImages);
  }

  const std::string title;
  const bool in_millimeters;
  LiveImages images;
  std::mutex mutex;
  std::condition_variable changed;
  int waiting = 0;  // pages
  LiveRun run;
  std::vector<std::string> warnings;
  int frames = 0;  // of the sequence, by its own word
  int read = 0;
  int last_read_frame_idx = -1;  // some come once more
  TrackingState state = TrackingState::kWaitingForReference;
  bool ended = false;
  bool kept = false;                       // beyond the run's end
  bool knows_the_end = false;              // the page
  std::optional<Clock::time_point> asked;  // last, by a page
  LoopbackServer http;
};

void LiveOptions::List(OptionTable& table) {
  table.BeginGroup("Live", "the view that --live serves to a browser on this machine");
  table.Add("port", &port, "-", "0, or one that is in use: any free port", 0, 65535);
  table.Add("image_width_px", &image_width_px, "px", "images are made no wider than this", 32, 4096);
  table.Add("image_quality", &image_quality, "%", "of their JPEG coding", 10, 100);
  table.Add("max_image_mb", &max_image_mb, "MB", "kept in memory; above it every second image is forgotten", 1.0,
            100000.0);
}

Result<std::unique_ptr<LiveView>> LiveView::Start(const LiveRunName& shown, const LiveOptions& options) {
  if (Status status = CheckPageAsset(); !status.ok()) return status;
  auto server = std::make_unique<Server>(shown, options);
  if (!server->http.Start(options.port))
    return Status(ErrorCode::kUnwritable, "the live view finds no free port on this machine; run without --live");
  return std::unique_ptr<LiveView>(new LiveView(std::move(server)));
}

LiveView::LiveView(std::unique_ptr<Server> server) : server_(std::move(server)) {}

LiveView::~LiveView() {
  const bool was_kept = server_->kept;
  EndRun(/*keep=*/was_kept);
  if (!was_kept) server_->WaitForThoseWhoLook();
  server_->http.Stop();
}

void LiveView::EndRun(bool keep) {
  {
    const std::lock_guard lock(server_->mutex);
    server_->ended = true;
    server_->kept = keep;
  }
  server_->changed.notify_all();
}

void LiveView::KeepRun() { EndRun(/*keep=*/true); }

std::string LiveView::Url() const { return "http://127.0.0.1:" + std::to_string(server_->http.port()) + "/"; }

void LiveView::OnCamera(const Camera& camera) {
  const std::lock_guard lock(server_->mutex);
  server_->run.SetCamera(camera);
}

void LiveView::OnStart(int frames) {
  const std::lock_guard lock(server_->mutex);
  server_->frames = frames;
}

void LiveView::OnWarning(const std::string& sentence) {
  const std::lock_guard lock(server_->mutex);
  server_->warnings.push_back(sentence);
}

void LiveView::OnImage(int frame_idx, const cv::Mat& image) {
  server_->images.Add(frame_idx, image);
  const std::lock_guard lock(server_->mutex);
  if (frame_idx > server_->last_read_frame_idx) ++server_->read;
  server_->last_read_frame_idx = std::max(server_->last_read_frame_idx, frame_idx);
}

void LiveView::OnFrame(const FrameReport& report) {
  const std::lock_guard lock(server_->mutex);
  server_->run.Add(report);
  server_->state = report.state;
}

void LiveView::OnHeld(const FrameReport& report) {
  const std::lock_guard lock(server_->mutex);
  server_->state = report.state;
}

}  // namespace pliant
