// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/serialize.h"

#include "pliant/image/serialize.h"

namespace pliant {

void Serialize(StateArchive& archive, PreparedFrame& frame) {
  auto& [frame_idx, step, name, timestamp_s, image, gray, pyramid, mask, known_depth_mm, depth_prior, known_points,
         sharpness, prepare_ms] = frame;
  archive(frame_idx, step, name, timestamp_s, image, gray, pyramid, mask, depth_prior, sharpness, prepare_ms);
}

void Serialize(StateArchive& archive, InitObservation& observation) { archive.Members<6>(observation); }
void Serialize(StateArchive& archive, InitFrame& frame) { archive.Members<2>(frame); }
void Serialize(StateArchive& archive, InitPoint& point) { archive.Members<4>(point); }
void Serialize(StateArchive& archive, InitPosition& position) { archive.Members<2>(position); }
void Serialize(StateArchive& archive, InitFrameState& frame) { archive.Members<3>(frame); }
void Serialize(StateArchive& archive, InitRejectedPoint& point) { archive.Members<2>(point); }
void Serialize(StateArchive& archive, InitMeasurements& measured) { archive.Members<11>(measured); }
void Serialize(StateArchive& archive, InitOutcome& outcome) { archive.Members<15>(outcome); }
void Serialize(StateArchive& archive, FirstMap& first) { archive.Members<2>(first); }
void Serialize(StateArchive& archive, MapInFrame& then) { archive.Members<2>(then); }
void Serialize(StateArchive& archive, CandidateTrack& track) { archive.Members<5>(track); }

}  // namespace pliant
