// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/run_evaluation.h"

namespace pliant::cli {

void AddEvaluationArguments(CommandLine* line, std::string* camera_path) {
  line->AddAlias("protocol", "PointError.protocol", "paper|depth_trimmed|lmeds|all",
                 "how points are compared: one, several with commas, or all");
  line->AddAlias("scale", "PointError.scale", "per_frame|global|none",
                 "what a run is multiplied with: the best scale of each frame (the paper's protocol after a monocular "
                 "start), one for all frames, or nothing (runs in true millimeters)");
  line->AddAlias("parts", "Evaluation.parts", "surface|material|camera|first_map|tracks|all",
                 "what to compute: one, several with commas, or all; an error where there is no truth for it. Without "
                 "it, all that there is truth for");
  line->Add("camera", camera_path, "FILE",
            "calibration of the sequence; not needed where it has its own, or for the run's images", Need::kOptional);
}

}  // namespace pliant::cli
