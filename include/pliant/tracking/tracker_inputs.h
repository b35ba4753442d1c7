// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracker may be given besides images; none of it is needed.
#pragma once

#include <optional>
#include <span>

#include "pliant/camera/assumed_camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/scene/pixel_track.h"
#include "pliant/tracking/extensions.h"
#include "pliant/tracking/tracks/oracle.h"

namespace pliant {

// Truth and tracks must outlive the tracker.
struct TrackerInputs {
  TrackingTruth* truth = nullptr;  // what the oracle switches ask; has to be there when one is on
  // Of another program, sorted by id, in pixels of the tracker's images: points are followed by them and not by our own
  // tracker. Empty: there are none.
  std::span<const PixelTrack> tracks = {};
  // Of the camera, where it is known; first maps that use the light then trust it.
  std::optional<PhotometricCalibration> photometric = std::nullopt;
  TrackerExtensions extensions = {};
  CameraOrigin camera_origin = CameraOrigin::kGiven;  // an assumed one is named where there is no first map
};

}  // namespace pliant
