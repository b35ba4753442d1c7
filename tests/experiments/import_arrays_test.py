# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Results of DROID-SLAM, MegaSaM and TAPIP3D as runs. The arrays are the true ones, in the names, shapes, conventions
and resolutions in which each system writes its own; a wrong convention makes them wrong by far.

usage: import_arrays_test.py TEST PLIANT
"""

import contextlib
import importlib.util
import io
import json
import os
import subprocess
import sys

from support import ROUND_OFF, SKIPPED, experiment_modules, main

experiment_modules("benchmarks")
for module in ("numpy", "cv2", "pliant"):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: Python has no {module}")
        sys.exit(SKIPPED)

import cv2
import numpy as np

import benchmark_miniatures as miniatures
import import_arrays
from benchmark_miniatures import FRAMES, HEIGHT, WIDTH
from pliant import system_arrays

PLIANT = os.path.abspath(sys.argv[2])
UNIT_MM = 40  # of the systems' worlds
SIZE = ("--size", f"{WIDTH}x{HEIGHT}")
RESIZED = (512, 384)  # what DROID-SLAM and MegaSaM make of 160x120
MAX_ATE_MM = 0.01
# Depths of resized images are mixed at edges, and the systems' principal point is half a pixel off after it.
MAX_MEDIAN_MM = 0.5
# The worlds are turned, moved and scaled.
WORLD = miniatures.matrix([3, -2, 5, *(np.array([0.1, -0.5, 0.3, 0.8]) / np.linalg.norm([0.1, -0.5, 0.3, 0.8]))])


def scene_in(folder):
    return miniatures.Scene(PLIANT, folder / "simulated")


def their_poses(scene):
    """world_from_camera in the system's world."""
    poses = np.array([WORLD @ pose for pose in scene.poses])
    poses[:, :3, 3] = WORLD[:3, 3] + (poses[:, :3, 3] - WORLD[:3, 3]) / UNIT_MM
    return poses


def resized_depths(scene):
    return np.array([cv2.resize(depth.astype(np.float32), RESIZED) for depth in scene.depths_mm]) / UNIT_MM


def tum(pose):
    return [*pose[:3, 3], *system_arrays.quaternion(pose)]


def run(*arguments):
    """(exit code, what was printed, what was said on standard error) of the script."""
    said, complained = io.StringIO(), io.StringIO()
    sys.argv = ["import_arrays.py", *map(str, arguments)]
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        try:
            code = import_arrays.main()
        except SystemExit as end:
            code = end.code
    return code, said.getvalue(), complained.getvalue()


def converted(folder, *arguments):
    code, said, complaint = run(*arguments, *SIZE, "--output_path", folder / "result")
    assert code == 0, complaint
    return said


def fails(sentence, *arguments):
    code, _, complaint = run(*arguments, "--output_path", "/nowhere/at/all")
    assert code == 1 and sentence in complaint and complaint.count("\n") == 1, complaint


def pliant(*arguments):
    result = subprocess.run([PLIANT, *map(str, arguments), "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, check=False)
    assert result.returncode == 0, result.stdout


def evaluated(folder, scene):
    """The evaluation of the result as a run: of its path and its points, with one scale for the whole run's path."""
    pliant("import", "--format", "result", "--input_path", folder / "result", "--sequence", scene.folder,
           "--output_path", folder / "run", "--overwrite")
    pliant("evaluate", "--run", folder / "run", "--sequence", scene.folder, "--output_path", folder / "evaluation")
    return json.loads((folder / "evaluation/evaluation.json").read_text(encoding="utf-8"))


def check(evaluation, poses):
    trajectory, surface = evaluation["trajectory"], evaluation["surface"]
    assert trajectory["poses"] == poses and trajectory["ate_rmse_mm"] < MAX_ATE_MM, trajectory
    assert abs(trajectory["scale"] - UNIT_MM) < 0.1, trajectory["scale"]
    assert surface["estimate"]["pooled_median_mm"] < MAX_MEDIAN_MM < surface["null"]["pooled_median_mm"], surface
    assert abs(surface["estimate"]["min_scale"] - UNIT_MM) < 1, surface["estimate"]  # points and path have one unit


def droid_arrays(scene, keyframes):
    camera_from_world = np.linalg.inv(their_poses(scene))[keyframes]
    intrinsics = np.array([scene.fx, scene.fy, scene.cx, scene.cy]) * RESIZED[0] / WIDTH / 8
    with np.errstate(divide="ignore"):
        disparities = 1 / resized_depths(scene)[keyframes]
    disparities[~np.isfinite(disparities)] = 0
    return {"tstamps": np.array(keyframes, np.float32), "poses": np.array([tum(pose) for pose in camera_from_world]),
            "disps": disparities, "intrinsics": np.tile(intrinsics, (len(keyframes), 1)),
            "images": np.zeros((len(keyframes), 3, 4, 4), np.uint8)}


def arrays_droid(folder):
    scene, keyframes = scene_in(folder), [0, 3, 7, 12]
    arrays = droid_arrays(scene, keyframes)
    (folder / "reconstruction").mkdir()
    for name, array in arrays.items():
        np.save(folder / f"reconstruction/{name}.npy", array)
    said = converted(folder, "droid", folder / "reconstruction", "--step", 32)
    assert said.startswith("4 poses, ") and said.endswith(" in 4 frames\n"), said
    check(evaluated(folder, scene), 4)

    # With the path that terminate() returns, every frame has a pose.
    np.save(folder / "path.npy", np.array([tum(pose) for pose in their_poses(scene)]))
    np.savez(folder / "droid.npz", **arrays)
    said = converted(folder, "droid", folder / "droid.npz", "--step", 32, "--path", folder / "path.npy")
    assert said.startswith(f"{FRAMES} poses, ") and said.endswith(" in 4 frames\n"), said
    check(evaluated(folder, scene), FRAMES)

    # It was given every second image from number 1 on: its images are other frames.
    half = droid_arrays(scene, [1, 5, 11])
    half["tstamps"] = np.array([0, 2, 5])
    np.savez(folder / "half.npz", **half)
    converted(folder, "droid", folder / "half.npz", "--step", 32, "--start", 1, "--stride", 2)
    lines = (folder / "result/trajectory.txt").read_text().splitlines()
    assert [round(30 * float(line.split()[0])) for line in lines] == [1, 5, 11], lines
    check(evaluated(folder, scene), 3)


def arrays_megasam(folder):
    scene = scene_in(folder)
    poses, depths = their_poses(scene), resized_depths(scene)
    depths[0] = 0
    depths[1, :, :200] = np.nan
    poses[9] = np.nan
    k = np.array([[scene.fx, 0, scene.cx], [0, scene.fy, scene.cy], [0, 0, WIDTH / RESIZED[0]]]) * RESIZED[0] / WIDTH
    np.savez(folder / "scene_sgd_cvd_hr.npz", images=np.zeros((FRAMES, 4, 4, 3), np.uint8),
             depths=depths.astype(np.float16), intrinsic=k, cam_c2w=poses)
    said = converted(folder, "megasam", folder / "scene_sgd_cvd_hr.npz", "--step", 32)
    assert said.startswith("15 poses (1 left out: ") and said.endswith(" in 14 frames\n"), said
    check(evaluated(folder, scene), 15)
    rows = np.loadtxt(folder / "result/observations.csv", delimiter=",", skiprows=1)
    assert len(set(map(tuple, rows[:, 1:2]))) == len(rows) and set(rows[:, 0]) == set(range(1, FRAMES)) - {9}
    assert rows[rows[:, 0] == 1, 2].min() > 200 * WIDTH / RESIZED[0] - 1 and rows[rows[:, 0] == 2, 2].min() < 6


def arrays_tapip3d(folder):
    scene = scene_in(folder)
    poses, (height, width) = their_poses(scene), (96, 128)
    rows, columns = np.mgrid[10:HEIGHT:12, 10:WIDTH:12].reshape(2, -1)
    z = scene.depths_mm[0][rows, columns]
    camera = np.stack([(columns - scene.cx) / scene.fx * z, (rows - scene.cy) / scene.fy * z, z, np.ones_like(z)])
    true_points = (scene.poses[0] @ camera)[:3].T
    visible = np.zeros((FRAMES, len(z)), bool)
    for frame, pose in enumerate(scene.poses):
        x, y, depth = np.linalg.inv(pose)[:3, :3] @ (true_points - pose[:3, 3]).T
        u, v = scene.fx * x / depth + scene.cx, scene.fy * y / depth + scene.cy
        inside = (z > 0) & (depth > 0) & (u >= 0) & (u <= WIDTH - 1) & (v >= 0) & (v <= HEIGHT - 1)
        at = scene.depths_mm[frame][np.rint(v[inside]).astype(int), np.rint(u[inside]).astype(int)]
        visible[frame, inside] = np.abs(at - depth[inside]) < 0.02 * depth[inside]
    points = (WORLD[:3, :3] @ true_points.T).T / UNIT_MM + WORLD[:3, 3]
    coords = np.tile(points, (FRAMES, 1, 1))
    coords[5, 0] = np.nan
    scale = np.array([[(width - 1) / (WIDTH - 1)], [(height - 1) / (HEIGHT - 1)], [1]])
    k = scale * [[scene.fx, 0, scene.cx], [0, scene.fy, scene.cy], [0, 0, 1]]
    np.savez(folder / "scene.result.npz", video=np.zeros((FRAMES, 3, height, width), np.float32), coords=coords,
             depths=np.zeros((FRAMES, height, width)), intrinsics=np.tile(k, (FRAMES, 1, 1)),
             extrinsics=np.linalg.inv(poses), visibs=visible, query_points=np.zeros((len(z), 4)))
    converted(folder, "tapip3d", folder / "scene.result.npz", "--tracks", folder / "tracks.npz")
    check(evaluated(folder, scene), FRAMES)
    with np.load(folder / "tracks.npz") as tracks:
        assert tracks["tracks"].shape == (FRAMES, len(z), 2) and tracks["visibility"].dtype == bool
        assert np.abs(tracks["tracks"][0] - np.stack([columns, rows], 1))[visible[0]].max() < 1e-3
        assert not tracks["visibility"][5, 0] and (tracks["visibility"] <= visible).all()
        assert tracks["visibility"].sum() >= visible.sum() - 1
    pliant("evaluate", "--tracks", folder / "tracks.npz", "--sequence", scene.folder, "--output_path",
           folder / "scores")
    scores = json.loads((folder / "scores/evaluation.json").read_text(encoding="utf-8"))["tracks"]
    assert scores["tracks"] == len(z) and scores["average_within"] > 0.98 and scores["median_px"] < 0.1, scores


def orb_slam3_path(folder):
    """CameraTrajectory.txt needs no script: TUM lines of the camera in ns, a space at their end, not of all frames."""
    scene = scene_in(folder)
    (folder / "CameraTrajectory.txt").write_text("".join(
        f"{1e9 * k / 30:.6f} " + "".join(f"{value:.9f} " for value in tum(pose)) + "\n"
        for k, pose in enumerate(their_poses(scene)) if k >= 3))
    pliant("import", "--format", "tum", "--input_path", folder / "CameraTrajectory.txt", "--sequence", scene.folder,
           "--Import.unit_mm", UNIT_MM, "--output_path", folder / "run", "--overwrite")
    pliant("evaluate", "--run", folder / "run", "--sequence", scene.folder, "--output_path", folder / "evaluation")
    trajectory = json.loads((folder / "evaluation/evaluation.json").read_text(encoding="utf-8"))["trajectory"]
    assert trajectory["poses"] == FRAMES - 3 and trajectory["ate_rmse_mm"] < MAX_ATE_MM, trajectory
    assert abs(trajectory["scale"] - 1) < 0.01, trajectory["scale"]


def arrays_pixels(_folder):
    """Pixels of resized and cut images, of a size that is no multiple of 8."""
    assert system_arrays.resized((1350, 1080)) == (495, 396)
    rows, columns, u, v = system_arrays.grid_of((392, 488), (1350, 1080), 8)
    assert columns.max() < 488 and rows.max() < 392 and (columns[0], rows[0]) == (4, 4)
    assert abs(u[0] - (4.5 * 1350 / 495 - 0.5)) < ROUND_OFF and abs(v[0] - (4.5 * 1080 / 396 - 0.5)) < ROUND_OFF
    for q in ([0, 0, 0, 1], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0.5, -0.5, 0.5, 0.5], [-0.1, 0.7, 0.1, -0.7]):
        q = np.array(q) / np.linalg.norm(q)
        again = system_arrays.quaternion(system_arrays.matrices([[1, 2, 3, *q]])[0])
        assert np.allclose(again, q) or np.allclose(again, -q), (q, again)
        assert np.allclose(system_arrays.matrices([[1, 2, 3, *q]])[0], miniatures.matrix([1, 2, 3, *q])), q


def arrays_times(folder):
    poses = np.tile(np.eye(4), (3, 1, 1))
    np.savez(folder / "m.npz", depths=np.ones((3, 384, 512)), cam_c2w=poses, intrinsic=np.eye(3))
    (folder / "times.txt").write_text("# s\n0.5\n1.5\n2.5\n")
    (folder / "frames.csv").write_text("frame,timestamp,state\n0,7.5,tracking\n1,8.5,lost\n2,9.5,tracking\n")
    for arguments, expected in (((), [0, 1 / 30, 2 / 30]), (("--fps", 10), [0, 0.1, 0.2]),
                                (("--times", folder / "times.txt"), [0.5, 1.5, 2.5]),
                                (("--times", folder / "frames.csv"), [7.5, 8.5, 9.5])):
        converted(folder, "megasam", folder / "m.npz", *arguments)
        times = np.loadtxt(folder / "result/trajectory.txt")[:, 0]
        assert np.allclose(times, expected, atol=1e-6), (arguments, times)
    fails("has no time of frame 3", "megasam", folder / "m.npz", *SIZE, "--times", folder / "times.txt", "--start", 1)
    fails("neither a list of times nor", "megasam", folder / "m.npz", *SIZE, "--times", folder / "m.npz")


def good_megasam():
    return {"depths": np.ones((2, 384, 512)), "cam_c2w": np.tile(np.eye(4), (2, 1, 1)), "intrinsic": np.eye(3)}


def good_droid():
    return {"tstamps": np.arange(2), "poses": np.tile([0, 0, 0, 0, 0, 0, 1.0], (2, 1)),
            "disps": np.ones((2, 384, 512)), "intrinsics": np.tile([45, 45, 32, 24.0], (2, 1))}


def good_tapip3d():
    return {"coords": np.ones((2, 5, 3)), "visibs": np.ones((2, 5), bool), "video": np.zeros((2, 3, 4, 4)),
            "intrinsics": np.tile(np.eye(3), (2, 1, 1)), "extrinsics": np.tile(np.eye(4), (2, 1, 1))}


def saved(path, good, **changed):
    """An .npz of good arrays, some of which are changed; None: left out."""
    np.savez(path, **{name: array for name, array in (good | changed).items() if array is not None})
    return path


def arrays_complaints(folder):
    def megasam(**changed):
        return "megasam", saved(folder / "m.npz", good_megasam(), **changed), *SIZE

    def droid(**changed):
        return "droid", saved(folder / "d.npz", good_droid(), **changed), *SIZE

    fails("there is no", "megasam", folder / "nothing.npz", *SIZE)
    (folder / "text.npz").write_text("no arrays")
    fails("is no .npz", "megasam", folder / "text.npz", *SIZE)
    (folder / "empty.npz").write_bytes(b"")
    fails("is no .npz", "megasam", folder / "empty.npz", *SIZE)
    np.save(folder / "one.npy", np.eye(3))
    fails("is one array", "megasam", folder / "one.npy", *SIZE)
    fails("has no array 'depths'", *megasam(depths=None))
    fails("'intrinsic' has the shape (4,), not (3, 3)", *megasam(intrinsic=np.ones(4)))
    fails("but N is 2 in another array", *megasam(depths=np.ones((3, 384, 512))))
    fails("its images have 512x384 pixels; of 1350x1080 it would have made 488x392", "megasam",
          saved(folder / "m.npz", good_megasam()), "--size", "1350x1080")
    fails("none of the 2 poses is one", *megasam(cam_c2w=np.zeros((2, 4, 4))))
    np.save(folder / "path.npy", good_droid()["poses"][:1])
    fails("has 1 poses, but there is a keyframe 1", *droid(), "--path", folder / "path.npy")
    fails("not (frames, 7)", *droid(), "--path", folder / "one.npy")
    fails("not of images of an eighth of the size", *droid(intrinsics=8 * good_droid()["intrinsics"]))
    fails("'tstamps' has values that are no numbers of frames", *droid(tstamps=np.array([0, np.nan])))
    hidden = saved(folder / "t.npz", good_tapip3d(), visibs=np.zeros((2, 5), bool))
    code, said, complaint = run("tapip3d", hidden, *SIZE, "--output_path", folder / "hidden")
    assert (code, said) == (0, "2 poses, 0 points in 0 frames\n"), (code, said)
    assert complaint == (f"import_arrays.py: no point of {hidden} is seen in a frame with a pose: the result has the camera "
                         "path alone\n"), complaint
    video = saved(folder / "t.npz", good_tapip3d(), video=np.zeros((2, 3, 1, 1)))
    fails("'video' has images of 1x1 pixels", "tapip3d", video, *SIZE)


def arrays_unreadable(folder):
    """Files that are no arrays of numbers."""
    system = ("droid", folder / "droid", *SIZE)
    (folder / "droid").mkdir()
    for name, array in good_droid().items():
        np.save(folder / f"droid/{name}.npy", array)
    poses, path = folder / "droid/poses.npy", folder / "path.npy"
    whole = poses.read_bytes()
    np.save(folder / "objects.npy", good_droid()["poses"].astype(object))
    np.save(folder / "words.npy", np.array(["one", "two"]))
    saved(folder / "several.npz", good_droid())
    for wrong in (b"", b"no array", b"\x80\x04\x95 garbage \xff\xfe", whole[:20], whole[:-9],
                  whole.replace(b"'descr'", b"(descr'"),  # NumPy's tokenizer fails
                  *((folder / name).read_bytes() for name in ("objects.npy", "words.npy", "several.npz"))):
        poses.write_bytes(wrong)
        fails(f"'poses' of {folder}/droid is not an array of real numbers", *system)
        poses.write_bytes(whole)
        path.write_bytes(wrong)
        fails("path.npy is not an array of real numbers", *system, "--path", path)
    fails("none.npy cannot be read: No such file", *system, "--path", folder / "none.npy")
    fails("droid cannot be read: Is a directory", *system, "--path", folder / "droid")

    fails("'cam_c2w' of", "megasam", saved(folder / "m.npz", good_megasam(), cam_c2w=np.array([{}])), *SIZE)
    damaged = bytearray(saved(folder / "m.npz", good_megasam()).read_bytes())
    damaged[2000] ^= 0xff  # in the first array, whose checksum is another one then
    (folder / "m.npz").write_bytes(damaged)
    fails("'depths' of", "megasam", folder / "m.npz", *SIZE)

    megasam = ("megasam", saved(folder / "m.npz", good_megasam()), *SIZE)
    for text, sentence in (("frame,timestamp\n0,nan\n1,2\n", "has no time of frame 0"),
                           ("frame,timestamp\n0\n", "neither a list of times nor"),
                           ("frame,timestamp\n0,\0\n", "neither a list of times nor"),
                           ("frame\n0\n", "neither a list of times nor")):
        (folder / "frames.csv").write_text(text)
        fails(sentence, *megasam, "--times", folder / "frames.csv")


def arrays_unwritable(folder):
    file = saved(folder / "m.npz", good_megasam())
    (folder / "result/trajectory.txt").mkdir(parents=True)
    for output, reason in ((file / "result", "Not a directory"), (file, "File exists"),
                           (folder / "result", "Is a directory")):
        code, _, complaint = run("megasam", file, *SIZE, "--output_path", output)
        assert code == 1 and complaint == f"import_arrays.py: {output} cannot be written: {reason}\n", complaint
    fails("tracks.npz cannot be written: No such file", "tapip3d", saved(folder / "t.npz", good_tapip3d()), *SIZE,
          "--tracks", folder / "nowhere/tracks.npz")


def arrays_usage(folder):
    """Wrong usage ends with the exit code 2, and with a line that says which argument is wrong."""
    file = saved(folder / "m.npz", good_megasam())
    for flag, wrong, no_numbers in (("--fps", ("0", "-5", "nan", "inf"), ("fast",)), ("--start", ("-4",), ("1.5", "first")),
                                    ("--stride", ("0", "-1"), ()), ("--step", ("0",), ()),
                                    ("--size", ("0x120",), ("160", "axb"))):
        for value in wrong + no_numbers:
            given = {"--size": SIZE[1], "--output_path": folder / "result", flag: value}
            code, _, complaint = run("megasam", file, *(f"{name}={text}" for name, text in given.items()))
            words = f"error: {flag[2:]}" if value in wrong else f"argument {flag}: "
            assert code == 2 and words in complaint.splitlines()[-1], complaint
    assert not (folder / "result").exists()
    code, _, complaint = run("megasam", file, *SIZE, "--output_path", folder)
    assert code == 2 and "holds files that are not a converted result's" in complaint.splitlines()[-1], complaint


main(arrays_droid, arrays_megasam, arrays_tapip3d, orb_slam3_path, arrays_pixels, arrays_times, arrays_complaints,
     arrays_unreadable, arrays_unwritable, arrays_usage)
