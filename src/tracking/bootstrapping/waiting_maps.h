// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps that an initializer made and that are not taken yet, because a better one may come: the best provisional one of
// a reference, and the best weak one of references that were given up.
#pragma once

#include <optional>

#include "pliant/base/state_archive.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/prepared_frame.h"
#include "tracking/bootstrapping/first_map.h"

namespace pliant {

// A map, and the frame that it is of.
struct MadeMap {
  FirstMap map;
  PreparedFrame frame;
  void Serialize(StateArchive& archive);
};

// (W15) Whether a map is of a window that deforms, and hardly better than one constant depth: not certain by its own
// sigmas, and by those of a part of its frames (W21) not even provisional. It waits for what later references give.
bool IsWeak(const InitOutcome& map);

// Puts a map aside: of two, the one whose depths stand out most from their uncertainty is kept, or the one that knows
// of a deformation.
void PutAside(MadeMap made, std::optional<MadeMap>* best);
// Camera and scene cannot be told apart by a reference: what is less certain is no answer then, nor is anything of it
// if the camera may stand still.
void Doubt(bool camera_may_stand_still, std::optional<MadeMap>* of_reference);
// (W20) A camera that stands still explains the frames of another reference as well, which overlap with this one's: a
// map of a rigid window, whose sigmas know nothing of a deformation, is no answer then.
void DoubtRigidity(std::optional<MadeMap>* of_reference);

// The best weak map. In what follows `of_reference` is the map that a reference put aside, if there is one.
class WeakMap {
 public:
  // A frame came.
  void CountFrame();
  // Whether this one, or that of the reference, is better than `map`.
  bool HasBetterThan(const InitOutcome& map, const std::optional<MadeMap>& of_reference) const;
  // A reference is given up, after so many frames: the map to take now, if there is one. A weak one stays here for up
  // to `max_frames` frames, counted from the first reference that had one.
  std::optional<MadeMap> GiveUpReference(std::optional<MadeMap> of_reference, int reference_frames, int max_frames);
  // None waits any longer: the best of all.
  std::optional<MadeMap> EndWait(std::optional<MadeMap> of_reference);
  // Camera and scene cannot be told apart. One that a part of its frames alone made weak (W21) stays.
  void Doubt();
  void Drop() { weak_.reset(); }

  bool IsThere() const { return weak_.has_value(); }
  // Its first frame.
  std::optional<int> Since() const;

  void Serialize(StateArchive& archive);

 private:
  std::optional<MadeMap> weak_;
  int frames_ = 0;  // since the first of the references that had one
};

}  // namespace pliant
