// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/report.h"

#include <algorithm>

#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "viewer/page_asset.h"
#include "viewer/page_data.h"
#include "viewer/view_images.h"

namespace pliant {

void ReportOptions::List(OptionTable& table) {
  table.BeginGroup("Report", "what a report contains of a run");
  view.List(table);
  table.Add("image_width_px", &image_width_px, "px", "images are made no wider than this", 32, 4096);
  table.Add("image_quality", &image_quality, "%", "of their JPEG coding", 10, 100);
  table.Add("max_image_mb", &max_image_mb, "MB", "where they need more, every second one is left out until they fit",
            1.0, 2000.0);
}

bool HasReportPage() { return CheckPageAsset().ok(); }

Result<ReportSummary> WriteReportPage(const ViewRequest& request, const ReportOptions& options,
                                      const std::string& output_path, const JobProgress& progress) {
  auto view = OpenView(request, options.view, progress);
  if (!view.ok()) return view.status();
  if (Status status = CheckPageAsset(); !status.ok()) return status;
  ViewImages images;
  if (view->sequence) {
    auto read = ReadViewImages(options, progress, &*view);
    if (!read.ok()) return read.status();
    images = *std::move(read);
  }
  const std::string title = CommaSeparated(view->runs, &ViewedRun::name);
  ReportSummary summary;
  for (const ViewedRun& run : view->runs) {
    summary.frames = std::max(summary.frames, static_cast<int>(run.frames.size()));
    for (const ViewedFrame& frame : run.frames)
      summary.observations += static_cast<std::int64_t>(frame.observations.size());
  }
  const std::string page = PageWith(PageData(*view, images, title));
  if (Status status = WriteFileAtomically(output_path, page); !status.ok()) return status;
  summary.runs = static_cast<int>(view->runs.size());
  summary.images = images.jpeg.size();
  summary.megabytes = static_cast<double>(page.size()) / 1e6;
  summary.notes = view->notes;
  return summary;
}

}  // namespace pliant
