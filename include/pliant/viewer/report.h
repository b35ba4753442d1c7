// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs as one HTML file that is opened from disk and asks nothing of a network (web/README.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/viewer/view.h"

namespace pliant {

struct ReportOptions {
  ViewOptions view;
  int image_width_px = 480;
  int image_quality = 70;
  double max_image_mb = 50;

  void List(OptionTable& table);  // group "Report"
};

struct ReportSummary {
  int runs = 0;
  int frames = 0;  // of the run with the most
  std::int64_t observations = 0;
  std::size_t images = 0;
  double megabytes = 0;            // of the file
  std::vector<std::string> notes;  // what is missing or left out; they are in the report too
};

// False in a build without the page (PLIANT_BUILD_VIEWER=OFF).
bool HasReportPage();

// Replaces the file at once: a reader sees the old one or the new one. Fails as OpenView does, with kUnwritable, and
// with kNotFound in a build without the page. `progress` is told of frames that are compared with their truth and of
// images.
Result<ReportSummary> WriteReportPage(const ViewRequest& request, const ReportOptions& options,
                                      const std::string& output_path, const JobProgress& progress = {});

}  // namespace pliant
