// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The sequence that a run was made of.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/sequence.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"

namespace pliant {

// The images at `sequence_path`, or, where that is empty, those that run.json in `run_path` names, with the calibration
// at `camera_path`. The run's calibration, or the camera of its model where that is gone, is a spare one: it serves
// where the images have none that fits. Where the images are those that run.json names, the run's masks are used, if
// they are still there. The frames that the run was asked for. An empty image_path: nothing says which images the run
// is of.
SequenceRequest SequenceOfRun(const std::string& run_path, const std::filesystem::path& sequence_path = {},
                              const std::filesystem::path& camera_path = {});

// The camera, the names of the images and the points of `run`, which was read from `run_path`: by its sparse/, or,
// where there is none (a killed run), camera and names by its sequence. Fails as ReadRunMap and OpenSequence do, with
// kNotFound where neither is there, and with kMismatch where the calibration that was given (SequenceOfRun) is another
// one than that of sparse/.
Result<RunMap> KnownMapOfRun(const std::string& run_path, const SequenceRequest& sequence, const Run& run);

// Fails with kMismatch where no calibration was given and the images have another one of the same size, `of_images`,
// than the run was tracked with. The images that run.json names may have one that was not used: where it names another
// one, or does not say whether the run is metric, as those of other programs, which have their own.
Status CheckCameraOfImages(const SequenceRequest& request, const Run& run, const Camera& of_run,
                           const Camera& of_images);

// Fails with kNotFound where the run was tracked with masks and `request` names none: without them instruments would be
// taken for the scene.
Status CheckMasksOfRun(const SequenceRequest& request, const Run& run);

// The images of the run at `run_path`: what SequenceOfRun says. Fails with kNotFound where that names none, or they are
// not there, and as OpenSequence does.
Result<std::unique_ptr<Sequence>> OpenImagesOfRun(const std::string& run_path, const SequenceRequest& request);

// Reads on to a frame of a run that has this camera, and calls the frame's image `name` (empty: not known). Fails as
// Sequence, and with kMismatch where the images are not those of the run: they end before it, leave it out, have
// another size or another name.
Result<SequenceFrame> NextFrameOfRun(const Camera& camera, int frame_idx, const std::string& name, Sequence* sequence);

}  // namespace pliant
