# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The other jobs, on the sequence and the run of the end-to-end tests."""

import json
import shutil
import unittest
import warnings

import numpy as np

import pliant
from support import RUN, SEQUENCE, TestCase, read_png16, sentence

COARSE = {"Camera.width": 160, "Camera.height": 120, "Sensor.samples": 1, "Scene.view_mm": 80,
          "Scene.mesh_step_mm": 2, "Texture.smallest_mm": 2, "Texture.texel_mm": 0.8}


class Jobs(TestCase):
    def test_a_simulated_sequence_is_one_and_progress_is_told(self):
        told = []
        pliant.simulate(self.folder / "seq", {**COARSE, "Trajectory.frames": 3},
                        on_progress=lambda *at: told.append(at))
        self.assertEqual(told, [(0, 3), (1, 3), (2, 3), (3, 3)])
        self.assertEqual(len(list((self.folder / "seq" / "images").iterdir())), 3)
        self.assertEqual(pliant.read_camera(self.folder / "seq" / "camera.yaml").width, 160)
        with self.assertRaisesRegex(ValueError, "give one of clean | endoscope"):
            pliant.simulate(self.folder / "seq", realism="cleen")
        with self.assertRaisesRegex(ValueError, "did you mean 'Trajectory.frames'"):
            pliant.simulate(self.folder / "seq", {"Trajectory.frame": 1})

    def test_a_refined_run_is_a_run(self):
        told = []
        run = pliant.open_run(RUN)
        refined = pliant.refine(run, self.folder / "refined", on_progress=lambda *at: told.append(at))
        self.assertEqual(len(refined.poses), len(run.poses))
        self.assertTrue(np.all(refined.observations.sigma > 0))
        covariance = refined.pose_covariance
        self.assertEqual(covariance.shape, (len(run.poses), 6, 6))
        np.testing.assert_array_equal(covariance, covariance.transpose(0, 2, 1))
        self.assertTrue(np.all(np.linalg.eigvalsh(covariance[1:]) > 0))
        self.assertIsNone(run.pose_covariance)
        self.assertEqual(told[-1][1], 1)
        with self.assertRaises(ValueError) as caught:
            pliant.refine(run, RUN)
        sentence(self, caught.exception)

    def test_runs_of_parts_are_joined(self):
        parts = [pliant.track(SEQUENCE, self.folder / f"part{i}", start=20 * i, end=20 * i + 40) for i in range(2)]
        joined = pliant.join(parts, self.folder / "joined")
        self.assertEqual(len(joined.frames), 60)
        self.assertTrue(np.all(joined.poses.submap == 0))
        difference = pliant.evaluate(joined, other_runs=[RUN])["consistency"][0]["estimate"]["median_relative_depth"]
        self.assertLess(difference, 0.05)
        with self.assertRaisesRegex(ValueError, "was given twice"):
            pliant.join([RUN, RUN], self.folder / "twice")

    def test_a_surface_has_depths_of_the_frames(self):
        told = []
        summary = pliant.surface(RUN, self.folder / "surface", {"Surface.vtk": False, "Surface.gltf": False},
                                 frames=np.array([20, 40]), on_progress=lambda *at: told.append(at))
        self.assertEqual([frame["frame"] for frame in summary["frames"]], [20, 40])
        self.assertEqual(len(list((self.folder / "surface" / "depth").iterdir())), 2)
        self.assertIn(("depth", 2, 2), told)
        with self.assertRaisesRegex(ValueError, "has none of the chosen frames"):
            pliant.surface(RUN, self.folder / "other", frames=[9999])
        with self.assertWarnsRegex(UserWarning, "frame 9999 is not in the run, whose frames are 0 to "):
            pliant.surface(RUN, self.folder / "third", {"Surface.mesh_columns": 0}, frames=[20, 9999])

    def test_a_surface_whose_run_was_replaced_is_noted(self):
        surface = pliant.surface(RUN, self.folder / "surface", {"Surface.mesh_columns": 0}, frames=[20])
        notes = pliant.evaluate(RUN, SEQUENCE, surface_path=self.folder / "surface")["notes"]
        self.assertNotIn("replaced", " ".join(notes))
        (self.folder / "surface" / "surface.json").write_text(
            json.dumps({**surface, "trajectory_crc32": "00000000"}))
        with self.assertWarnsRegex(UserWarning, "which was replaced or continued since"):
            pliant.evaluate(RUN, SEQUENCE, surface_path=self.folder / "surface")
        with self.assertRaisesRegex(ValueError, "frames has no frame"):
            pliant.surface(RUN, self.folder / "other", frames=[])

    def test_depth_of_a_surface_is_an_array_that_a_sequence_may_have(self):
        options = {"Surface.vtk": False, "Surface.gltf": False, "Surface.npy": True}
        scale = pliant.surface(RUN, self.folder / "surface", options, frames=[20])["depth_scale"]
        [file] = (self.folder / "surface" / "npy").iterdir()
        depth = np.load(file)
        self.assertEqual((file.name, depth.dtype, depth.shape), ("000020.npy", np.float32, (480, 640)))
        steps = read_png16(self.folder / "surface" / "depth" / "000020.png")
        np.testing.assert_allclose(depth, steps * scale, atol=0.51 * scale)
        self.assertGreater(np.count_nonzero(depth), depth.size / 4)

        sequence = self.folder / "sequence"
        (sequence / "images").mkdir(parents=True)
        (sequence / "depth").mkdir()
        shutil.copy(SEQUENCE / "camera.yaml", sequence)
        shutil.copy(SEQUENCE / "images" / "000020.png", sequence / "images" / "000020.png")
        shutil.copy(file, sequence / "depth")
        np.testing.assert_array_equal(pliant.open_sequence(sequence).depth(0), depth)
        np.save(sequence / "depth" / "000020.npy", depth.astype(int))
        with self.assertRaises(pliant.Error) as caught:
            pliant.open_sequence(sequence).depth(0)
        self.assertIn("float32 or float64, in millimeters", sentence(self, caught.exception))

    def test_an_evaluation_is_its_json(self):
        evaluation = pliant.evaluate(RUN, SEQUENCE, output_path=self.folder)
        self.assertEqual(evaluation, json.loads((self.folder / "evaluation.json").read_text()))
        self.assertTrue((self.folder / "evaluation.csv").exists())
        surface = evaluation["surface"]
        self.assertLess(surface["estimate"]["pooled_median_mm"], surface["null"]["pooled_median_mm"])
        same = pliant.evaluate(pliant.open_run(RUN), other_runs=RUN)
        self.assertEqual(len(same["consistency"]), 1)
        with self.assertRaises(ValueError) as caught:
            pliant.evaluate(RUN)
        self.assertIn("there is nothing to compare the run with", sentence(self, caught.exception))

    def test_runs_are_compared_as_the_command_line_does(self):
        options = {"PointError.protocol": "all"}
        comparison = pliant.compare([pliant.open_run(RUN), RUN], SEQUENCE, options, output_path=self.folder,
                                    figure=self.folder / "figure.svg")
        self.assertEqual(comparison, json.loads((self.folder / "comparison.json").read_text()))
        self.assertEqual([run["run"] for run in comparison["runs"]], 2 * [str(RUN)])
        alone = pliant.evaluate(RUN, SEQUENCE, options)
        for run in comparison["runs"]:
            self.assertEqual(run["surface"]["estimate"]["pooled_median_mm"],
                             alone["surface"]["estimate"]["pooled_median_mm"])
            self.assertEqual(set(run), set(alone) - {"frames"})
        self.assertEqual(len((self.folder / "comparison.csv").read_text().splitlines()), 3)
        self.assertTrue((self.folder / "1" / "evaluation.csv").exists())
        self.assertIn("<svg", (self.folder / "figure.svg").read_text())

    def test_runs_are_compared_without_a_truth(self):
        pliant.export(RUN, self.folder / "path", "tum")
        path = pliant.import_result(next((self.folder / "path").glob("*.txt")), self.folder / "run", SEQUENCE, "tum")
        tasks = []
        comparison = pliant.compare([RUN, RUN, path], on_progress=lambda task, done, total: tasks.append(task))
        first, same, camera_alone = comparison["runs"]
        self.assertEqual(first["consistency"], [])
        self.assertEqual(same["consistency"][0]["other_run"], str(RUN))
        self.assertEqual(same["consistency"][0]["estimate"]["median_relative_depth"], 0)
        self.assertNotIn("estimate", camera_alone["consistency"][0])
        for run in (same, camera_alone):
            self.assertLess(run["consistency"][0]["camera_path"]["ate_share"], 1e-6)
        with self.assertRaisesRegex(ValueError, "there is one run and no sequence"):
            pliant.compare(RUN)

    def test_jobs_say_how_far_they_are(self):
        tasks = []
        tell = lambda task, done, total: tasks.append((task, done <= total))
        pliant.evaluate(RUN, SEQUENCE, on_progress=tell)
        pliant.export(RUN, self.folder / "clouds", "ply", on_progress=tell)
        pliant.report(RUN, self.folder / "page.html", on_progress=tell)
        self.assertGreater(len(set(tasks)), 2, tasks)
        self.assertTrue(all(fits for _, fits in tasks))
        with self.assertRaisesRegex(KeyError, "enough"):
            pliant.evaluate(RUN, SEQUENCE, on_progress=lambda *_: {}["enough"])

    def test_a_run_that_cannot_be_compared_is_a_warning_or_an_error(self):
        missing = self.folder / "missing"
        with self.assertWarnsRegex(UserWarning, "missing"):
            comparison = pliant.compare([missing, RUN], [SEQUENCE, SEQUENCE])
        self.assertEqual([run["run"] for run in comparison["runs"]], [str(RUN)])
        for arguments, kind, message in [(([missing], SEQUENCE), pliant.Error, "missing"),
                                         (([RUN, RUN], [SEQUENCE] * 3), ValueError, "sequences is 3 for 2 runs"),
                                         (([], SEQUENCE), ValueError, "no run to compare"),
                                         ((RUN, SEQUENCE, {"PointError.scales": 1}), ValueError, "PointError.scale")]:
            with self.subTest(message), self.assertRaises(kind) as caught:
                pliant.compare(*arguments, output_path=self.folder / "nothing")
            self.assertIn(message, sentence(self, caught.exception))
        self.assertFalse((self.folder / "nothing").exists())
        with self.assertRaisesRegex(ValueError, "^figure is '.*'; a figure ends with .png or .svg or .pdf"):
            pliant.compare(RUN, SEQUENCE, figure=self.folder / "figure.gif")

    def test_what_was_exported_is_imported(self):
        pliant.export(RUN, self.folder / "model", "canonical")
        run = pliant.import_result(self.folder / "model", self.folder / "run", SEQUENCE)
        self.assertEqual(len(run.poses), len(pliant.open_run(RUN).poses))
        pliant.export(RUN, self.folder / "path", "tum")
        path = next((self.folder / "path").glob("*.txt"))
        lines = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
        path.write_text("".join(" ".join([f"{1e9 * float(t):.0f}", *rest]) + "\n" for t, *rest in lines))
        with self.assertWarnsRegex(UserWarning, "nanoseconds"):
            run = pliant.import_result(path, self.folder / "from_path", SEQUENCE, "tum")
        self.assertEqual(len(run.poses), len(lines))
        with self.assertRaisesRegex(ValueError, "format"):
            pliant.import_result(path, self.folder / "none", SEQUENCE, "no_such")

    def test_arrays_of_another_system_become_a_run(self):
        sequence, frames = pliant.open_sequence(SEQUENCE), [0, 20, 40]  # every 20th frame was given to it
        poses = np.array([sequence.world_from_cam(frame) for frame in frames])
        focal, _, center_u, center_v = np.array(sequence.camera.params)[[0, 1, -2, -1]] * 512 / 640
        np.savez(self.folder / "scene_droid.npz", cam_c2w=poses, depths=np.full((3, 384, 512), 50, np.float32),
                 intrinsic=[[focal, 0, center_u], [0, focal, center_v], [0, 0, 1]])
        written = pliant.convert_arrays(self.folder / "scene_droid.npz", self.folder / "result", "megasam", (640, 480),
                                        stride=20, step_px=64)
        self.assertEqual(written, {"poses": 3, "left_out": 0, "points": 3 * 48, "frames": 3})
        run = pliant.import_result(self.folder / "result", self.folder / "run", SEQUENCE, "result")
        self.assertEqual(list(run.poses.frame_idx), frames)
        np.testing.assert_allclose(run.poses.world_from_cam, poses, atol=1e-4)
        seen = run.frame(20)
        in_cam = (run.poses.cam_from_world[1] @ np.column_stack([seen.position, np.ones(len(seen))]).T)[:3].T
        np.testing.assert_allclose(in_cam[:, 2], 50, atol=1e-3)
        # Its principal point is half a pixel off after resizing.
        np.testing.assert_allclose(sequence.camera.project(in_cam), seen.pixel, atol=0.2)
        with self.assertRaises(pliant.Error) as caught:
            pliant.convert_arrays(self.folder / "none.npz", self.folder / "x", "megasam", (640, 480))
        self.assertEqual(caught.exception.code, "not_found")
        self.assertIn("none.npz", sentence(self, caught.exception))

    def test_tracks_of_a_file_are_scored(self):
        pliant.export(RUN, self.folder / "tracks", "tracks_npz", sequence=SEQUENCE)
        file = next((self.folder / "tracks").glob("*.npz"))
        scored = pliant.evaluate(None, SEQUENCE, tracks=file)["tracks"]
        self.assertGreater(scored["average_within"], 0.9)
        corner = pliant.evaluate(None, SEQUENCE, tracks=file, tracks_pixel_origin="corner")["tracks"]
        self.assertNotEqual(scored["median_px"], corner["median_px"])
        for arguments in ({"run": None}, {"run": RUN, "tracks": file}, {"run": None, "tracks": file, "sequence": None}):
            with self.assertRaises(ValueError):
                pliant.evaluate(**{"sequence": SEQUENCE, **arguments})

    def test_points_are_scored_as_the_stir_challenge_does(self):
        pliant.export(RUN, self.folder / "out", "stir", {"Export.recording": "a"})
        out = self.folder / "out"
        start, positions = (json.loads((out / name).read_text())["a"] for name in ("start.json", "positions.json"))
        run = pliant.open_run(RUN)
        last = run.frame(run.poses.frame_idx[-1])
        nearest = np.linalg.norm(np.array(positions)[:, None] - last.pixel, axis=2).min(axis=1)
        self.assertLess(nearest.max(), 1e-9)
        labels = [positions[k] for k in range(0, len(positions), 10)]
        (self.folder / "end.json").write_text(json.dumps({"a": labels}))
        (self.folder / "labels.json").write_text(json.dumps({"a": [start[k] for k in range(0, len(start), 10)]}))
        pliant.export(RUN, self.folder / "carried", "stir", {"Export.start_points": str(self.folder / "labels.json")})
        score = pliant.evaluate_stir(self.folder / "carried" / "positions.json", self.folder / "labels.json",
                                     self.folder / "end.json", output_path=self.folder)
        self.assertEqual(score, json.loads((self.folder / "stir.json").read_text()))
        self.assertEqual((score["unit"], score["estimate"]["points"]), ("px", len(labels)))
        self.assertLess(score["estimate"]["end_point_error"], 0.5)
        self.assertLess(score["estimate"]["end_point_error"], 0.2 * score["null"]["end_point_error"])
        with self.assertRaises(pliant.Error) as caught:
            pliant.evaluate_stir(self.folder / "missing.json", self.folder / "labels.json", self.folder / "end.json")
        self.assertIn("missing.json", sentence(self, caught.exception))

    def test_the_camera_paths_of_two_runs_are_compared(self):
        other = pliant.evaluate(RUN, other_runs=RUN)["consistency"][0]
        self.assertLess(other["camera_path"]["ate_share"], 1e-9)
        self.assertGreater(other["camera_path"]["poses"], 50)

    def test_an_export_leaves_the_files_of_its_format(self):
        done = pliant.export(RUN, self.folder / "colmap", "spacetime", {"Export.files": "text", "Export.stride": 10})
        self.assertGreater(done["observations"], 0)
        self.assertTrue(list((self.folder / "colmap").rglob("points3D.txt")))
        with self.assertRaises(ValueError) as caught:
            pliant.export(RUN, self.folder / "x", "colmop")
        sentence(self, caught.exception)

    def test_reports_figures_and_films_go_by_their_ending(self):
        options = {"Report.image_width_px": 80, "Figure.panel_width_px": 120}
        pliant.report(RUN, self.folder / "page.html", options)
        self.assertIn("<html", (self.folder / "page.html").read_text()[:1000].lower())
        pliant.report([RUN], self.folder / "figure.png", options, figure=[20, 40])
        self.assertEqual((self.folder / "figure.png").read_bytes()[:4], b"\x89PNG")
        with self.assertRaises(ValueError) as caught:
            pliant.report(RUN, self.folder / "page.png")
        self.assertIn("a report ends with .html or .htm", sentence(self, caught.exception))
        with self.assertRaisesRegex(ValueError, "a figure ends with .png or .svg or .pdf"):
            pliant.report(RUN, self.folder / "page.html", figure=[20])

    def test_what_is_odd_about_a_sequence_is_a_warning(self):
        (self.folder / "seq").mkdir()
        pliant.simulate(self.folder / "seq", {**COARSE, "Trajectory.frames": 4})
        (self.folder / "seq" / "depth" / "000001.png").unlink()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            with self.assertRaises(pliant.Error):
                pliant.track(self.folder / "seq", self.folder / "run")
        self.assertEqual([str(warning.message) for warning in caught if "depth image" in str(warning.message)],
                         ["1 of 4 images have no depth image, the first is 000001.png (frame 1)"])


if __name__ == "__main__":
    unittest.main()
