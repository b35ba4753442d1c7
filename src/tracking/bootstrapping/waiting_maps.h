// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps that an initializer made and that are not taken yet, because a better one may come: the best provisional one
// since the reference, and the best weak one of references that were given up.
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

class WaitingMaps {
 public:
  // A frame came.
  void CountFrame();
  // Puts a map of the present reference aside: the one whose depths stand out most from their uncertainty is kept, or
  // the one that knows of a deformation.
  void Put(MadeMap made);
  // Whether there is a map, of the present reference or a weak one, that is better than this one.
  bool HasBetterThan(const InitOutcome& map) const;
  // The present reference is given up, after so many frames: the map to take now, if there is one. A weak one stays
  // here for up to `max_frames` frames, counted from the first reference that had one.
  std::optional<MadeMap> GiveUpReference(int reference_frames, int max_frames);
  // No frame will follow: the best of all becomes one of the present reference.
  void EndWait();
  // The best map of the present reference, or nothing; it is no longer here.
  std::optional<MadeMap> Take();
  // Camera and scene cannot be told apart: what is less certain is no answer then, nor is anything of this reference if
  // the camera may stand still. A map of an earlier one that a part of its frames alone made weak (W21) stays.
  void Doubt(bool camera_may_stand_still);
  void DropReference();
  void DropAll();

  bool IsEmpty() const { return !of_reference_ && !weak_; }
  // The first frame of the weak map that waits.
  std::optional<int> WeakSince() const;

  void Serialize(StateArchive& archive);

 private:
  std::optional<MadeMap> of_reference_;
  std::optional<MadeMap> weak_;
  int weak_frames_ = 0;  // since the first of the references that had a weak map
};

}  // namespace pliant
