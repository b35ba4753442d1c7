# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of the published benchmarks in small: a simulated scene in the folders, files and units of each set."""

import json
import pathlib
import subprocess

import cv2
import numpy as np

FRAMES = 16
WIDTH, HEIGHT = 160, 120
BASELINE_MM = 5
C3VD_STEP_MM = 100 / 65535
OPTIONS = ["--Camera.width", str(WIDTH), "--Camera.height", str(HEIGHT), "--Camera.baseline_mm", str(BASELINE_MM),
           "--Scene.mesh_step_mm", "0.8", "--Scene.view_mm", "120", "--Texture.texel_mm", "0.3",
           "--Texture.smallest_mm", "0.8", "--Deformation.amplitude_mm", "0", "--Trajectory.frames", str(FRAMES)]


def matrix(words):
    """Of `tx ty tz qx qy qz qw`."""
    tx, ty, tz, x, y, z, w = words
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), tx],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), ty],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), tz], [0, 0, 0, 1]])


class Scene:
    """What `pliant simulate` made, as arrays."""

    def __init__(self, pliant, folder):
        subprocess.run([pliant, "simulate", "--output_path", str(folder), "--quiet", *OPTIONS], check=True)
        self.folder = pathlib.Path(folder)
        read = lambda kind, flag: [cv2.imread(str(path), flag) for path in sorted((self.folder / kind).glob("*.png"))]
        self.images, self.right = read("images", cv2.IMREAD_COLOR), read("right", cv2.IMREAD_COLOR)
        lines = (self.folder / "camera.yaml").read_text().splitlines()
        words = dict(line.split(":", 1) for line in lines if ":" in line)
        self.fx, self.fy, self.cx, self.cy = json.loads(words["params"])
        step_mm = float(words["depth_scale"].split("#")[0])
        self.depths_mm = [step_mm * depth for depth in read("depth", cv2.IMREAD_UNCHANGED)]
        lines = (self.folder / "groundtruth.txt").read_text().splitlines()
        self.lines = [[float(word) for word in line.split()] for line in lines if not line.startswith("#")]
        self.poses = [matrix(line[1:]) for line in self.lines]
        assert len(self.images) == len(self.right) == len(self.depths_mm) == len(self.poses) == FRAMES

    def camera_yaml(self, path):
        path.write_text(f"model: PINHOLE\nwidth: {WIDTH}\nheight: {HEIGHT}\n"
                        f"params: [{self.fx}, {self.fy}, {self.cx}, {self.cy}]\nunit: mm\n")

    def write_pairs(self, path):
        """A video with the left images on top."""
        path.parent.mkdir(parents=True, exist_ok=True)
        writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"mp4v"), 30, (WIDTH, 2 * HEIGHT))
        assert writer.isOpened()
        for left, right in zip(self.images, self.right):
            writer.write(np.vstack([left, right]))
        writer.release()


def write(path, image, *options):
    path.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(path), image, *options)


def poses_by_columns(scene):
    return "".join(",".join(f"{value:.9g}" for value in pose.T.ravel()) + "\n" for pose in scene.poses)


def c3vd(scene, folder):
    for k, (image, depth) in enumerate(zip(scene.images, scene.depths_mm)):
        write(folder / f"{k}_color.png", image)
        write(folder / f"{k:04}_depth.tiff", np.clip(np.rint(depth / C3VD_STEP_MM), 0, 65535).astype(np.uint16))
    (folder / "pose.txt").write_text(poses_by_columns(scene))


def c3vd_v2(scene, folder):
    for k, (image, depth) in enumerate(zip(scene.images, scene.depths_mm)):
        write(folder / f"rgb/{k:04}.png", image)
        write(folder / f"depth/{k:04}_depth.tiff", np.clip(np.rint(depth / C3VD_STEP_MM), 0, 65535).astype(np.uint16))
    (folder / "pose.txt").write_text(poses_by_columns(scene))


def c3vd_v2_deformation(scene, folder):
    for k, image in enumerate(scene.images):
        write(folder / f"rgb/{k:04}.png", image)
    (folder / "pose.txt").write_text(poses_by_columns(scene))


def c3vd_defcol(scene, folder):
    c3vd_v2_deformation(scene, folder)
    for k, depth in enumerate(scene.depths_mm):
        write(folder / f"depth/{k:04}_depth.png", np.clip(np.rint(depth / C3VD_STEP_MM), 0, 65535).astype(np.uint16))
    (folder / "world_vertex_positions.bin").write_bytes(bytes(16))


def scared(scene, folder):
    scene.write_pairs(folder / "data/rgb.mp4")
    k = f"[{scene.fx}, 0, {scene.cx}, 0, {scene.fy}, {scene.cy}, 0, 0, 1]"
    (folder / "endoscope_calibration.yaml").write_text(
        f"M1: {k}\nD1: [0, 0, 0, 0]\nM2: {k}\nD2: [0, 0, 0, 0]\n"
        f"R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [{-BASELINE_MM}, 0, 0]\n")
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH]
    (folder / "data/frame_data").mkdir()
    for frame, (pose, depth) in enumerate(zip(scene.poses, scene.depths_mm)):
        (folder / f"data/frame_data/frame_data{frame:06}.json").write_text(
            json.dumps({"camera-pose": np.linalg.inv(pose).tolist()}))
        z = np.where(depth > 0, depth, np.nan)
        points = np.full((2 * HEIGHT, WIDTH, 3), np.nan, np.float32)
        points[:HEIGHT] = np.dstack([z, z * (rows - scene.cy) / scene.fy, z * (columns - scene.cx) / scene.fx])  # BGR
        write(folder / f"data/scene_points/scene_points{frame:06}.tiff", points, [cv2.IMWRITE_TIFF_COMPRESSION, 1])


def stereomis(scene, folder):
    scene.write_pairs(folder / "IFBS_ENDOSCOPE.mp4")
    text = ""
    for side, x in (("StereoLeft", 0), ("StereoRight", -BASELINE_MM)):
        text += (f"[{side}]\nres_x = {WIDTH}\nres_y = {HEIGHT}\nfc_x = {scene.fx}\nfc_y = {scene.fy}\n"
                 f"cc_x = {scene.cx}\ncc_y = {scene.cy}\n" + "".join(f"kc_{k} = 0\n" for k in range(8)) +
                 "".join(f"R_{k} = {int(k % 4 == 0)}\n" for k in range(9)) + f"T_0 = {x}\nT_1 = 0\nT_2 = 0\n")
    (folder / "StereoCalibration.ini").write_text(text)
    (folder / "groundtruth.txt").write_text("".join(
        f"{k} " + " ".join(f"{value:.9g}" for value in [v / 1000 for v in line[1:4]] + line[4:]) + "\n"
        for k, line in enumerate(scene.lines)))


def endoslam(scene, folder):
    poses = "tX,tY,tZ,rX,rY,rZ,rW,time\n"
    for k, (image, depth, line) in enumerate(zip(scene.images, scene.depths_mm, scene.lines)):
        write(folder / f"Frames/image_{k:04}.png", image)
        depth_cm = np.rint(depth / 10).astype(np.uint8)
        write(folder / f"Pixelwise Depths/aov_image_{k:04}.png",
              np.dstack([depth_cm] * 3 + [np.full_like(depth_cm, 255)]))
        tx, ty, tz, qx, qy, qz, qw = line[1:]
        values = [tx / 1000, -ty / 1000, tz / 1000, -qx, qy, -qz, qw, k / 30]  # y mirrored: Unity is left-handed
        poses += ",".join(f"{value:.9g}" for value in values) + "\n"
    (folder / "Poses").mkdir()
    (folder / "Poses/colon_position_rotation.csv").write_text(poses)


def stir(scene, folder):
    """A sequence left/seq00, and discs of labels at six points of the tissue, in the first and the last pair."""
    for side, images in (("left", scene.images), ("right", scene.right)):
        path = folder / side / "seq00/frames/00000ms-00533ms-visible.mp4"
        path.parent.mkdir(parents=True, exist_ok=True)
        writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"mp4v"), 30, (WIDTH, HEIGHT))
        assert writer.isOpened()
        for image in images:
            writer.write(image)
        writer.release()
    k = [[scene.fx, 0, scene.cx], [0, scene.fy, scene.cy], [0, 0, 1]]
    (folder / "calib.json").write_text(json.dumps({
        "leftcameramat": k, "rightcameramat": k, "leftdistortioncoeffs": [0] * 5, "rightdistortioncoeffs": [0] * 5,
        "rotation": np.eye(3).tolist(), "translation": [-BASELINE_MM / 1000, 0, 0]}))
    seg = {(side, end): np.zeros((HEIGHT, WIDTH, 3), np.uint8) for side in ("left", "right") for end in (0, -1)}
    for k in range(6):
        u, v = (115, 125)[k % 2], 30 + 12 * k  # a near wall, for disparities that labels may have; one label on a row
        z = scene.depths_mm[0][v, u]
        point = [z * (u - scene.cx) / scene.fx, z * (v - scene.cy) / scene.fy, z, 1]
        for end in (0, -1):
            x, y, z = (np.linalg.inv(scene.poses[end]) @ scene.poses[0] @ point)[:3]
            for side, baseline in (("left", 0), ("right", BASELINE_MM)):
                there = (round(scene.fx * (x - baseline) / z + scene.cx), round(scene.fy * y / z + scene.cy))
                cv2.circle(seg[side, end], there, 2, (255, 255, 255), -1)
    for side, images in (("left", scene.images), ("right", scene.right)):
        for end, name in ((0, "start"), (-1, "end")):
            write(folder / side / f"seq00/segmentation/icg{name}seg.png", seg[side, end])
            write(folder / side / f"seq00/00000ms_icg{name}.png", images[end])
