// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
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

// Where the columns that may be missing stand; nothing: they are missing.
struct OptionalColumns {
  std::size_t count = 0;  // of all columns
  std::optional<std::size_t> ssim;
  std::optional<std::size_t> sigma;
};

// Nothing: it is no header of observations.csv.
std::optional<OptionalColumns> ParseHeader(std::string_view header) {
  if (!header.starts_with(kNeededObservationColumns)) return std::nullopt;
  const std::vector<std::string_view> names = Split(header, ',');
  if (names.size() < kNeededObservationColumnCount || names[kNeededObservationColumnCount - 1] != "z")
    return std::nullopt;
  OptionalColumns columns;
  columns.count = names.size();
  for (std::size_t i = kNeededObservationColumnCount; i < names.size(); ++i) {
    if (names[i] == kSsimColumn) columns.ssim = i;
    if (names[i] == kSigmaColumn) columns.sigma = i;
  }
  return columns;
}

// Empty: the row is right; else what is wrong with it.
std::string ParseRow(std::string_view line, const OptionalColumns& columns, Row* row) {
  // Millions of rows are read: the fields stay on the stack.
  std::array<std::string_view, kNeededObservationColumnCount> fields;
  std::string_view ssim;
  std::string_view sigma;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin <= line.size(); ++count) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    const std::string_view field = line.substr(begin, end - begin);
    if (count < fields.size()) fields[count] = field;
    if (count == columns.ssim) ssim = field;
    if (count == columns.sigma) sigma = field;
    begin = end + 1;
  }
  if (count != columns.count)
    return "a row has " + std::to_string(columns.count) + " columns, as the first line, this one has " +
           std::to_string(count);
  PointObservation& o = row->observation;
  if (!ParseInt(fields[0], &row->frame_idx) || row->frame_idx < 0)
    return Quoted(fields[0]) + " is not a frame's number";
  if (!ParseInt64(fields[1], &o.id.value) || o.id.value < 0) return Quoted(fields[1]) + " is not a point's id";
  const std::array<double*, 5> numbers = {&o.pixel.x(), &o.pixel.y(), &o.position.x(), &o.position.y(),
                                          &o.position.z()};
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!ParseFinite(fields[i + 2], numbers[i]))
      return Quoted(fields[i + 2]) + " is not a finite number; leave out points that have no position";
  o.ssim = std::numeric_limits<double>::quiet_NaN();
  if (columns.ssim && !ParseFinite(ssim, &o.ssim)) return Quoted(ssim) + " is not a finite number, as ssim must be";
  if (columns.sigma && (!ParseFinite(sigma, &o.sigma) || o.sigma < 0))
    return Quoted(sigma) + " is not a standard deviation; write 0 where it is not known";
  return {};
}

}  // namespace

struct ObservationReader::State {
  LineReader lines;
  OptionalColumns columns;
  bool ours = false;                        // ours end every line, so an open one was cut
  std::optional<Row> ahead = std::nullopt;  // the next frame's first row
  // Read by Of, which was asked for a frame before it.
  std::optional<FrameObservations> later = std::nullopt;
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
  if (Status status = lines->End(); !status.ok()) return status;
  std::optional<OptionalColumns> columns = ParseHeader(header);
  if (!cut && !columns)
    return lines->Error("the first line must begin with " + Quoted(kNeededObservationColumns) +
                        "; ssim and sigma_mm may follow");
  return ObservationReader(
      std::make_unique<State>(State{std::move(lines).value(), columns.value_or(OptionalColumns{}), ours}));
}

Result<std::optional<FrameObservations>> ObservationReader::Next() {
  if (state_->later) return std::exchange(state_->later, std::nullopt);
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
  if (Status status = state_->lines.End(); !status.ok()) return status;
  return frame;
}

Result<std::vector<PointObservation>> ObservationReader::Of(int frame_idx) {
  while (true) {
    auto frame = Next();
    if (!frame.ok()) return frame.status();
    if (!*frame) return std::vector<PointObservation>();
    if ((*frame)->frame_idx == frame_idx) return std::move((*frame)->observations);
    if ((*frame)->frame_idx > frame_idx) {
      state_->later = *std::move(frame);
      return std::vector<PointObservation>();
    }
  }
}

int ObservationReader::cut_lines() const { return state_->cut_lines; }

Status ForEachFrame(const std::string& run_path, std::span<const int> frames_idx,
                    const ObservationsFunction& function) {
  auto reader = ObservationReader::Open(run_path);
  if (!reader.ok()) return reader.status();
  for (std::size_t k = 0; k < frames_idx.size(); ++k) {
    const auto observations = reader->Of(frames_idx[k]);
    if (!observations.ok()) return observations.status();
    if (Status status = function(k, *observations); !status.ok()) return status;
  }
  return Status::Ok();
}

}  // namespace pliant
