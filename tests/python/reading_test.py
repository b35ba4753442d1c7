# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs as arrays: what the files say, read by Python alone, number by number."""

import json
import pickle
import shutil
import sys
import types
import unittest

import numpy as np

import pliant
from support import RUN, TestCase, read_csv, sentence


class Reading(TestCase):
    result = pliant.open_run(RUN)

    def test_frames_equal_frames_csv(self):
        header, rows = read_csv(RUN / "frames.csv")
        frames = self.result.frames
        self.assertEqual(len(frames), len(rows))
        plain = {"frame": frames.frame_idx, "timestamp": frames.timestamp, "tracked": frames.tracked,
                 "optimized": frames.optimized, "lost": frames.lost, "added": frames.added, "submap": frames.submap,
                 "median_reprojection_error_px": frames.median_reprojection_error_px, "latency_ms": frames.latency_ms}
        plain.update({"cost_" + name: values for name, values in frames.costs.items()})
        plain.update({"ms_" + name: values for name, values in frames.stage_ms.items()})
        self.assertLessEqual({name for name in header if name.startswith(("cost_", "ms_"))}, set(plain))
        for name, values in plain.items():
            np.testing.assert_array_equal(values, [float(row[header.index(name)]) for row in rows], err_msg=name)
        self.assertEqual(list(frames.state), [row[header.index("state")] for row in rows])
        self.assertEqual(frames.has_pose.sum(), len(self.result.poses))

    def test_poses_equal_trajectory_txt(self):
        lines = [line.split() for line in (RUN / "trajectory.txt").read_text().splitlines() if line[:1] != "#"]
        numbers = np.array(lines, float)
        poses = self.result.poses
        np.testing.assert_array_equal(poses.timestamp, numbers[:, 0])
        np.testing.assert_array_equal(poses.world_from_cam[:, :3, 3], numbers[:, 1:4])
        x, y, z, w = numbers[:, 4:].T / np.linalg.norm(numbers[:, 4:], axis=1)
        np.testing.assert_allclose(poses.world_from_cam[:, 2, 1], 2 * (y * z + x * w), atol=1e-14)
        np.testing.assert_allclose(poses.world_from_cam[:, 0, 2], 2 * (x * z + y * w), atol=1e-14)
        np.testing.assert_allclose(poses.cam_from_world @ poses.world_from_cam, np.tile(np.eye(4), (len(poses), 1, 1)),
                                   atol=1e-12)
        np.testing.assert_array_equal(poses.frame_idx, self.result.frames.frame_idx[self.result.frames.has_pose])

    def test_observations_equal_observations_csv(self):
        header, rows = read_csv(RUN / "observations.csv")
        numbers = np.array(rows, float)
        seen = self.result.observations
        self.assertEqual(header, ["frame", "point_id", "u_px", "v_px", "x", "y", "z", "ssim", "sigma_mm"])
        for values, columns in ((seen.frame_idx, 0), (seen.point_id, 1), (seen.pixel, [2, 3]),
                                (seen.position, [4, 5, 6]), (seen.ssim, 7), (seen.sigma, 8)):
            np.testing.assert_array_equal(values, numbers[:, columns])
        self.assertEqual((seen.frame_idx.dtype, seen.point_id.dtype), (np.int32, np.int64))

    def test_a_frame_and_a_point_are_its_rows(self):
        seen = self.result.observations
        frame = self.result.frame(20)
        self.assertGreater(len(frame), 0)
        np.testing.assert_array_equal(frame.point_id, seen.point_id[seen.frame_idx == 20])
        np.testing.assert_array_equal(frame.position, seen.position[seen.frame_idx == 20])
        self.assertTrue(np.shares_memory(frame.position, seen.position))
        point_id = int(frame.point_id[3])
        frames, positions = self.result.path(point_id)
        np.testing.assert_array_equal(frames, seen.frame_idx[seen.point_id == point_id])
        np.testing.assert_array_equal(positions, seen.position[seen.point_id == point_id])
        self.assertTrue(np.shares_memory(positions, self.result.path(point_id)[1]))
        for none in (10_000, 10**12, -1):
            self.assertEqual(len(self.result.frame(none)), 0)
        self.assertEqual(len(self.result.path(10**12)[0]), 0)
        for call in (self.result.frame, self.result.path):
            for value in (1.5, "a", None):
                with self.assertRaisesRegex(TypeError, "give a whole number"):
                    call(value)

    def test_rows_are_chosen_by_slices_masks_and_indices(self):
        for table in (self.result.observations, self.result.frames, self.result.poses, self.result.points):
            columns = table.columns()
            for rows in (slice(2, 9, 3), np.arange(len(table)) % 5 == 0, [4, 1], 3, -1):
                chosen = table[rows]
                self.assertIs(type(chosen), type(table))
                self.assertIn(f"{len(chosen)} rows", repr(chosen))
                for name, values in chosen.columns().items():
                    np.testing.assert_array_equal(values, np.atleast_1d(columns[name][rows]), err_msg=name)
            with self.assertRaises(IndexError):
                table[len(table)]
        self.assertEqual(sum(len(row) for row in self.result.poses), len(self.result.poses))

    def test_a_run_is_copied_and_pickled(self):
        self.assertIsNotNone(self.result.camera)
        again = pickle.loads(pickle.dumps(self.result))
        self.assertEqual(again.camera, self.result.camera)
        np.testing.assert_array_equal(again.poses.world_from_cam, self.result.poses.world_from_cam)

    def test_a_damaged_summary_is_one_sentence(self):
        folder = self.folder / "run"
        shutil.copytree(RUN, folder)
        (folder / "run.json").write_text('{"counts": []}')
        with self.assertRaises(pliant.Error) as caught:
            pliant.report(folder, self.folder / "page.html")
        self.assertNotIn("json.exception", sentence(self, caught.exception))

    def test_points_that_are_seen_project_to_their_pixels(self):
        camera, poses, errors = self.result.camera, self.result.poses, []
        for frame_idx, cam_from_world in zip(poses.frame_idx, poses.cam_from_world):
            frame = self.result.frame(frame_idx)
            points_in_cam = frame.position @ cam_from_world[:3, :3].T + cam_from_world[:3, 3]
            errors.append(np.linalg.norm(camera.project(points_in_cam) - frame.pixel, axis=1))
        self.assertLess(np.median(np.concatenate(errors)), 0.05)  # px; what the digits of the files leave

    def test_the_map_has_the_points_of_two_frames_with_their_color(self):
        points = self.result.points
        self.assertEqual(points.position.shape, (len(points), 3))
        self.assertEqual((points.rgb.shape, points.rgb.dtype), ((len(points), 3), np.uint8))
        self.assertTrue(np.all(np.diff(points.point_id) > 0))
        seen, frames = np.unique(self.result.observations.point_id, return_counts=True)
        np.testing.assert_array_equal(points.point_id, seen[frames > 1])
        self.assertEqual(len(seen), self.result.summary["counts"]["points"])
        self.assertEqual(self.result.names[20], "000020.png")

    def test_the_summary_is_run_json(self):
        self.assertEqual(self.result.summary, json.loads((RUN / "run.json").read_text()))
        self.assertEqual(self.result.summary["status"], "completed")

    def test_a_killed_run_is_read_without_its_last_row(self):
        killed = self.folder / "killed"
        shutil.copytree(RUN, killed)
        shutil.rmtree(killed / "sparse")
        text = (killed / "observations.csv").read_bytes()
        (killed / "observations.csv").write_bytes(text[:len(text) - 5])
        run = pliant.open_run(killed)
        self.assertEqual(len(run.observations), len(self.result.observations) - 1)
        self.assertEqual(len(run.points), 0)
        self.assertEqual(run.camera.width, 640)  # of its sequence

    def test_another_programs_result_has_no_frames(self):
        other = self.folder / "other"
        other.mkdir()
        (other / "trajectory.txt").write_text("0.5 1 2 3 0 0 0 1\n")
        (other / "observations.csv").write_text("frame,point_id,u_px,v_px,x,y,z\n15,7,1,2,3,4,5\n")
        run = pliant.open_run(other)
        self.assertEqual((len(run.frames), run.summary), (0, {}))
        np.testing.assert_array_equal(run.poses.world_from_cam[0, :, 3], [1, 2, 3, 1])
        self.assertEqual(run.poses.frame_idx[0], -1)
        self.assertTrue(np.isnan(run.observations.ssim[0]))
        self.assertEqual((run.camera, run.names, len(run.points)), (None, {}, 0))
        self.assertEqual({name: values.dtype for name, values in run.points.columns().items()},
                         {name: values.dtype for name, values in self.result.points.columns().items()})

    def test_a_run_whose_images_are_gone_has_no_camera(self):
        killed = self.folder / "killed"
        shutil.copytree(RUN, killed)
        shutil.rmtree(killed / "sparse")
        summary = {**json.loads((killed / "run.json").read_text()), "input": str(self.folder / "gone")}
        (killed / "run.json").write_text(json.dumps(summary))
        with self.assertRaises(pliant.Error) as caught:
            pliant.open_run(killed).camera
        self.assertEqual(caught.exception.code, "not_found")
        self.assertIn("gone", sentence(self, caught.exception))

    def test_a_garbled_row_is_an_error_with_file_and_line(self):
        other = self.folder / "other"
        other.mkdir()
        (other / "trajectory.txt").write_text("")
        (other / "observations.csv").write_text("frame,point_id,u_px,v_px,x,y,z\n15,7,1,2,3,4,nan\n")
        run = pliant.open_run(other)
        with self.assertRaises(pliant.Error) as caught:
            run.observations
        self.assertEqual(caught.exception.code, "unreadable")
        self.assertIn("observations.csv:2: 'nan' is not a finite number", sentence(self, caught.exception))

    def test_columns_become_a_data_frame_where_pandas_is(self):
        self.assertEqual(set(self.result.observations.columns()),
                         {"frame_idx", "point_id", "u_px", "v_px", "x", "y", "z", "ssim", "sigma"})
        for table in (self.result.frames, self.result.poses, self.result.observations, self.result.points):
            self.assertEqual({values.shape for values in table.columns().values()}, {(len(table),)})
        stand_in = types.ModuleType("pandas")
        stand_in.DataFrame = dict
        before = sys.modules.get("pandas")
        sys.modules["pandas"] = stand_in
        try:
            np.testing.assert_array_equal(self.result.observations.to_pandas()["x"], self.result.observations.position[:, 0])
        finally:
            del sys.modules["pandas"]
            if before is not None:
                sys.modules["pandas"] = before


if __name__ == "__main__":
    unittest.main()
