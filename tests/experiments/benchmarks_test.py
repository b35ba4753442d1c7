# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recipes of published benchmarks: what they say, and that they run on miniatures of the data sets.

usage: benchmarks_test.py TEST PLIANT
"""

import contextlib
import importlib.util
import io
import json
import math
import os
import re
import shutil
import sys

from support import ROUND_OFF, SKIPPED, experiment_modules, main

experiment_modules("benchmarks")
for module in ("yaml", "numpy", "cv2"):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: Python has no {module}")
        sys.exit(SKIPPED)

import benchmark_miniatures as miniatures
import benchmarks
import labels
import windows

PLIANT = os.path.abspath(sys.argv[2])
# Of a rigid scene that is tracked nearly without error: above what the runs give, below what a wrong unit, axis or
# order would give. The path is nearly straight, so even inverted poses are off by a sixth of a millimeter only.
MAX_ATE_MM = 0.05
MAX_ATE_OF_VIDEO_MM = 0.12
MAX_POINTS_MM = 8


def run(*arguments):
    """(exit code, what was printed, what was said on standard error) of the script."""
    said, complained = io.StringIO(), io.StringIO()
    sys.argv = ["benchmarks.py", "--pliant", PLIANT, *map(str, arguments)]
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
        code = benchmarks.main()
    return code, said.getvalue(), complained.getvalue()


def tables(text):
    """Every table of the text: a list of rows, each {heading: cell}."""
    found, header = [], None
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not line.startswith("|"):
            header = None
        elif header is None:
            header = cells
            found.append([])
        elif not set(line) <= set("|- "):
            found[-1].append(dict(zip(header, cells)))
    return found


def run_on(folder, name, *arguments, code=0):
    ended_with, text, complaint = run(name, "--output_path", folder / f"out_{name}", *arguments)
    assert ended_with == code, (ended_with, text, complaint)
    assert (folder / f"out_{name}/table.md").read_text(encoding="utf-8") == text
    return text, tables(text)


def fails(sentence, *arguments):
    code, _, complaint = run(*arguments)
    assert code == 1 and sentence in complaint, complaint
    assert complaint.splitlines()[-1].startswith("benchmarks.py: "), complaint


# What the recipes say.

def benchmark_protocols(_folder):
    names = sorted(path.stem for path in benchmarks.PROTOCOLS.glob("*.yaml"))
    assert {"c3vd", "c3vd_v2", "c3vd_v2_deformation", "c3vd_defcol", "stereomis", "scared_depth", "scared_pose",
            "endoslam", "stir"} <= set(names), names
    for name in names:
        protocol = benchmarks.read_protocol(name)
        assert protocol["title"] and protocol["verified"] and protocol["not_verified"], name
        for row in protocol["reported"]:  # no number without its source, and none that the table does not show
            assert row["source"] and row["values"], (name, row)
            assert set(row["values"]) <= {metric["id"] for metric in protocol["metrics"]}, (name, row)
            assert all(re.fullmatch(r"\d+\.\d+( ± \d+\.\d+)?", value) for value in row["values"].values()), (name, row)
        assert bool(protocol["reported"]) != bool(protocol.get("none_reported")), name
        code, text, _ = run(name)
        assert code == 0 and all(row["source"] in text for row in protocol["reported"]), text
    frames = {name: [entry["frames"] for entry in benchmarks.read_protocol(name)["sequences"].values()]
              for name in ("c3vd", "c3vd_all", "c3vd_v2", "c3vd_v2_deformation")}
    assert {name: (len(counts), sum(counts)) for name, counts in frames.items()} == {
        "c3vd": (10, 6378), "c3vd_all": (22, 10015), "c3vd_v2": (169, 67886), "c3vd_v2_deformation": (15, 6185)}, frames
    depth_frames = [entry["depth_frames"] for entry in benchmarks.read_protocol("scared_depth")["sequences"].values()]
    assert sum(map(len, depth_frames)) == 551 and all(sorted(set(frames)) == frames for frames in depth_frames)
    assert benchmarks.read_protocol("c3vd")["sequences"]["trans_t2_c"]["also"] == ["c0_transverse_t2_v3"]


def benchmark_windows(_folder):
    """The figure by hand: a camera that goes along x and y, beside one of another scale that turns off once."""
    def path(*points):
        return {k: [[1.0, 0, 0, x], [0, 1.0, 0, y], [0, 0, 1.0, 0], [0, 0, 0, 1.0]] for k, (x, y) in enumerate(points)}

    truth = path((0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0))
    same = windows.figures(path(*((3 * k, 0) for k in range(6))), truth)
    assert same["windows"] == same["windows_compared"] == 4 and abs(same["mean_mm"]) < ROUND_OFF, same
    turned = path((0, 0), (1, 0), (2, 0), (3, 0), (3, 1))
    figures = windows.figures(turned, {k: truth[k] for k in range(5)})
    first = math.sqrt((4 - 3 * (s := 26 / 24)) ** 2 + s * s + sum((k - s * k) ** 2 for k in (1, 2, 3))) / 5
    second = math.sqrt((3 - 2 * (s := 11 / 10)) ** 2 + s * s + sum((k - s * k) ** 2 for k in (1, 2))) / 4
    third = math.sqrt((2 - 1 * (s := 3 / 3)) ** 2 + s * s + (1 - s) ** 2) / 3
    assert abs(figures["mean_mm"] - (first + second + third) / 3) < ROUND_OFF, (figures, first, second, third)
    lost = windows.figures({k: pose for k, pose in truth.items() if k != 5}, truth)
    assert (lost["windows"], lost["windows_compared"]) == (4, 1), lost
    assert windows.figures({}, truth)["mean_mm"] is None
    # The order: after a quarter turn about z, the second motion goes along the turned axis.
    quarter = [[0, -1.0, 0, 1], [1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]]
    along_y, back, forward = ([[1.0, 0, 0, x], [0, 1.0, 0, y], [0, 0, 1.0, 0], [0, 0, 0, 1.0]]
                              for x, y in ((0, 2), (-2, 0), (1, 0)))
    assert windows.error([forward, back], [quarter, along_y]) < ROUND_OFF
    # A motion is of the later camera from the earlier one: the origin, which it left along x, is on its y axis now.
    motion = windows.motions({4: windows.IDENTITY, 5: quarter})[5]
    assert [round(row[3], 9) for row in motion] == [0, 1, 0, 1], motion


def benchmark_camera_path_alone(_folder):
    """A system without points has no figures of points: not 0, neither in its row nor in a mean."""
    protocol = benchmarks.read_protocol("c3vd_v2_deformation")
    def rows(name, tracks):
        return {"sequence": name, "trajectory": {"ate_mean_mm": 0.5, "ate_rmse_mm": 0.6},
                "survival": {"mean_points": 20.0 * tracks, "mean_track_length": 3.0 * tracks, "tracks": tracks}}

    path, points = rows("a", 0), rows("b", 2)
    (alone, both), = tables(benchmarks.summary_table(
        protocol, [("Path", "-", [path]), ("Some", "-", [path, points])], 2))
    length = "mean track length, frames"
    assert (alone["ATE mean, mm"], alone["points a frame"], alone[length]) == ("0.50", "-", "-"), alone
    assert (both["points a frame"], both[length], both["sequences"]) == ("40", "6.0", "2 of 2"), both
    no_map = {"sequence": "c", "trajectory": None, "survival": path["survival"]}
    (row,), = tables(benchmarks.summary_table(protocol, [("Pliant", "images", [no_map])], 1))
    assert (row["points a frame"], row["sequences"]) == ("-", "0 of 1"), row


def benchmark_rectified_axes(folder):
    """The poses of the camera as built, in the axes of the rectified one."""
    turn = miniatures.matrix([0, 0, 0, 0, math.sin(0.1), 0, math.cos(0.1)])
    built = [miniatures.matrix([k, 2 * k, 0, math.sin(0.2 * k), 0, 0, math.cos(0.2 * k)]) for k in range(4)]
    (folder / "data/frame_data").mkdir(parents=True)
    for k, pose in enumerate(built):
        (folder / f"data/frame_data/frame_data{k:06}.json").write_text(
            json.dumps({"camera-pose": miniatures.np.linalg.inv(pose).tolist()}))
    found = windows.true_poses(folder, (built[1] @ turn).tolist(), 1, 9)
    assert sorted(found) == [1, 2, 3], found
    for k in found:
        assert miniatures.np.allclose(found[k], built[k] @ turn), k
    assert not windows.true_poses(folder, (built[1] @ turn).tolist(), 7, 9)


def benchmark_poses(folder):
    """Matrices by rows and by columns, and what is none."""
    pose = miniatures.matrix([10, -20, 30, 0.5, 0.5, 0.5, 0.5])
    half_turn = miniatures.matrix([1, 2, 3, 0, 1, 0, 0])
    for name, order in (("rows", lambda m: m), ("columns", lambda m: m.T)):
        path = folder / f"{name}.txt"
        path.write_text("".join(",".join(map(str, order(m).ravel())) + "\n" for m in (pose, half_turn)))
        lines = [[float(word) for word in line.split()] for line in benchmarks.trajectory_of(path)]
        assert miniatures.np.allclose(lines[0], [0, 10, -20, 30, 0.5, 0.5, 0.5, 0.5]), (name, lines)
        assert miniatures.np.allclose(miniatures.np.abs(lines[1]), [1, 1, 2, 3, 0, 1, 0, 0]), (name, lines)
    for text, sentence in (("1 2 3\n", "line 1: 16 numbers"), ("\n" + "1 " * 16, "line 2: not the matrix of a pose")):
        (folder / "bad.txt").write_text(text)
        try:
            benchmarks.trajectory_of(folder / "bad.txt")
        except benchmarks.Failure as failure:
            assert sentence in str(failure), failure
        else:
            raise AssertionError(text)


# The data sets in small, with the program.

def scene_in(folder):
    scene = miniatures.Scene(PLIANT, folder / "simulated")
    scene.camera_yaml(folder / "camera.yaml")
    return scene


def check_camera(row, max_ate_mm=MAX_ATE_MM):
    """All frames are tracked, and the path is the true one."""
    assert row["frames"] == row["tracked"] == str(miniatures.FRAMES), row
    assert float(row["ATE RMSE, mm"]) < max_ate_mm, row


def check_points(row):
    assert float(row["points RMSE, mm"]) < MAX_POINTS_MM and float(row["points RMSE, mm"]) < float(row["null"]) / 3, row


def benchmark_c3vd(folder):
    scene = scene_in(folder)
    miniatures.c3vd(scene, folder / "c3vd/cecum_t1_b")
    miniatures.c3vd(scene, folder / "c3vd/c0_transverse_t4_v2")  # the new name of trans_t4_b
    text, (summary, sequences) = run_on(folder, "c3vd", "--data", folder / "c3vd", "--camera", folder / "camera.yaml")
    assert [row["sequence"] for row in sequences] == ["cecum_t1_b", "trans_t4_b"], sequences
    for row in sequences:
        check_camera(row)
        check_points(row)
        assert float(row["depth RMSE, mm"]) < MAX_POINTS_MM and float(row["pixels with a depth, %"]) > 10, row
    assert summary[0]["system"] == "Pliant" and summary[0]["sequences"] == "2 of 10", summary[0]
    assert summary[0]["ATE mean, mm"] == f"{sequences[0]['ATE mean, mm']} ± 0.00", summary[0]
    published = next(row for row in summary if row["system"] == "EndoGSLAM-H")
    assert (published["ATE mean, mm"], published["points RMSE, mm"]) == ("0.34 ± 0.21", "-"), published
    assert "left out: cecum_t2_b, cecum_t3_a, sigmoid_t1_a," in text, text
    assert "cecum_t1_b: 16 frames were read, 765 are published." in text, text
    depths = folder / "out_c3vd/runs/cecum_t1_b/surface/depth"
    assert sorted(path.name for path in depths.iterdir()) == ["0_color.png", "8_color.png"], list(depths.iterdir())

    # Nothing is repeated, unless its command has changed; then what depends on it is made again.
    run_folder = folder / "out_c3vd/runs/cecum_t1_b"
    def times():
        return [(run_folder / file).stat().st_mtime_ns for file in ("run/run.json", "surface/surface.json",
                                                                    "evaluation/evaluation.json")]

    before = times()
    arguments = ("--data", folder / "c3vd", "--camera", folder / "camera.yaml", "--only", "cecum_t1_b")
    run_on(folder, "c3vd", *arguments)
    assert times() == before
    run_on(folder, "c3vd", *arguments, "--evaluate", "--TrajectoryError.alignment se3")
    evaluated = times()
    assert evaluated[:2] == before[:2] and evaluated[2] != before[2]
    assert json.loads((run_folder / "evaluation/evaluation.json").read_text())["trajectory"]["alignment"] == "se3"
    run_on(folder, "c3vd", *arguments, "--track", "--Init.method depth")
    assert all(new != old for new, old in zip(times(), evaluated))

    # Another system's run, here our own, gets the same figures.
    _, (summary, _) = run_on(folder, "c3vd", *arguments, "--runs", f"Theirs={folder / 'out_c3vd/runs'}")
    assert [row["system"] for row in summary[:2]] == ["Pliant", "Theirs"], summary
    assert all(row["sequences"] == "1 of 10" for row in summary[:2]), summary
    for key in ("ATE mean, mm", "points RMSE, mm", "null"):
        assert summary[0][key] == summary[1][key] != "-", summary
    code, text, _ = run("c3vd", *arguments, "--output_path", folder / "out_c3vd", "--runs", f"Theirs={folder}")
    assert code == benchmarks.COULD_NOT_RUN and "cecum_t1_b: no run of Theirs." in text, text


def benchmark_c3vd_others(folder):
    scene = scene_in(folder)
    miniatures.c3vd_v2(scene, folder / "c3vd_v2/c1_cecum_t1_v1")
    miniatures.c3vd_v2_deformation(scene, folder / "c3vd_v2_deformation/c1_cecum_t1_v4")
    miniatures.c3vd_v2_deformation(scene, folder / "c3vd_v2_deformation/c2_cecum_t1_v4")
    (folder / "c3vd_v2_deformation/c2_cecum_t1_v4/pose.txt").unlink()  # a camera that stands still has none
    miniatures.c3vd_defcol(scene, folder / "c3vd_defcol/rigid_1")
    for name, sequence in (("c3vd_v2", "c1_cecum_t1_v1"), ("c3vd_v2_deformation", "c1_cecum_t1_v4"),
                           ("c3vd_defcol", "rigid_1")):
        text, found = run_on(folder, name, "--data", folder / name, "--camera", folder / "camera.yaml")
        rows = found[-1]
        assert rows[0]["sequence"] == sequence and "No published numbers" in text, text
        check_camera(rows[0])
        if name != "c3vd_v2_deformation":  # it has no depth
            check_points(rows[0])
            assert float(rows[0]["depth RMSE, mm"]) < MAX_POINTS_MM, rows
        if name == "c3vd_v2_deformation":
            assert rows[1]["ATE RMSE, mm"] == "-" and float(rows[1]["points a frame"]) > 20, rows
    fails("publishes no calibration", "c3vd_defcol", "--data", folder / "c3vd_defcol", "--output_path", folder / "x")
    with open(folder / "c3vd_v2_deformation/c1_cecum_t1_v4/pose.txt", "a", encoding="utf-8") as file:
        file.write("1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1\n")
    code, text, _ = run("c3vd_v2_deformation", "--data", folder / "c3vd_v2_deformation", "--camera",
                        folder / "camera.yaml", "--output_path", folder / "out_c3vd_v2_deformation")
    assert code == benchmarks.COULD_NOT_RUN and "has 17 poses for 16 images" in text, text


def benchmark_endoslam(folder):
    miniatures.endoslam(scene_in(folder), folder / "endoslam/UnityCam/Colon")
    text, (summary, sequences) = run_on(folder, "endoslam", "--data", folder / "endoslam", "--camera",
                                        folder / "camera.yaml")
    check_camera(sequences[0])
    check_points(sequences[0])
    assert summary[0]["sequences"] == "1 of 3" and "left out: Small Intestine, Stomach." in text, text
    # No first map: the row says so, and the mean does not count it.
    text, (summary, sequences) = run_on(folder, "endoslam", "--data", folder / "endoslam", "--camera",
                                        folder / "camera.yaml", "--track", "--Tracking.min_corners 10000")
    assert (sequences[0]["tracked"], sequences[0]["ATE RMSE, mm"]) == ("0", "-"), sequences
    assert summary[0]["sequences"] == "0 of 3" and "Colon: no map (" in text, text


def benchmark_scared(folder):
    miniatures.scared(scene_in(folder), folder / "scared/dataset5/keyframe4")
    arguments = ("--data", folder / "scared", "--track", "--Init.method stereo")
    _, (summary, sequences) = run_on(folder, "scared_depth", *arguments)
    assert sequences[0]["sequence"] == "dataset_5/keyframe_4" and sequences[0]["tracked"] == str(miniatures.FRAMES)
    assert sequences[0]["frames compared"] == "6", sequences  # 2, 5, 9, 10, 13 and 16 of the split
    depths = folder / "out_scared_depth/runs/dataset_5_keyframe_4/surface/depth"
    assert sorted(int(re.search(r"\d+", path.name)[0]) for path in depths.iterdir()) == [1, 4, 8, 9, 12, 15]
    assert 0 < float(sequences[0]["AbsRel"]) < 0.1 and float(sequences[0]["ratio below 1.25"]) > 0.9, sequences
    assert summary[0]["AbsRel"] == sequences[0]["AbsRel"] and summary[0]["sequences"] == "1 of 7", summary[0]
    _, (summary, sequences) = run_on(folder, "scared_pose", *arguments)
    check_camera(sequences[0], MAX_ATE_OF_VIDEO_MM)
    assert 0 < float(summary[0]["dataset 5"]) < 0.1 and summary[0]["dataset 7"] == "-", summary[0]
    assert sequences[0]["windows compared"] == str(miniatures.FRAMES - 2), sequences


def benchmark_stereomis(folder):
    scene = scene_in(folder)
    for name in ("P1", "P2_0"):
        miniatures.stereomis(scene, folder / "stereomis" / name)
    (folder / "stereomis/P2_0/test_split.csv").write_text("start,end\n0,10\n4,16\n")
    (folder / "stereomis/P2_0/scenarios.csv").write_text("scenario,start,end\nbreathing,2,12\n")
    _, (summary, sequences) = run_on(folder, "stereomis", "--data", folder / "stereomis")
    assert [(row["sequence"], row["frames"]) for row in sequences] == [
        ("P1", "16"), ("P2_0 0 to 10", "10"), ("P2_0 4 to 16", "12")], sequences
    for row in sequences:
        assert row["frames"] == row["tracked"] and float(row["ATE RMSE, mm"]) < 0.5, row  # the scale is not fitted
    assert summary[0]["sequences"] == "3 of 3", summary
    _, (_, sequences) = run_on(folder, "stereomis", "--data", folder / "stereomis", "--splits", "scenarios.csv")
    assert [row["sequence"] for row in sequences] == ["P1", "P2_0 2 to 12"], sequences
    (folder / "stereomis/P2_0/test_split.csv").write_text("from,to\n0,10\n")
    fails("needs the columns start and end", "stereomis", "--data", folder / "stereomis", "--output_path", folder / "x")


def benchmark_stir(folder):
    scene = scene_in(folder)
    for name in ("0", "1", "2"):
        miniatures.stir(scene, folder / "stir" / name)
    miniatures.write(folder / "stir/1/left/seq00/segmentation/icgendseg.png",
                     miniatures.np.zeros((miniatures.HEIGHT, miniatures.WIDTH), miniatures.np.uint8))
    calibration = folder / "stir/2/calib.json"  # a pair that is turned
    calibration.write_text(json.dumps({**json.loads(calibration.read_text()), "rotation": [0, 0.02, 0]}))
    text, (summary, sequences) = run_on(folder, "stir", "--data", folder / "stir", code=benchmarks.COULD_NOT_RUN)
    assert [(row["sequence"], row["frames"], row["tracked"], row["points"]) for row in sequences] == [
        ("0/left/seq00", "16", "16", "6")], sequences
    assert "1/left/seq00 (no labels)" in text and "2/left/seq00: the images were rectified" in text, text
    within = "within 4, 8, 16, 32, 64 px, mean %"
    assert float(summary[0][within]) > 95 and float(summary[0]["nothing moves, %"]) <= float(summary[0][within]), summary
    within_3d = "within 2, 4, 8, 16, 32 mm, mean %"
    assert summary[0]["points in space"] == "6", summary
    assert float(summary[0][within_3d]) > 75 > 60 > float(summary[0]["nothing moves in space, %"]), summary
    # Another system's run in the same way.
    shutil.copytree(folder / "out_stir/runs/0_left_seq00/run", folder / "theirs/0_left_seq00/run")
    _, (summary, _) = run_on(folder, "stir", "--data", folder / "stir", "--only", "0/left/seq00",
                             "--runs", f"Theirs={folder / 'theirs'}")
    for figure in (within, within_3d):
        assert [row[figure] for row in summary[:2]] == [summary[0][figure]] * 2, summary


def benchmark_labels(folder):
    """Places in space by hand: one label with one place, one with two of which the less alike counts, two with none."""
    import cv2
    import numpy as np
    left, right = folder / "0/left/seq00", folder / "0/right/seq00"
    calibration = {"leftcameramat": [[1000, 0, 640], [0, 1000, 512], [0, 0, 1]],
                   "rightcameramat": [[1000, 0, 644], [0, 1000, 512], [0, 0, 1]], "translation": [-0.005, 0, 0]}
    noise = np.random.default_rng(1).integers(0, 256, (1024, 1280, 3), np.uint8)
    seg = {eye: np.zeros((1024, 1280, 3), np.uint8) for eye in (left, right)}
    infrared = {eye: noise.copy() for eye in (left, right)}

    def label(eye, u, v):
        seg[eye][v - 5:v + 5, u - 5:u + 5] = 255

    for u, v in ((240, 212), (640, 612), (840, 712), (1040, 812)):
        label(left, u, v)
    label(right, 194, 220)  # 8 rows lower; 46 px to the left, and 4 between the cameras' centers
    for u in (600, 550):
        label(right, u, 612)
    infrared[right][607:617, 595:605] = infrared[left][607:617, 635:645]  # alike, so that the other one is taken
    infrared[right][607:617, 545:555] = 255 - infrared[left][607:617, 635:645]
    label(right, 800, 723)  # 11 rows lower
    label(right, 930, 812)  # too near: 114 px
    for eye in (left, right):
        miniatures.write(eye / "segmentation/icgstartseg.png", seg[eye])
        miniatures.write(eye / "00001ms_icgstart.png", infrared[eye])
    (folder / "0/calib.json").write_text(json.dumps(calibration))
    found = sorted(labels.positions(left, "segmentation/icgstartseg.png", "*_icgstart.png"))
    expected = [[(240 - 640) * 0.1, (212 - 512) * 0.1, 100], [0, 100 * 5 / 94, 1000 * 5 / 94]]
    assert np.allclose(found, expected), (found, expected)
    assert labels.positions(left, "segmentation/icgendseg.png", "*_icgend.png") == []
    assert labels.correlation(seg[left], seg[left] * 0.5) > 1 - ROUND_OFF and labels.correlation(seg[left], noise * 0) == 0
    (right / "00001ms_icgstart.png").unlink()
    assert labels.positions(left, "segmentation/icgstartseg.png", "*_icgstart.png") == []


def benchmark_complaints(folder):
    (folder / "data/cecum_t1_b").mkdir(parents=True)
    fails("there is no benchmark 'c4vd', but c3vd, ", "c4vd")
    fails("any folder with segmentation/icgstartseg.png", "stir", "--data", folder)
    fails("is not a folder", "c3vd", "--data", folder / "nothing")
    fails("has none of the sequences of 'scared_depth': dataset_1/keyframe_3,", "scared_depth", "--data", folder)
    fails("any folder with StereoCalibration.ini", "stereomis", "--data", folder)
    fails("--only: 'cecum' is not one of", "c3vd", "--data", folder / "data", "--only", "cecum")
    fails("there is no file", "c3vd", "--data", folder / "data", "--camera", folder / "nothing")
    fails("is not a program; build it first", "c3vd", "--data", folder / "data", "--pliant", folder / "nothing")
    fails("--runs is SYSTEM=DIR", "c3vd", "--data", folder / "data", "--runs", "theirs")
    code, text, _ = run("c3vd", "--data", folder / "data", "--output_path", folder / "out")
    assert code == benchmarks.COULD_NOT_RUN and "cecum_t1_b: pliant track ended with" in text, text
    assert (folder / "out/runs/cecum_t1_b/track.log").read_text(), "the log says why"


main(benchmark_protocols, benchmark_windows, benchmark_camera_path_alone, benchmark_rectified_axes, benchmark_poses,
     benchmark_c3vd, benchmark_c3vd_others, benchmark_endoslam, benchmark_scared, benchmark_stereomis, benchmark_stir,
     benchmark_labels, benchmark_complaints)
