// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <iostream>

#include <pliant/pipeline/track.h>

struct PrintPoints : pliant::TrackObserver {
  void OnStart(int frames) override { std::cout << frames << " frames\n"; }
  void OnFrame(const pliant::FrameReport& frame) override {
    for (const pliant::PointObservation& point : frame.observations)
      std::cout << frame.frame_idx << " " << point.id.value << " " << point.position.transpose() << "\n";
  }
};

int main(int, char** argv) {  // a folder with images/ and camera.yaml, and the run folder to make
  pliant::RunRequest request;
  request.input.image_path = argv[1];
  request.output_path = argv[2];
  PrintPoints print;
  const auto run = pliant::RunTrack(request, pliant::MakeTrackOptions(pliant::Preset::kDefault),
                                    std::array<pliant::TrackObserver*, 1>{&print});
  const pliant::Status end = run.ok() ? pliant::EndOf(*run, request.output_path) : run.status();
  std::cout << (end.ok() ? run->note : end.message()) << std::endl;
  return end.ok() ? 0 : 1;
}
