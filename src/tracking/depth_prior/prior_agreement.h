// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether a frame's depth prior says of points what else says their depths (docs/method.md, N4). One that is read as of
// the other kind falls where they grow.
#pragma once

#include <optional>
#include <span>

#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/image/brightness.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "tracking/depth_prior/prior_distances.h"

namespace pliant {

// `prior`: not aligned. The landmarks are seen in its frame. Nothing where fewer than twelve of them have a prior.
std::optional<PriorAgreement> AgreementWithMap(const PriorDistances& prior, const Camera& camera,
                                               std::span<const Landmark> landmarks, const Rigid3& cam_from_world);

// The same by the light of the camera.
std::optional<PriorAgreement> AgreementWithBrightness(const PriorDistances& prior, const Camera& camera,
                                                      std::span<const Landmark> landmarks,
                                                      const LocalBrightness& brightness,
                                                      const PhotometricCalibration& light);

}  // namespace pliant
