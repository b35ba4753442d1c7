# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the Python blocks of a page of the documentation, one after the other, in a folder with what the page says is
there. What a block takes from a network is taken from the sequence and the run of the end-to-end tests.

usage: page_test.py SOURCE README|python|tracks|your_own_video
"""

import os
import pathlib
import re
import shutil
import sys
import tempfile
import types

import numpy as np

import pliant
import support

WIDTH, HEIGHT = 640, 480  # of the sequence
ROUNDING_PX = 1e-3  # of float32


def opencv():
    """OpenCV, or of it what the pages use."""
    try:
        import cv2
        return cv2
    except ImportError:
        stand_in = types.ModuleType("cv2")
        stand_in.imread = lambda name: support.read_png(pathlib.Path(name))
        return stand_in


class Page:
    """The blocks of a page, which are run in one namespace."""

    def __init__(self, path, at_least):
        self.path, self.names = path, {}
        self.text = path.read_text(encoding="utf-8")
        self.blocks = list(re.finditer(r"^```python\n(.*?)^```$", self.text, re.DOTALL | re.MULTILINE))
        assert len(self.blocks) >= at_least, f"{path} has {len(self.blocks)} blocks of Python, not {at_least}"

    def run(self, **names):
        """Runs the next block, which knows these names too."""
        self.names.update(names)
        block = self.blocks.pop(0)
        # Line numbers of an error are those of the page.
        lines = "\n" * self.text.count("\n", 0, block.start(1))
        exec(compile(lines + block.group(1), str(self.path), "exec"), self.names)


def python(source):
    page = Page(source / "docs/python.md", 5)
    os.symlink(support.SEQUENCE, "colon")
    while page.blocks:
        page.run()


def readme(source):
    page = Page(source / "README.md", 1)
    os.symlink(support.SEQUENCE, "clip.mp4")  # a folder of images is read by the same call
    os.symlink(support.SEQUENCE / "camera.yaml", "camera.yaml")
    while page.blocks:
        page.run()
    assert len(page.names["points"].pixel) > 0


# docs/tracks.md

class Tensor(np.ndarray):
    """An array with the methods of PyTorch's that the page calls."""

    device = "cpu"

    def to(self, _device):
        return self

    def cpu(self):
        return self

    def numpy(self):
        return np.asarray(self)


def follower(tracks, visibility):
    """Stands in for CoTracker: a queried point moves like the track that is nearest to it."""

    def follow(video, queries):
        assert video.shape[:3] == (1, len(tracks), 3) and queries.shape[::2] == (1, 3) and queries.dtype == np.float32
        found, seen = [], []
        for t, x, y in np.asarray(queries[0]):
            t = int(t)
            distance = np.where(visibility[t], np.linalg.norm(tracks[t] - [x, y], axis=1), np.inf)
            nearest = np.argmin(distance)
            found.append(tracks[:, nearest] - tracks[t, nearest] + [x, y])
            seen.append(visibility[:, nearest])
        return np.stack(found, 1)[None].astype(np.float32).view(Tensor), np.stack(seen, 1)[None].view(Tensor)

    return follow


def check_file(name, tracks, visibility):
    """The file has these tracks, whose (0, 0) is the corner of the image, and Pliant follows them."""
    with np.load(name) as arrays:
        assert arrays["tracks"].dtype == np.float32 and arrays["visibility"].dtype == bool
        for array in arrays.values():
            assert array.flags.c_contiguous, name
        assert np.array_equal(arrays["visibility"], visibility)
        assert np.abs(arrays["tracks"] - tracks - 0.5)[visibility].max() < ROUNDING_PX
    run = pliant.track(support.SEQUENCE, f"run_{name}", {"TrackFile.pixel_origin": "corner"}, tracks=name, end=20)
    seen = run.observations
    assert len(seen.pixel) > 1000 and visibility[seen.frame_idx, seen.point_id].all()
    assert np.abs(seen.pixel - tracks[seen.frame_idx, seen.point_id]).max() < ROUNDING_PX


def tracks(source):
    page = Page(source / "docs/tracks.md", 4)
    pliant.export(support.RUN, "tracks", "tracks_npz")
    with np.load("tracks/tracks.npz") as arrays:
        tracks, visibility = arrays["tracks"], arrays["visibility"]

    torch = types.ModuleType("torch")
    torch.float32 = np.float32
    torch.tensor = lambda values, dtype: np.asarray(values, dtype).view(Tensor)
    sys.modules["torch"] = torch
    video = np.broadcast_to(np.float32(0), (1, len(tracks), 3, HEIGHT, WIDTH)).view(Tensor)
    page.run(video=video, cotracker=follower(tracks, visibility))
    with np.load("cotracker.npz") as arrays:
        first = np.argmax(arrays["visibility"], axis=0)  # in which a track is seen
        assert arrays["visibility"].any(axis=0).sum() > 1000 and set(first) == {0, 20, 40}, set(first)
    scores = pliant.evaluate(None, support.SEQUENCE, tracks="cotracker.npz")["tracks"]
    assert scores["tracks"] > 1000 and scores["within_16"] > 0.5, scores

    by_point = np.ascontiguousarray(tracks.transpose(1, 0, 2)) + np.float32(0.5)
    hidden = np.ascontiguousarray(~visibility.T)
    size = 256
    logits = np.where(hidden, np.float32(6), np.float32(-6))
    page.run(tracks=by_point * np.float32([size / WIDTH, size / HEIGHT]), occlusion=logits,
             expected_dist=np.full_like(logits, -3), size=size, W=WIDTH, H=HEIGHT)
    check_file("tapir.npz", tracks, visibility)

    page.run(data={"points": by_point / np.float32([WIDTH, HEIGHT]), "occluded": hidden})
    check_file("tapvid.npz", tracks, visibility)

    page.run()
    assert page.names["tracks"].shape == tracks.shape and page.names["visibility"].shape == visibility.shape


def your_own_video(source):
    page = Page(source / "docs/your_own_video.md", 1)
    os.mkdir("images")
    images = sorted((support.SEQUENCE / "images").iterdir())[:20]
    for image in images:
        os.symlink(image, pathlib.Path("images") / image.name)
    true = pliant.open_sequence(support.SEQUENCE)
    asked = iter(range(len(images)))

    def infer_image(image):
        assert image.shape == (HEIGHT, WIDTH, 3) and image.dtype == np.uint8
        depth = true.depth(next(asked))
        return np.divide(1, depth, out=np.zeros_like(depth), where=depth > 0)

    page.run(model=types.SimpleNamespace(infer_image=infer_image))
    run = pliant.track("images", "run", {"Init.method": "depth_prior"}, camera=support.SEQUENCE / "camera.yaml",
                       depth_prior="prior")
    depth = run.frame(0).position[:, 2]
    u, v = np.round(run.frame(0).pixel).astype(int).T
    ratio = depth / true.depth(0)[v, u]
    assert np.median(np.abs(ratio / np.median(ratio) - 1)) < 0.01, "the depth of the first frame is the prior's"


def main(source, name):
    sys.modules["cv2"] = opencv()
    folder = tempfile.mkdtemp()
    try:
        os.chdir(folder)
        {"README": readme, "python": python, "tracks": tracks, "your_own_video": your_own_video}[name](source)
    finally:
        os.chdir(source)
        shutil.rmtree(folder)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2])
