// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/comparison_figure.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "pliant/viewer/output.h"
#include "viewer/drawing.h"
#include "viewer/picture_file.h"
#include "viewer/plot.h"

namespace pliant {
namespace {

// The page, in points of 1/72 inch.
constexpr double kPageWidth = 3.4 * 72;
constexpr double kPanelHeight = 70;
constexpr double kPanelGap = 10;
constexpr double kLeft = 14;    // what the name of an axis takes
constexpr double kTickGap = 4;  // around the numbers of an axis
constexpr double kRight = 4;
constexpr double kTop = 2;
constexpr double kBottom = 20;  // what the labels of the frames take
constexpr double kPngScale = 600.0 / 72;

constexpr double kLegendRow = 10.5;
constexpr double kLegendGap = 9;  // between two entries
constexpr double kSampleGap = 3;  // between a line's sample and its name

constexpr int kMaxFrameTicks = 7;
constexpr int kMaxTicks = 5;
constexpr int kMaxLogarithmicTicks = 7;
constexpr double kHeadroom = 1.06;  // of an axis above the largest value

// How many times the median the largest value of a panel has to be for a logarithmic scale, and how far it reaches.
constexpr double kLogarithmicRange = 8;
constexpr double kLongestRange = 1000;

constexpr const char* kNullName = "null (constant depth)";

using Stretches = std::vector<PlotStretch>;
using FrameValues = std::map<int, double>;

struct PanelContent {
  std::string label;
  std::vector<Stretches> runs = {};   // one a run, empty where it has no value
  std::vector<Stretches> nulls = {};  // likewise, or none
  bool is_count = false;              // whole numbers
};

bool HasValue(const std::vector<Stretches>& lines) {
  return std::ranges::any_of(lines, [](const Stretches& line) { return !line.empty(); });
}

// The usual distance between two frames that were read.
int UsualStep(const std::vector<TrackSurvival::Frame>& frames) {
  std::vector<int> steps;
  for (std::size_t i = 1; i < frames.size(); ++i) steps.push_back(frames[i].frame_idx - frames[i - 1].frame_idx);
  if (steps.empty()) return 1;
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  return steps[steps.size() / 2];
}

// Another system's result has no rows of frames that it lost: they show as a larger step.
Stretches SplitAtGaps(const std::vector<TrackSurvival::Frame>& frames, const FrameValues& values) {
  const double largest_step = 1.5 * UsualStep(frames);
  Stretches stretches;
  std::optional<int> last;  // frame of the stretch
  for (const TrackSurvival::Frame& frame : frames) {
    const auto value = values.find(frame.frame_idx);
    if (value == values.end() || !std::isfinite(value->second)) {
      last.reset();
      continue;
    }
    if (!last || frame.frame_idx - *last > largest_step) stretches.emplace_back();
    stretches.back().push_back({static_cast<double>(frame.frame_idx), value->second});
    last = frame.frame_idx;
  }
  return stretches;
}

PanelContent SurfacePanel(std::span<const Evaluation> evaluations) {
  PanelContent panel{.label = "surface RMSE (mm)"};
  for (const Evaluation& evaluation : evaluations) {
    FrameValues estimate;
    FrameValues null;
    if (evaluation.surface) {
      for (const PointFrameError& frame : evaluation.surface->plain.frames) {
        estimate[frame.frame_idx] = frame.estimate.rmse_mm;
        null[frame.frame_idx] = frame.null.rmse_mm;
      }
    }
    panel.runs.push_back(SplitAtGaps(evaluation.survival.frames, estimate));
    panel.nulls.push_back(SplitAtGaps(evaluation.survival.frames, null));
  }
  return panel;
}

PanelContent CameraPanel(std::span<const Evaluation> evaluations) {
  PanelContent panel{.label = "camera ATE (mm)"};
  for (const Evaluation& evaluation : evaluations) {
    FrameValues errors;
    if (evaluation.trajectory)
      for (std::size_t i = 0; i < evaluation.trajectory->ate_mm.size(); ++i)
        errors[evaluation.trajectory->frame_idx[i]] = evaluation.trajectory->ate_mm[i];
    panel.runs.push_back(SplitAtGaps(evaluation.survival.frames, errors));
  }
  return panel;
}

// A run without observations has no points, rather than 0 in every frame.
PanelContent PointsPanel(std::span<const Evaluation> evaluations) {
  PanelContent panel{.label = "points", .is_count = true};
  for (const Evaluation& evaluation : evaluations) {
    FrameValues counts;
    if (evaluation.survival.tracks > 0)
      for (const TrackSurvival::Frame& frame : evaluation.survival.frames)
        if (frame.tracked) counts[frame.frame_idx] = frame.points;
    panel.runs.push_back(SplitAtGaps(evaluation.survival.frames, counts));
  }
  return panel;
}

std::vector<PanelContent> PanelsOf(std::span<const Evaluation> evaluations) {
  std::vector<PanelContent> panels;
  for (PanelContent& panel : std::vector{SurfacePanel(evaluations), CameraPanel(evaluations), PointsPanel(evaluations)})
    if (HasValue(panel.runs)) panels.push_back(std::move(panel));
  return panels;
}

void AppendValues(const std::vector<Stretches>& lines, std::vector<double>* values) {
  for (const Stretches& line : lines)
    for (const PlotStretch& stretch : line)
      for (const PlotPoint& point : stretch) values->push_back(point.y);
}

Axis ValueAxis(const PanelContent& panel) {
  std::vector<double> values;
  AppendValues(panel.runs, &values);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  const double median = *middle;
  AppendValues(panel.nulls, &values);
  const double highest = std::ranges::max(values);
  if (!panel.nulls.empty() && median > 0 && highest > kLogarithmicRange * median) {
    const double low = std::max(std::ranges::min(values), highest / kLongestRange) / kHeadroom;
    const double high = highest * kHeadroom;
    return {low, high, true, LogarithmicTicks(low, high, kMaxLogarithmicTicks)};
  }
  const double high = highest > 0 ? highest * kHeadroom : 1;
  const int max_ticks = panel.is_count ? static_cast<int>(std::min<double>(kMaxTicks, high + 1)) : kMaxTicks;
  return {0, high, false, LinearTicks(0, high, max_ticks)};
}

Axis FrameAxis(std::span<const Evaluation> evaluations) {
  std::optional<std::pair<int, int>> range;
  for (const Evaluation& evaluation : evaluations) {
    for (const TrackSurvival::Frame& frame : evaluation.survival.frames) {
      if (!range) range = {frame.frame_idx, frame.frame_idx};
      range = {std::min(range->first, frame.frame_idx), std::max(range->second, frame.frame_idx)};
    }
  }
  const int count = range->second - range->first + 1;
  const double margin = count > 1 ? 0 : 0.5;
  const double low = range->first - margin;
  const double high = range->second + margin;
  return {low, high, false, LinearTicks(low, high, std::min(count, kMaxFrameTicks))};
}

// What a text takes is the same on every surface (UseExactText).
class Measure {
 public:
  Measure() : surface_(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1)), drawing_(cairo_create(surface_.get())) {
    UseExactText(drawing_.get());
  }
  double operator()(const std::string& text, double size) const { return TextWidth(drawing_.get(), text, size); }

 private:
  CairoSurface surface_;
  Drawing drawing_;
};

struct LineEntry {
  std::string text;
  std::optional<LineStyle> style;  // nothing: the null
  double left = 0;
  int row = 0;
};

// What is wider loses its middle: the names of runs often differ at their end.
std::string Shortened(const Measure& measure, const std::string& text, double width) {
  if (measure(text, kLabelText) <= width) return text;
  std::vector<std::string> letters;  // of UTF-8
  for (const char byte : text) {
    if ((static_cast<unsigned char>(byte) & 0xC0) != 0x80 || letters.empty()) letters.emplace_back();
    letters.back() += byte;
  }
  for (std::size_t kept = letters.size() - 1; kept > 0; --kept) {
    std::string shortened;
    for (std::size_t i = 0; i < kept; ++i) {
      if (i == kept / 2) shortened += "\u2026";
      shortened += letters[i < kept / 2 ? i : letters.size() - kept + i];
    }
    if (measure(shortened, kLabelText) <= width) return shortened;
  }
  return "\u2026";
}

// In one row where all fit into it, else in columns of one width.
void ArrangeLegend(const Measure& measure, double width, std::vector<LineEntry>* entries) {
  std::vector<double> widths;
  double total = -kLegendGap;
  for (LineEntry& entry : *entries) {
    entry.text = Shortened(measure, entry.text, width - kSampleWidth - kSampleGap);
    widths.push_back(kSampleWidth + kSampleGap + measure(entry.text, kLabelText));
    total += widths.back() + kLegendGap;
  }
  const double widest = std::ranges::max(widths);
  const auto columns =
      static_cast<std::size_t>(std::max(1.0, std::floor((width + kLegendGap) / (widest + kLegendGap))));
  double left = 0;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    LineEntry& entry = (*entries)[i];
    entry.left = total <= width ? left : static_cast<double>(i % columns) * (widest + kLegendGap);
    entry.row = total <= width ? 0 : static_cast<int>(i / columns);
    left += widths[i] + kLegendGap;
  }
}

// All of the figure but its drawing.
struct Layout {
  std::vector<PanelContent> contents;
  std::vector<Plot> plots;        // one a content
  std::vector<LineStyle> styles;  // one a run
  std::vector<LineEntry> legend;
  double legend_left = 0;
  double height = 0;

  Layout(std::span<const Evaluation> evaluations, std::vector<PanelContent> panels) : contents(std::move(panels)) {
    const Measure measure;
    const Axis frames = FrameAxis(evaluations);
    double tick_width = 0;
    for (const PanelContent& content : contents) {
      plots.push_back({{}, frames, ValueAxis(content), content.label});
      for (const Tick& tick : plots.back().y.ticks) tick_width = std::max(tick_width, measure(tick.label, kTickText));
    }
    legend_left = kLeft;
    MakeLegend(evaluations, measure);
    const double left = kLeft + tick_width + kTickGap;
    double top = kTop + kLegendRow * (legend.back().row + 1) + kTickGap;
    for (Plot& plot : plots) {
      plot.area = {left, top, kPageWidth - left - kRight, kPanelHeight};
      top += kPanelHeight + kPanelGap;
    }
    height = top - kPanelGap + kBottom;
  }

 private:
  void MakeLegend(std::span<const Evaluation> evaluations, const Measure& measure) {
    const std::vector<std::string> names = ComparisonNames(evaluations);
    for (std::size_t i = 0; i < names.size(); ++i) {
      styles.push_back(StyleOfLine(i, names.size()));
      legend.push_back({names[i], styles.back()});
    }
    if (std::ranges::any_of(contents, [](const PanelContent& content) { return HasValue(content.nulls); }))
      legend.push_back({kNullName, std::nullopt});
    ArrangeLegend(measure, kPageWidth - legend_left - kRight, &legend);
  }
};

void DrawLegend(cairo_t* drawing, const Layout& layout) {
  for (const LineEntry& entry : layout.legend) {
    const double left = layout.legend_left + entry.left;
    const double middle = kTop + kLegendRow * (entry.row + 0.5);
    if (entry.style)
      DrawLineSample(drawing, left, middle, *entry.style);
    else
      DrawReferenceSample(drawing, left, middle);
    const double text_left = left + kSampleWidth + kSampleGap;
    DrawText(drawing, text_left, middle + 0.36 * kLabelText, kPageWidth - text_left, entry.text, kLabelText);
  }
}

void DrawPanel(cairo_t* drawing, const Plot& plot, const PanelContent& content, const std::vector<LineStyle>& styles) {
  DrawGrid(drawing, plot);
  for (const Stretches& null : content.nulls) DrawReference(drawing, plot, null);
  for (std::size_t i = 0; i < content.runs.size(); ++i) DrawLine(drawing, plot, content.runs[i], styles[i]);
  DrawAxes(drawing, plot, 0);
  for (std::size_t i = 0; i < content.runs.size(); ++i) DrawMarkers(drawing, plot, content.runs[i], styles[i]);
}

// The last `count` parts of a path.
std::string LastParts(const std::filesystem::path& path, std::size_t count) {
  const std::vector<std::filesystem::path> parts(path.begin(), path.end());
  std::filesystem::path last;
  for (std::size_t i = parts.size() - std::min(count, parts.size()); i < parts.size(); ++i) last /= parts[i];
  return last.string();
}

}  // namespace

std::vector<std::string> ComparisonNames(std::span<const Evaluation> evaluations) {
  std::vector<std::filesystem::path> paths;
  for (const Evaluation& evaluation : evaluations) {
    const auto path = std::filesystem::path(evaluation.run).lexically_normal();
    paths.push_back(path.has_filename() ? path : path.parent_path());
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto same = static_cast<std::size_t>(std::ranges::count(paths, paths[i]));
    std::size_t parts = 1;
    const auto is_shared = [&] {
      const auto count = std::ranges::count(paths, LastParts(paths[i], parts),
                                            [&](const auto& path) { return LastParts(path, parts); });
      return static_cast<std::size_t>(count) > same;
    };
    while (is_shared() && LastParts(paths[i], parts) != paths[i].string()) ++parts;
    names.push_back(LastParts(paths[i], parts));
    const auto before = std::count(paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(i), paths[i]);
    if (same > 1) names.back() += " (" + std::to_string(before + 1) + ")";
  }
  return names;
}

Status WriteComparisonFigure(std::span<const Evaluation> evaluations, const std::string& output_path) {
  if (Status status = CheckEnding(ViewOutput::kFigure, output_path); !status.ok()) return status;
  std::vector<PanelContent> panels = PanelsOf(evaluations);
  if (panels.empty())
    return {ErrorCode::kInsufficient,
            "there is nothing to draw: no run has a surface error, a camera error or a point in any frame"};
  const Layout layout(evaluations, std::move(panels));
  const double scale = std::filesystem::path(output_path).extension() == ".png" ? kPngScale : 1;
  return WritePicture(output_path, scale * kPageWidth, scale * layout.height, [&](cairo_t* drawing) {
    cairo_scale(drawing, scale, scale);
    UseExactText(drawing);
    DrawLegend(drawing, layout);
    for (std::size_t i = 0; i < layout.plots.size(); ++i)
      DrawPanel(drawing, layout.plots[i], layout.contents[i], layout.styles);
    DrawXLabels(drawing, layout.plots.back(), "frame");
    return Status::Ok();
  });
}

}  // namespace pliant
