// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracker's parts keep, as a program's state (pliant/base/state_archive.h).
#pragma once

#include "pliant/scene/serialize.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/prepared_frame.h"
#include "tracking/bootstrapping/first_map.h"
#include "tracking/map_upkeep/replace_map.h"
#include "tracking/submap/candidates.h"

namespace pliant {

// Without what is known beforehand, which only the frame that is processed needs.
void Serialize(StateArchive& archive, PreparedFrame& frame);
void Serialize(StateArchive& archive, InitObservation& observation);
void Serialize(StateArchive& archive, InitFrame& frame);
void Serialize(StateArchive& archive, InitPoint& point);
void Serialize(StateArchive& archive, InitPosition& position);
void Serialize(StateArchive& archive, InitFrameState& frame);
void Serialize(StateArchive& archive, InitRejectedPoint& point);
void Serialize(StateArchive& archive, InitMeasurements& measured);
void Serialize(StateArchive& archive, InitOutcome& outcome);
void Serialize(StateArchive& archive, FirstMap& first);
void Serialize(StateArchive& archive, MapInFrame& then);
void Serialize(StateArchive& archive, CandidateTrack& track);

}  // namespace pliant
