// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/options.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "pliant/base/text.h"

namespace pliant {

// NOLINTNEXTLINE(readability-function-size): a line an option
void SimulationOptions::List(OptionTable& table) {
  table.BeginGroup("Scene", "what is filmed");
  table.AddChoice("kind", &scene.kind,
                  "colon with folds, smooth tube, sheet, two lobes, a mesh file, or a calibration board");
  table.Add("seed", &scene.seed, "-", "of everything random: folds, texture, tremor, noise", 0, 1 << 30);
  table.Add("radius_mm", &scene.radius_mm, "mm", "radius of the lumen without its folds", 5, 200);
  table.Add("length_mm", &scene.length_mm, "mm", "of the tube or sheet; 0: the camera's path and view_mm more", 0,
            20000);
  table.Add("view_mm", &scene.view_mm, "mm", "tube or sheet that lies ahead of the last camera", 20, 2000);
  table.Add("bend_deg_per_cm", &scene.bend_deg_per_cm, "deg/cm", "largest bending in each plane", 0, 15);
  table.Add("fold_depth_mm", &scene.fold_depth_mm, "mm", "how far a typical fold stands into the lumen", 0, 100);
  table.Add("fold_spacing_mm", &scene.fold_spacing_mm, "mm", "mean distance of the rings of folds", 3, 500);
  table.Add("relief_mm", &scene.relief_mm, "mm", "uneven wall, about its standard deviation", 0, 20);
  table.Add("width_mm", &scene.width_mm, "mm", "surface, lobes: of the sheet across the camera's path", 20, 2000);
  table.Add("lobe_step_mm", &scene.lobe_step_mm, "mm", "lobes: how far one lies above the other", 2, 60);
  table.Add("mesh_path", &scene.mesh_path, "FILE", "mesh: OBJ, PLY or STL; relative to the working folder");
  table.Add("mesh_scale", &scene.mesh_scale, "mm", "mesh: millimeters in a unit of the file", 1e-6, 1e6);
  table.Add("mesh_step_mm", &scene.mesh_step_mm, "mm", "longest edge of the mesh; facets must not be seen", 0.1, 20);
  table.Add("board", &scene.board, "-", "board: as pliant calibrate --board takes it");

  table.BeginGroup("Texture", "what is painted on the wall");
  table.Add("contrast", &texture.contrast, "-", "of mottling and vessels; 0: one color", 0, 4);
  table.Add("largest_mm", &texture.largest_mm, "mm", "longest wave of the mottling", 0.1, 500);
  table.Add("smallest_mm", &texture.smallest_mm, "mm", "shortest wave; two pixels or more keep corners stable", 0.05,
            500);
  table.Add("persistence", &texture.persistence, "-", "amplitude of an octave by the next longer one", 0.1, 1.5);
  table.Add("vessels", &texture.vessels, "-", "number of vessel trees; 1: one on 9 cm^2", 0, 20);
  table.Add("texel_mm", &texture.texel_mm, "mm", "of the map on the wall; below half of smallest_mm", 0.02, 10);

  table.BeginGroup("Deformation", "a wave V_y += A sin(omega t + 2 pi / wavelength (V_x + V_y + V_z)), breath, poke");
  table.Add("amplitude_mm", &deformation.amplitude_mm, "mm", "A; 0: no wave", 0, 50);
  table.Add("omega_rad_s", &deformation.omega_rad_s, "rad/s", "omega; 2.5 is a breath in 2.5 s", 0, 100);
  table.Add("wavelength_mm", &deformation.wavelength_mm, "mm", "200 pi reads the sine's argument in decimeters", 20,
            1e9);
  table.Add("breathing_mm", &deformation.breathing_mm, "mm", "swelling of the wall to each side of rest; 0: none", 0,
            50);
  table.Add("breathing_period_s", &deformation.breathing_period_s, "s", "of a breath", 0.05, 1000);
  table.Add("poke_mm", &deformation.poke_mm, "mm", "height of a bump pushed into the lumen; 0: none", -50, 50);
  table.Add("poke_radius_mm", &deformation.poke_radius_mm, "mm", "its standard deviation", 1, 500);
  table.Add("poke_period_s", &deformation.poke_period_s, "s", "from push to push; sine squared in between", 0.05, 1000);
  table.Add("poke_place", &deformation.poke_place, "mm",
            "x,y,z at rest; empty: what the first camera sees in the lower middle of its image");
  table.Add("lobe_share", &deformation.lobe_share, "-", "lobes: amplitudes of the upper by the lower one's", 0, 3);
  table.Add("lobe_phase_deg", &deformation.lobe_phase_deg, "deg", "lobes: the upper one is ahead by this", -360, 360);
  table.Add("lobe_direction_deg", &deformation.lobe_direction_deg, "deg",
            "lobes: direction of the upper one's wave, from y towards x", -180, 180);

  table.BeginGroup("Light", "one light at the camera");
  table.Add("ambient", &light.ambient, "-", "share of light that is reflected by the other walls", 0, 1);
  table.Add("specular", &light.specular, "-", "peak of the wet reflection, which a board has not; 0: none", 0, 1000);
  table.Add("roughness", &light.roughness, "-", "slope of the wet facets; larger: wider highlights", 0.01, 1);
  table.Add("unevenness_mm", &light.unevenness_mm, "mm", "of the wet film, by the mottling; breaks highlights up", 0,
            5);

  table.BeginGroup("Sensor", "from light to gray levels");
  table.Add("exposure", &sensor.exposure, "-", "linear level that the 90 % quantile is brought to; 1: white", 0.01, 2);
  table.Add("exposure_time_s", &sensor.exposure_time_s, "s", "time constant of the automatic exposure", 0, 1000);
  table.Add("gain_jitter", &sensor.gain_jitter, "-", "standard deviation of the gain between frames", 0, 0.3);
  table.Add("gamma", &sensor.gamma, "-", "level = linear^(1/gamma)", 0.5, 4);
  table.Add("noise_levels", &sensor.noise_levels, "-", "standard deviation of the noise, gray levels of 255", 0, 50);
  table.Add("read_noise", &sensor.read_noise, "-", "noise of linear light in the dark, share of white", 0, 0.5);
  table.Add("shot_noise", &sensor.shot_noise, "-",
            "noise of linear light at white, share of white; grows with the square root of the light", 0, 0.5);
  table.Add("noise_correlation_px", &sensor.noise_correlation_px, "px",
            "standard deviation of the Gaussian that smooths read and shot noise at unchanged variance; 0: white", 0,
            10);
  table.Add("sharpening", &sensor.sharpening, "-", "unsharp mask: share of the detail that is added; 0: none", 0, 5);
  table.Add("sharpening_px", &sensor.sharpening_px, "px", "unsharp mask: standard deviation of its blur", 0.3, 20);
  table.Add("blur_px", &sensor.blur_px, "px", "standard deviation of the lens's blur", 0, 20);
  table.Add("vignetting", &sensor.vignetting, "-", "share of light lost in the corners", 0, 1);
  table.Add("shutter_s", &sensor.shutter_s, "s", "motion blur: how long the shutter is open; 0: an instant", 0, 1);
  table.Add("readout_s", &sensor.readout_s, "s",
            "rolling shutter: last row by the first one; ground truth is that of the middle row; 0: all at once", 0, 1);
  table.AddChoice("interlaced", &sensor.interlaced,
                  "on: odd rows half a frame after even ones; ground truth is that of the time between them");
  table.Add("samples", &sensor.samples, "-", "rays a pixel, made a square number; depth is the center's", 1, 64);
  table.Add("depth_scale_mm", &sensor.depth_scale_mm, "mm", "one step of the 16-bit depth; range 65535 of them", 1e-4,
            1);
  table.Add("drops", &sensor.drops, "-", "drops of fluid on the lens at a time, on average; not part of the truth", 0,
            50);
  table.Add("debris", &sensor.debris, "-", "pieces that float before the lens, on average; not part of the truth", 0,
            200);

  table.BeginGroup("Recording", "from the camera to the files; ground truth is that of the recorded frames");
  table.Add("video_qp", &recording.video_qp, "-",
            "quantization parameter of a video codec on H.264's scale, 18 is good and 36 poor; 0: no video codec", 0,
            51);
  table.Add("key_frame_every", &recording.key_frame_every, "frames", "from one coded by itself to the next", 1,
            1000000);
  table.Add("jpeg_quality", &recording.jpeg_quality, "-",
            "of JPEG with half the chroma resolution, after the video codec; 0: no JPEG", 0, 100);
  table.Add("lost_share", &recording.lost_share, "-", "of the camera's frames that are not recorded", 0, 0.9);
  table.Add("lost_run", &recording.lost_run, "frames", "mean number of frames that are lost in a row", 1, 10000);
  table.Add("repeated_share", &recording.repeated_share, "-",
            "of the runs of lost frames that are filled with the frame before; the others leave a gap in time", 0, 1);

  table.BeginGroup("Interruption", "what blocks the view for a while; not part of the truth");
  table.Add("blackout_period_s", &interruption.blackout_period_s, "s", "from one to the next; 0: none", 0, 1e6);
  table.Add("blackout_s", &interruption.blackout_s, "s", "how long the image stays black", 0, 1e6);
  table.Add("tool_period_s", &interruption.tool_period_s, "s", "from one tool that passes to the next; 0: none", 0,
            1e6);
  table.Add("tool_s", &interruption.tool_s, "s", "how long it is in the image", 0, 1e6);
  table.Add("blur_period_s", &interruption.blur_period_s, "s", "from one loss of focus to the next; 0: none", 0, 1e6);
  table.Add("blur_s", &interruption.blur_s, "s", "how long it is out of focus", 0, 1e6);
  table.Add("blur_px", &interruption.blur_px, "px", "standard deviation of the blur", 0, 100);

  table.BeginGroup("Camera", "the camera that films");
  table.AddChoice("model", &camera.model, "projection");
  table.Add("width", &camera.width, "px", "of the image", 16, 8192);
  table.Add("height", &camera.height, "px", "of the image", 16, 8192);
  table.Add("horizontal_fov_deg", &camera.horizontal_fov_deg, "deg", "field of view where params is empty", 5, 230);
  table.Add("params", &camera.params, "px", "the model's parameters in COLMAP's order, e.g. 440,440,319.5,239.5");
  table.Add("baseline_mm", &camera.baseline_mm, "mm", "stereo: the right camera on the left one's x axis; 0: none", 0,
            100);

  table.BeginGroup("Trajectory", "the camera's way");
  table.AddChoice("kind", &trajectory.kind,
                  "forward, from side to side, on the spot, out and back, a file's poses, or views of a board");
  table.Add("frames", &trajectory.frames, "-", "number of frames of the camera", 1, 1000000);
  table.Add("fps", &trajectory.fps, "1/s", "frames a second", 0.01, 10000);
  table.Add("start_mm", &trajectory.start_mm, "mm", "first camera, along the scene's path", 0, 10000);
  table.Add("start_pose", &trajectory.start_pose, "mm",
            "first camera as tx,ty,tz,qx,qy,qz,qw (world_from_camera), then straight ahead; empty: along the scene's "
            "own path");
  table.Add("speed_mm_s", &trajectory.speed_mm_s, "mm/s", "insert: along the scene's path", 0, 1000);
  table.Add("look_ahead_mm", &trajectory.look_ahead_mm, "mm",
            "the camera looks at the centerline or sheet this far ahead", 1, 500);
  table.Add("height_mm", &trajectory.height_mm, "mm", "surface, lobes: of the camera's path over the sheet", 5, 500);
  table.Add("sway_amplitude_mm", &trajectory.sway_amplitude_mm, "mm", "sway: to each side", 0, 200);
  table.Add("sway_period_s", &trajectory.sway_period_s, "s", "sway: to both sides and back", 0.01, 1000);
  table.Add("sway_distance_mm", &trajectory.sway_distance_mm, "mm", "sway: to the point that stays in view", 5, 500);
  table.Add("loop_length_mm", &trajectory.loop_length_mm, "mm", "loop: how far out", 0, 1000);
  table.Add("loop_width_mm", &trajectory.loop_width_mm, "mm", "loop: to each side", 0, 200);
  table.Add("loop_period_s", &trajectory.loop_period_s, "s", "loop: out and back; 0: the whole sequence", 0, 10000);
  table.Add("view_s", &trajectory.view_s, "s",
            "board: from a view to the next; the camera stands still in each, so that 1 / view_s frames a second are "
            "photographs",
            0.01, 1000);
  table.Add("path", &trajectory.path, "FILE",
            "file: TUM lines, mm, s from the first frame; relative to the working folder");
  table.Add("tremor_mm", &trajectory.tremor_mm, "mm", "of the hand, about its standard deviation", 0, 20);
  table.Add("tremor_deg", &trajectory.tremor_deg, "deg", "of the hand, about its standard deviation", 0, 20);
  table.Add("clearance_mm", &trajectory.clearance_mm, "mm", "a camera nearer to the wall than this is an error", 0.1,
            100);

  table.BeginGroup("Simulation", "how it is computed");
  table.Add("threads", &threads, "-", "0: all; never changes the result", 0, 1024);
}

SimulationOptions MakeSimulationOptions(Realism realism) {
  SimulationOptions options;
  if (realism == Realism::kClean) return options;
  options.texture.contrast = 0.7;
  options.sensor.gain_jitter = 0.02;
  options.sensor.noise_levels = 0.5;
  options.sensor.read_noise = 0.0095;
  options.sensor.shot_noise = 0.02;
  options.sensor.noise_correlation_px = 0.7;  // a Bayer mosaic, interpolated
  options.sensor.sharpening = 0.7;
  options.sensor.shutter_s = 0.01;
  options.sensor.readout_s = 0.01;  // a CMOS chip at the tip
  options.sensor.drops = 2;
  options.sensor.debris = 15;
  options.recording.video_qp = 18;  // a recorder of good quality
  options.recording.key_frame_every = 12;
  options.recording.jpeg_quality = 80;  // frames taken out of the video
  options.recording.lost_share = 0.1;
  options.recording.lost_run = 3;
  return options;
}

std::string ToYaml(const SimulationOptions& options) {
  SimulationOptions copy = options;
  OptionTable table;
  copy.List(table);
  return table.ToYaml();
}

Result<Camera> SimulatedCamera(const SimulationOptions& options) {
  const SimulationOptions::CameraModel& camera = options.camera;
  std::vector<double> params;
  if (!camera.params.empty()) {
    const auto numbers = ParseNumbers(camera.params);
    if (!numbers)
      return {ErrorCode::kInvalidArgument,
              "Camera.params is '" + camera.params + "'; give numbers separated by commas"};
    return Camera::Create(camera.model, camera.width, camera.height, *numbers);
  }
  const double half_rad = 0.5 * camera.horizontal_fov_deg * std::numbers::pi / 180.0;
  const bool fisheye = camera.model == CameraModelId::kOpenCvFisheye;
  if (!fisheye && camera.horizontal_fov_deg > 170.0)
    return {ErrorCode::kInvalidArgument, "Camera.horizontal_fov_deg is " + FormatDouble(camera.horizontal_fov_deg) +
                                             "; beyond 170 degrees only OPENCV_FISHEYE sees"};
  const double focal = 0.5 * camera.width / (fisheye ? half_rad : std::tan(half_rad));
  const double cx = 0.5 * (camera.width - 1);
  const double cy = 0.5 * (camera.height - 1);
  const bool single_focal = camera.model == CameraModelId::kSimplePinhole ||
                            camera.model == CameraModelId::kSimpleRadial || camera.model == CameraModelId::kRadial;
  params = single_focal ? std::vector{focal, cx, cy} : std::vector{focal, focal, cx, cy};
  const std::size_t distortions = camera.model == CameraModelId::kSimpleRadial        ? 1
                                  : camera.model == CameraModelId::kRadial            ? 2
                                  : camera.model == CameraModelId::kOpenCv || fisheye ? 4
                                                                                      : 0;
  params.insert(params.end(), distortions, 0.0);
  return Camera::Create(camera.model, camera.width, camera.height, params);
}

}  // namespace pliant
