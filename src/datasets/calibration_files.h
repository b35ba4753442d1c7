// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Calibrations as other people's tools write them, besides those that io reads.
#pragma once

#include <filesystem>
#include <optional>

#include "datasets/data_set.h"
#include "pliant/base/status.h"

namespace pliant {

// Calibu's XML of one camera, such as Endomapper's *_geometrical.xml, with response, vignetting and light of the only
// *_photometrical.xml beside it. Nothing for an XML file that has no camera_model of a type. Fails with kUnreadable,
// and with kInvalidArgument for a model that is not known.
Result<std::optional<SourceCalibration>> ReadCalibu(const std::filesystem::path& file);
// Of such a *_photometrical.xml. Fails with kUnreadable.
Result<PhotometricCalibration> ReadCalibuPhotometry(const std::filesystem::path& file);

// StereoMIS's StereoCalibration.ini, two cameras, baseline in meters or millimeters. Fails with kUnreadable.
Result<StereoCalibration> ReadStereoIni(const std::filesystem::path& file);

}  // namespace pliant
