// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What someone needs to find out why a run became what it is, small enough to be sent: a folder with the run's options,
// run.json, frames.csv and trajectory, the calibration and the versions of everything. The folders and names of files
// are left out of the texts, and there are no images, unless they are asked for.
#pragma once

#include <string>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/status.h"
#include "pliant/base/version.h"

namespace pliant {

enum class BundledImages { kNone, kSome };

struct BundleRequest {
  std::string run_path;            // also of a run that failed, or never had a map
  std::string output_path;         // folder; made if need be
  std::string sequence_path = {};  // empty: the one that run.json names
  std::string camera_path = {};    // of the sequence; may be empty
  BundledImages images = BundledImages::kNone;
  std::string program_version = kVersion;  // of the calling program, as it says it
  bool replaces_bundle = false;            // one that is in output_path; what else is there stays
};

inline constexpr int kMaxBundledImages = 10;
inline constexpr double kMaxBundleMegabytes = 5;

struct BundleSummary {
  std::vector<std::string> files;  // by name, in the folder
  double megabytes = 0;            // at most kMaxBundleMegabytes
  std::vector<std::string> notes;  // what is missing, one sentence each
};

// All files appear together, or none. Fails with kNotFound where `run_path` holds no run.json, with kInvalidArgument
// where the folder holds a bundle that is to stay, or other files of these names, kUnreadable and kUnwritable. Images
// that are missing are a note. `progress` is told of the files (task "bundle") and of the images that are gone through
// ("images"); where it asks to stop nothing is written: kInterrupted.
Result<BundleSummary> WriteBundle(const BundleRequest& request, const JobProgress& progress = {});

// `text` without the folders and names of files: what stands in single quotes and has a /, and a word that begins with
// a / or has one and an ending, become <path> with that ending: "<path>.mp4".
std::string WithoutPaths(const std::string& text);

}  // namespace pliant
