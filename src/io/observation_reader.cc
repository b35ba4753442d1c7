// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "io/run_format.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/io/run_reader.h"

namespace pliant {
namespace {

struct Row {
  int frame_idx = 0;
  PointObservation observation;
};

// Empty: the row is right; else what is wrong with it.
std::string ParseRow(std::string_view line, std::string_view columns, Row* row) {
  // Millions of rows are read: the fields stay on the stack.
  std::array<std::string_view, 8> fields;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin <= line.size(); ++count) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    if (count < fields.size()) fields[count] = line.substr(begin, end - begin);
    begin = end + 1;
  }
  const std::size_t needed = columns == kObservationColumns ? 8 : 7;
  if (count != needed)
    return "a row has " + std::to_string(needed) + " columns (" + std::string(columns) + "), this one has " +
           std::to_string(count);
  PointObservation& o = row->observation;
  if (!ParseInt(fields[0], &row->frame_idx) || row->frame_idx < 0)
    return Quoted(fields[0]) + " is not a frame's number";
  if (!ParseInt64(fields[1], &o.id.value) || o.id.value < 0) return Quoted(fields[1]) + " is not a point's id";
  const std::array<double*, 6> numbers = {&o.pixel.x(),    &o.pixel.y(),    &o.position.x(),
                                          &o.position.y(), &o.position.z(), &o.ssim};
  o.ssim = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i + 2 < needed; ++i)
    if (!ParseFinite(fields[i + 2], numbers[i]))
      return Quoted(fields[i + 2]) + " is not a finite number; leave out points that have no position";
  return {};
}

}  // namespace

struct ObservationReader::State {
  LineReader lines;
  std::string_view columns;
  bool ours = false;                        // ours end every line, so an open one was cut
  std::optional<Row> ahead = std::nullopt;  // the next frame's first row
  int last_frame_idx = -1;
  int cut_lines = 0;
};

ObservationReader::ObservationReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
ObservationReader::ObservationReader(ObservationReader&&) noexcept = default;
ObservationReader& ObservationReader::operator=(ObservationReader&&) noexcept = default;
ObservationReader::~ObservationReader() = default;

Result<ObservationReader> ObservationReader::Open(const std::string& path) {
  auto lines = LineReader::Open(path + "/observations.csv");
  if (!lines.ok()) return lines.status();
  std::string_view header;
  std::error_code error;
  const bool ours = std::filesystem::exists(path + "/run.json", error);
  const bool cut = !lines->Next(&header) || (ours && !lines->ended());  // killed before the first row
  const std::string_view columns =
      header == kObservationColumnsWithoutSsim ? kObservationColumnsWithoutSsim : kObservationColumns;
  if (!cut && header != columns)
    return lines->Error("the first line must be " + Quoted(kObservationColumns) + "; ssim may be missing");
  return ObservationReader(std::make_unique<State>(State{std::move(lines).value(), columns, ours}));
}

Result<std::optional<FrameObservations>> ObservationReader::Next() {
  std::optional<FrameObservations> frame;
  if (state_->ahead) {
    frame = FrameObservations{state_->ahead->frame_idx, {state_->ahead->observation}};
    state_->ahead.reset();
  }
  for (std::string_view line; state_->lines.Next(&line);) {
    if (state_->ours && !state_->lines.ended()) {
      ++state_->cut_lines;
      break;
    }
    Row row;
    if (const std::string wrong = ParseRow(line, state_->columns, &row); !wrong.empty())
      return state_->lines.Error(wrong);
    if (frame && row.frame_idx == frame->frame_idx) {
      if (!(row.observation.id > frame->observations.back().id))
        return state_->lines.Error("point " + std::to_string(row.observation.id.value) +
                                   " comes twice or out of order in its frame; sort rows by frame and point_id");
      frame->observations.push_back(row.observation);
      continue;
    }
    if (row.frame_idx <= state_->last_frame_idx)
      return state_->lines.Error("frame " + std::to_string(row.frame_idx) + " comes after frame " +
                                 std::to_string(state_->last_frame_idx) + "; sort rows by frame and point_id");
    state_->last_frame_idx = row.frame_idx;
    if (frame) {
      state_->ahead = row;
      break;
    }
    frame = FrameObservations{row.frame_idx, {row.observation}};
  }
  return frame;
}

int ObservationReader::cut_lines() const { return state_->cut_lines; }

Status ForEachFrame(const std::string& run_path, std::span<const int> frames_idx,
                    const ObservationsFunction& function) {
  auto reader = ObservationReader::Open(run_path);
  if (!reader.ok()) return reader.status();
  const std::vector<PointObservation> none;
  std::optional<FrameObservations> rows;
  bool ended = false;
  for (std::size_t k = 0; k < frames_idx.size(); ++k) {
    while (!ended && (!rows || rows->frame_idx < frames_idx[k])) {
      auto next = reader->Next();
      if (!next.ok()) return next.status();
      rows = std::move(next).value();
      ended = !rows.has_value();
    }
    const bool has_rows = rows && rows->frame_idx == frames_idx[k];
    if (Status status = function(k, has_rows ? std::as_const(rows->observations) : none); !status.ok()) return status;
  }
  return Status::Ok();
}

}  // namespace pliant
