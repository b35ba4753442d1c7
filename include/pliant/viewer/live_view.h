// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run to look at while it runs: an observer that serves the page of a report on this machine's loopback interface.
// All that is asked of it is answered on threads of its own, of low priority, from what it has kept: nobody who looks,
// or ceases to look, can hold the run up.
#pragma once

#include <memory>
#include <string>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/pipeline/track.h"

namespace pliant {

struct LiveOptions {
  int port = 8765;
  int image_width_px = 480;
  int image_quality = 70;
  double max_image_mb = 200;  // kept in memory; above it every second image is forgotten

  void List(OptionTable& table);  // group "Live"
};

// The run that is shown.
struct LiveRunName {
  std::string name;
  bool in_millimeters = false;  // its unit; else map units
};

class LiveView final : public TrackObserver {
 public:
  // Begins to serve. Port 0, or one that is in use, becomes a free one. Fails with
  // kUnwritable where no port can be had, and with kNotFound in a build without the page (PLIANT_BUILD_VIEWER=OFF).
  static Result<std::unique_ptr<LiveView>> Start(const LiveRunName& shown, const LiveOptions& options);
  // Ceases to serve. Who has asked in the last seconds gets the last frames first.
  ~LiveView() override;
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  // The run has ended; it is served as it is until this object goes.
  void KeepRun();

  std::string Url() const;  // "http://127.0.0.1:8765/"

  void OnCamera(const Camera& camera) override;
  void OnStart(int frames) override;
  void OnWarning(const std::string& sentence) override;
  void OnImage(int frame_idx, const cv::Mat& image) override;
  void OnFrame(const FrameReport& report) override;
  void OnHeld(const FrameReport& report) override;

 private:
  struct Server;
  void EndRun(bool keep);
  explicit LiveView(std::unique_ptr<Server> server);
  std::unique_ptr<Server> server_;
};

}  // namespace pliant
