// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scene's values as a program's state (pliant/base/state_archive.h).
#pragma once

#include "pliant/base/ids.h"
#include "pliant/base/state_archive.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"

namespace pliant {

void Serialize(StateArchive& archive, PointId& id);
void Serialize(StateArchive& archive, Rigid3& b_from_a);
void Serialize(StateArchive& archive, Sim3& b_from_a);
void Serialize(StateArchive& archive, Landmark& landmark);
void Serialize(StateArchive& archive, Map& map);
void Serialize(StateArchive& archive, CostTerm& cost);
void Serialize(StateArchive& archive, PointObservation& observation);
void Serialize(StateArchive& archive, NewPoint& point);
void Serialize(StateArchive& archive, RefinedPoint& point);
void Serialize(StateArchive& archive, FirstMapEvidence& evidence);
void Serialize(StateArchive& archive, FirstMapFrames& frames);
void Serialize(StateArchive& archive, SubmapMerge& merge);
void Serialize(StateArchive& archive, FramePrior& prior);
void Serialize(StateArchive& archive, FrameReport& report);

}  // namespace pliant
