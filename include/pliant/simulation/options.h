// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is simulated: a scene that deforms, a camera with a light on its way through it, and a sensor. Every number
// that a sequence depends on is one of these options; they are written beside it (simulation.yaml) and give it back.
// World frame: millimeters, x right, y down. The camera's way starts at the origin and leaves it along +z: the
// centerline of `colon` and `tube`, a straight line over the sheet of `surface` and `lobes` (which lies below it, at
// larger y). In `mesh` it is the file's own frame, scaled; in `board` that of CalibrationBoard.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"

namespace pliant {

enum class SceneKind {
  kColon,    // a bent tube with incomplete rings of folds, a three-cornered section and relief
  kTube,     // the same bent tube with a round, smooth wall
  kSurface,  // one smooth organ seen from outside: a curved sheet with relief
  kLobes,    // two lobes, one over the edge of the other with a step between them; each deforms by its own wave
  kMesh,     // a mesh from a file: OBJ, PLY, STL
  kBoard,    // a flat board for calibration
};
template <>
struct EnumNames<SceneKind> {
  static constexpr std::array kNames = {std::pair{SceneKind::kColon, std::string_view("colon")},
                                        std::pair{SceneKind::kTube, std::string_view("tube")},
                                        std::pair{SceneKind::kSurface, std::string_view("surface")},
                                        std::pair{SceneKind::kLobes, std::string_view("lobes")},
                                        std::pair{SceneKind::kMesh, std::string_view("mesh")},
                                        std::pair{SceneKind::kBoard, std::string_view("board")}};
};

enum class TrajectoryKind {
  kInsert,  // forward along the scene's way
  kSway,    // from side to side on an arc around a point of the wall ahead, which stays in view
  kHold,    // on the spot
  kLoop,    // forward and back on a closed curve; the last frame's camera is the first one's
  kFile,    // the poses of a file
  kBoard,   // from view to view of a board, all of it in the image
};
template <>
struct EnumNames<TrajectoryKind> {
  static constexpr std::array kNames = {std::pair{TrajectoryKind::kInsert, std::string_view("insert")},
                                        std::pair{TrajectoryKind::kSway, std::string_view("sway")},
                                        std::pair{TrajectoryKind::kHold, std::string_view("hold")},
                                        std::pair{TrajectoryKind::kLoop, std::string_view("loop")},
                                        std::pair{TrajectoryKind::kFile, std::string_view("file")},
                                        std::pair{TrajectoryKind::kBoard, std::string_view("board")}};
};

// How a sequence looks (MakeSimulationOptions).
enum class Realism {
  kClean,      // little noise, no traces of processing and recording
  kEndoscope,  // noise, sharpening, compression and lost frames as real endoscopic recordings have them
};
template <>
struct EnumNames<Realism> {
  static constexpr std::array kNames = {std::pair{Realism::kClean, std::string_view("clean")},
                                        std::pair{Realism::kEndoscope, std::string_view("endoscope")}};
};

struct SimulationOptions {
  struct Scene {
    SceneKind kind = SceneKind::kColon;
    int seed = 1;                   // of everything that is drawn: folds, texture, tremor, noise
    double radius_mm = 25.0;        // of the lumen, folds left out
    double length_mm = 0.0;         // of the tube or sheet; 0: the way of the camera and view_mm more
    double view_mm = 230.0;         // how much of it lies ahead of the last camera
    double bend_deg_per_cm = 4.0;   // largest bending of the centerline, in each of the two planes
    double fold_depth_mm = 5.5;     // how far a typical fold stands into the lumen
    double fold_spacing_mm = 26.0;  // between rings of folds, in the mean
    double relief_mm = 0.5;         // uneven wall, standard deviation of about
    double width_mm = 220.0;        // surface, lobes: of the sheet, across the camera's way
    double lobe_step_mm = 12.0;     // lobes: how far one lies above the other
    std::string mesh_path;          // mesh: the file; written absolute beside a sequence
    double mesh_scale = 1.0;        // mesh: millimeters in a unit of the file
    double mesh_step_mm = 0.4;      // edge of the mesh, also of one that is read; finer where folds are steep
    // board: as ParseBoard reads it
    std::string board = "chessboard:9x6:3";
  } scene;

  struct Texture {
    double contrast = 1.0;      // 0: one color
    double largest_mm = 12.0;   // longest wave of the mottling
    double smallest_mm = 0.3;   // shortest wave: about two pixels at 60 mm
    double persistence = 0.95;  // amplitude of an octave by the one before
    double vessels = 1.0;       // number of vessel trees, 1: one on 9 cm^2
    double texel_mm = 0.08;     // of the map that the wall carries
  } texture;

  // The displacement of the material point that is V at rest is the sum of three (docs/method.md, section "The
  // simulated scene"):
  //   the wave      d A sin(omega t + 2 pi / wavelength (V_x + V_y + V_z)),   d = e_y
  //   breathing     B sin(2 pi t / period) (V - C) / R,  C the position it swells from (the centerline), R the radius
  //   the poke      n P sin^2(pi t / period) exp(-|V - Q|^2 / (2 radius^2)),  n into the lumen at Q
  // Source of the wave: Gomez Rodriguez, Montiel, Tardos, IROS 2022; 200 pi mm reads V in decimeters.
  struct Deformation {
    double amplitude_mm = 0.0;  // A; 0: no wave
    double omega_rad_s = 2.5;
    double wavelength_mm = 628.3185307179587;
    double breathing_mm = 0.0;  // B; 0: no breathing
    double breathing_period_s = 4.0;
    double poke_mm = 0.0;  // P; negative: pulled out; 0: no poke
    double poke_radius_mm = 12.0;
    double poke_period_s = 2.0;
    std::string poke_place;            // Q as x,y,z; empty: what the first camera sees in the lower middle of its image
    double lobe_share = 0.7;           // lobes: amplitudes of the upper one by the lower one's
    double lobe_phase_deg = 110.0;     // lobes: how far the upper one is ahead in wave and breath
    double lobe_direction_deg = 40.0;  // lobes: d of the upper one's wave, turned from y towards x
  } deformation;

  struct Light {
    double ambient = 0.1;         // light that reaches the wall from the rest of the wall, as a share
    double specular = 1.3;        // peak of the wet reflection by the diffuse one; 0: none
    double roughness = 0.1;       // width of the wet reflection: slope of the facets
    double unevenness_mm = 0.12;  // breaks highlights up: height of the wet film by the mottling, of no visible depth
  } light;

  struct Sensor {
    double exposure = 0.6;         // linear level (1: white) that the 90 % quantile of the image is brought to
    double exposure_time_s = 0.5;  // time constant with which the exposure follows
    double gain_jitter = 0.01;     // standard deviation of the gain from frame to frame, as a share
    double gamma = 2.2;
    double noise_levels = 1.5;  // standard deviation in gray levels of 255
    // Noise of the light itself, before gamma: variance read_noise^2 + shot_noise^2 l at the linear level l (1: white).
    double read_noise = 0.0;            // share of white
    double shot_noise = 0.0;            // standard deviation at white, share of white
    double noise_correlation_px = 0.0;  // standard deviation of the Gaussian that smooths read and shot noise: what
                                        // demosaicing and denoising leave; their variance stays
    double sharpening = 0.0;            // unsharp mask: gray += sharpening (gray - blurred gray)
    double sharpening_px = 1.2;         // standard deviation of that blur
    double blur_px = 0.45;              // standard deviation of the lens's blur
    double vignetting = 0.25;           // light lost in the corners, as a share
    double shutter_s = 0.004;  // motion blur: how long the shutter is open, about the frame's time; 0: an instant
    double readout_s = 0.0;    // rolling shutter: the last row is exposed this much after the first one
    Switch interlaced = Switch::kOff;  // odd rows are exposed half a frame after the even ones
    int samples = 4;                   // rays a pixel; depth is always taken at the pixel's center
    double depth_scale_mm = 0.005;     // one step of the 16-bit depth; range 65535 of them
    double drops = 0.0;                // drops of fluid on the lens at a time, in the mean; not in any truth
    double debris = 0.0;               // pieces that float before the lens at a time, in the mean; not in any truth
  } sensor;

  // What is done to the images on their way to the files.
  struct Recording {
    int video_qp = 0;             // quantization parameter of a video codec on H.264's scale; 0: no video codec
    int key_frame_every = 30;     // frames from one that is coded by itself to the next
    int jpeg_quality = 0;         // libjpeg's, with half the chroma resolution, after the video codec; 0: no JPEG
    double lost_share = 0.0;      // of the camera's frames that are not recorded
    double lost_run = 2.0;        // mean number of frames that are lost in a row
    double repeated_share = 0.5;  // of the runs of lost frames in whose place the frame before is recorded again
  } recording;

  // What takes the view away for a while, in part or in whole; in no truth. A period of 0: never; the first comes when
  // the period has passed once.
  struct Interruption {
    double blackout_period_s = 0.0;
    double blackout_s = 1.0 / 3;
    double tool_period_s = 0.0;
    double tool_s = 1.0;
    double blur_period_s = 0.0;
    double blur_s = 0.2;
    double blur_px = 6.0;  // standard deviation
  } interruption;

  struct CameraModel {
    CameraModelId model = CameraModelId::kPinhole;
    int width = 640;
    int height = 480;
    double horizontal_fov_deg = 70.0;  // used when params is empty
    std::string params;                // in COLMAP's order, separated by commas
    double baseline_mm = 0.0;          // stereo: the right camera's position on the left one's x axis; 0: one camera
  } camera;

  struct Trajectory {
    TrajectoryKind kind = TrajectoryKind::kInsert;
    int frames = 100;  // of the camera; Recording.lost_share of them may be missing in the sequence
    double fps = 30.0;
    double start_mm = 25.0;          // first camera, along the centerline or the way over the sheet
    std::string start_pose;          // first camera as tx,ty,tz,qx,qy,qz,qw, world_from_camera; empty: the scene's own
    double speed_mm_s = 15.0;        // insert
    double look_ahead_mm = 35.0;     // the camera looks at the centerline, or the sheet, this far ahead
    double height_mm = 60.0;         // surface, lobes: of the camera's path over the sheet
    double sway_amplitude_mm = 8.0;  // sway: to each side
    double sway_period_s = 4.0;      // sway: there and back, to both sides
    double sway_distance_mm = 55.0;  // sway: of the point that stays in view
    double loop_length_mm = 25.0;    // loop: how far out
    double loop_width_mm = 5.0;      // loop: to each side
    double loop_period_s = 0.0;      // loop: out and back; 0: the whole sequence
    double view_s = 1.0;             // board: from a view, in which the camera stands still, to the next
    std::string path;                // file: TUM lines in seconds from the first frame on; written absolute
    double tremor_mm = 0.3;          // of the hand, standard deviation of about; none on the poses of a file
    double tremor_deg = 0.3;
    double clearance_mm = 3.0;  // a camera nearer to the wall than this is an error
  } trajectory;

  int threads = 0;  // 0: all; never changes the result

  void List(OptionTable& table);
};

// The defaults of a preset. `clean` are those of SimulationOptions{}; `endoscope` changes Texture, Sensor and Recording
// so that noise, survival and noise of tracks are those of real recordings (docs/simulation.md).
SimulationOptions MakeSimulationOptions(Realism realism);

// The options as the YAML that is written beside a sequence.
std::string ToYaml(const SimulationOptions& options);

// The camera that the options describe; fails as Camera::Create does.
Result<Camera> SimulatedCamera(const SimulationOptions& options);

}  // namespace pliant
