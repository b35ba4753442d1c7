# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C ends what runs: KeyboardInterrupt is raised, and what there is so far is on disk."""

import os
import signal
import threading
import unittest

import pliant
from support import RUN, SEQUENCE, TestCase


def interrupt_after(seconds):
    """Sends this process SIGINT, as Ctrl-C does, from another thread."""
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


# A small scene, so that it stands soon, and more frames than anyone waits for.
ENDLESS = {"Trajectory.frames": 2_000, "Trajectory.kind": "hold", "Camera.width": 160, "Camera.height": 120,
           "Sensor.samples": 1, "Scene.view_mm": 80, "Scene.mesh_step_mm": 2, "Texture.smallest_mm": 2,
           "Texture.texel_mm": 0.8}


class CtrlC(TestCase):
    def test_a_run_ends_after_the_frame_and_keeps_what_it_has(self):
        timers = []
        # The signal comes while the library works, not the callback: it is sent some frames later.
        def start_timer(report):
            if not timers:
                timers.append(interrupt_after(0.05))
        with self.assertRaises(KeyboardInterrupt):
            pliant.track(SEQUENCE, self.folder / "run", on_frame=start_timer)
        timers[0].join()
        run = pliant.open_run(self.folder / "run")
        self.assertEqual(run.summary["status"], "interrupted")
        self.assertLess(len(run.frames), 60)
        self.assertGreater(len(run.frames), 0)
        self.assertEqual(set(run.observations.frame_idx), set(run.poses.frame_idx))

    def test_a_simulation_ends_with_a_sequence_that_can_be_read(self):
        timers = []
        with self.assertRaises(KeyboardInterrupt):
            pliant.simulate(self.folder / "seq", ENDLESS,
                            on_progress=lambda done, total: timers or timers.append(interrupt_after(0.3)))
        self.assertGreater(len(list((self.folder / "seq" / "images").iterdir())), 0)
        self.assertTrue((self.folder / "seq" / "camera.yaml").exists())

    def test_an_evaluation_ends_and_leaves_nothing(self):
        out = self.folder / "evaluation"
        timer = interrupt_after(0.05)
        with self.assertRaises(KeyboardInterrupt):
            pliant.evaluate(RUN, SEQUENCE, output_path=out)
        timer.join()
        self.assertFalse(out.exists())

    def test_what_python_does_about_a_signal_is_as_before(self):
        before = signal.getsignal(signal.SIGINT)
        pliant.simulate(self.folder / "seq", {**ENDLESS, "Trajectory.frames": 1})
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        with self.assertRaises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)

    def test_the_programs_own_handler_is_asked(self):
        caught = []
        before = signal.signal(signal.SIGINT, lambda number, frame: caught.append(number))
        try:
            timers = []
            with self.assertRaises(pliant.Error) as raised:  # the handler raises nothing: the run itself was stopped
                pliant.track(SEQUENCE, self.folder / "run",
                             on_frame=lambda report: timers or timers.append(interrupt_after(0.05)))
        finally:
            signal.signal(signal.SIGINT, before)
        self.assertEqual(caught, [signal.SIGINT])
        self.assertEqual(raised.exception.code, "interrupted")
        self.assertIn("stopped on request after frame", str(raised.exception))

    def test_a_call_in_a_callback_can_be_interrupted_too(self):
        def nested(report):
            interrupt_after(0.1)
            pliant.simulate(self.folder / "seq", ENDLESS)
        with self.assertRaises(KeyboardInterrupt):
            pliant.track(SEQUENCE, self.folder / "run", on_frame=nested)
        self.assertEqual(pliant.open_run(self.folder / "run").summary["status"], "interrupted")


if __name__ == "__main__":
    unittest.main()
