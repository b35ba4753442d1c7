# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sequences from which geometry cannot be had, or hardly: dots in degenerate places that a camera in a degenerate
motion sees, and, beside the images, the exact tracks of the dots."""

import math
import random
import zlib

WIDTH, HEIGHT, FOCAL_PX = 320, 240, 250.0
CENTER_PX = (WIDTH - 1) / 2, (HEIGHT - 1) / 2
FRAMES = 36
DOTS = 150  # of a cloud
GRAY = 110
NOISE_LEVELS = 50
NOTHING = {"equal": GRAY, "black": 0, "white": 255}  # images that show nothing
DOT_PX, DOT_RADIUS_PX = 2.0, 5


def _in_view(chance, count, depth):
    """Points (x right, y down, z ahead) anywhere in the first image; `depth`: of the next one."""
    points = []
    for _ in range(count):
        u_px, v_px, z = chance.uniform(8, WIDTH - 8), chance.uniform(8, HEIGHT - 8), depth()
        points.append(((u_px - CENTER_PX[0]) / FOCAL_PX * z, (v_px - CENTER_PX[1]) / FOCAL_PX * z, z))
    return points


# Where the dots are.
SHAPES = {
    "cloud": lambda chance: _in_view(chance, DOTS, lambda: chance.uniform(40, 120)),
    "dozen": lambda chance: _in_view(chance, 12, lambda: chance.uniform(40, 120)),
    "line": lambda chance: [(-40 + 1.2 * i, -20 + 0.8 * i, 60 + 0.5 * i) for i in range(70)],
    "plane": lambda chance: _in_view(chance, DOTS, lambda: 60.0),
    "depths_1_to_1000": lambda chance: _in_view(chance, DOTS, lambda: 10 * 1000 ** chance.random()),
    "far_away": lambda chance: _in_view(chance, DOTS, lambda: chance.uniform(1e8, 1e9)),
    "one_place": lambda chance: [tuple(at + chance.uniform(-1, 1) for at in (0, 0, 60)) for _ in range(80)],
    "no_shape": lambda chance: _in_view(chance, DOTS, lambda: chance.uniform(40, 120)),  # and every dot wanders
}

# Of the n-th camera: its center, and its angle around the optical axis, degrees. Depths are 80 in the mean.
MOTIONS = {
    "sideways": lambda n: ((0.8 * n, 0.1 * n, 0.0), 0.0),
    "ahead": lambda n: ((0.0, 0.0, 0.5 * n), 0.0),
    "through": lambda n: ((0.0, 0.0, 6.0 * n), 0.0),
    "still": lambda n: ((0.0, 0.0, 0.0), 0.0),
    "one_pixel": lambda n: ((80 / FOCAL_PX * n / (FRAMES - 1), 0.0, 0.0), 0.0),
    "300_pixels": lambda n: ((80 / FOCAL_PX * 300 * (n % 2), 0.0, 0.0), 0.0),
    "turns": lambda n: ((0.0, 0.0, 0.0), 2.0 * n),
    "quarter_turns": lambda n: ((0.5 * n, 0.0, 0.0), 90.0 * n),
}

SPOILS = ["none", "noise", "equal", "black", "white", "huge_tracks"]  # of images, or of the file of tracks
RATES_HZ = [1, 30, 1000]


def camera(motion, frame, begin):
    """Center and angle, degrees: sideways until the frame `begin`, then the motion."""
    center, angle_deg = MOTIONS[motion](max(0, frame - begin))
    return tuple(map(sum, zip(center, MOTIONS["sideways"](min(frame, begin))[0]))), angle_deg


def _points(shape, before, keeps, chance):
    """The dots' points, {dot: point}, once the shape has taken the place of the cloud, or of each second dot of it."""
    if shape in ("cloud", "no_shape"):
        return dict(enumerate(before))
    if not keeps:
        return dict(enumerate(SHAPES[shape](chance)))
    moved = SHAPES[shape](chance)[:DOTS // 2]
    return {dot: point for dot, point in enumerate(before) if dot % 2 == 0} | {
        2 * i + 1: point for i, point in enumerate(moved)}


def tracks(shape, motion, begin, keeps, chance):
    """Of every frame the pixels of the dots in its image, {dot: (u, v)}. Until the frame `begin` they are a cloud that
    a camera passes, of which a map can be made; another shape takes the place of it at once, and with it goes the map.
    Where half of the cloud is kept the map lives on."""
    before = SHAPES["cloud"](chance)
    points = _points(shape, before, keeps, chance)
    frames = []
    for frame in range(FRAMES):
        center, angle_deg = camera(motion, frame, begin)
        cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
        if shape == "no_shape":
            points = {dot: tuple(value + chance.gauss(0, 0.5) for value in point) for dot, point in points.items()}
        seen = {}
        for dot, point in enumerate(before) if frame < begin else points.items():
            x, y, z = (value - origin for value, origin in zip(point, center))
            if z < 1e-3:
                continue
            u_px = (cosine * x + sine * y) / z * FOCAL_PX + CENTER_PX[0]
            v_px = (cosine * y - sine * x) / z * FOCAL_PX + CENTER_PX[1]
            if 0 <= u_px <= WIDTH - 1 and 0 <= v_px <= HEIGHT - 1:
                seen[dot] = u_px, v_px
        frames.append(seen)
    return frames


def image(seen, looks):
    """Its gray levels. Each dot is a grating under a Gaussian: it differs from the others, and has a position."""
    gray = [GRAY] * (WIDTH * HEIGHT)
    for dot, (u_px, v_px) in seen.items():
        right, down, phase = looks[dot]
        for y in range(max(0, int(v_px) - DOT_RADIUS_PX), min(HEIGHT, int(v_px) + DOT_RADIUS_PX + 1)):
            for x in range(max(0, int(u_px) - DOT_RADIUS_PX), min(WIDTH, int(u_px) + DOT_RADIUS_PX + 1)):
                dx, dy = x - u_px, y - v_px
                gray[y * WIDTH + x] += (90 * math.cos(right * dx + down * dy + phase) *
                                        math.exp(-(dx * dx + dy * dy) / (2 * DOT_PX ** 2)))
    return gray


def spoil(gray, frame, what, chance):
    """Noise, or in between a few images that show nothing."""
    if what == "noise":
        levels = [chance.gauss(0, NOISE_LEVELS) for _ in range(1000)]
        return [level + noise for level, noise in zip(gray, chance.choices(levels, k=len(gray)))]
    if what in NOTHING and frame % 12 >= 9:
        return [NOTHING[what]] * len(gray)
    return gray


def png(gray):
    levels = bytes(min(255, max(0, round(level))) for level in gray)
    rows = b"".join(b"\0" + levels[begin:begin + WIDTH] for begin in range(0, len(levels), WIDTH))

    def chunk(name, content):
        return len(content).to_bytes(4, "big") + name + content + zlib.crc32(name + content).to_bytes(4, "big")

    size = WIDTH.to_bytes(4, "big") + HEIGHT.to_bytes(4, "big")
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size + b"\x08\0\0\0\0") + chunk(b"IDAT", zlib.compress(rows, 1)) +
            chunk(b"IEND", b""))


def write(folder, shape, motion, what, rate_hz, begin, keeps, seed):
    """The sequence `folder`, and in it tracks.csv. It is hostile from the frame `begin` on, where `keeps` with a half of
    the dots in their places."""
    chance = random.Random(seed)
    frames = tracks(shape, motion, begin, keeps, chance)
    looks = [(chance.uniform(-0.8, 0.8), chance.uniform(-0.8, 0.8), chance.uniform(0, 6)) for _ in range(200)]
    (folder / "images").mkdir(parents=True)
    rows = ["frame,track_id,u_px,v_px"]
    for frame, seen in enumerate(frames):
        gray = image(seen, looks)
        gray = spoil(gray, frame, what, chance) if frame >= begin else gray
        (folder / "images" / f"{frame:06d}.png").write_bytes(png(gray))
        for dot, (u_px, v_px) in seen.items():
            if what == "huge_tracks" and frame >= begin and chance.random() < 0.02:
                u_px = chance.choice([-1, 1]) * 10.0 ** chance.randint(3, 308)
            rows.append(f"{frame},{dot},{u_px:.9g},{v_px:.9g}")
    (folder / "tracks.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "times.txt").write_text("".join(f"{frame / rate_hz:.6f}\n" for frame in range(FRAMES)), encoding="utf-8")
    (folder / "camera.yaml").write_text(
        f"model: PINHOLE\nwidth: {WIDTH}\nheight: {HEIGHT}\nfps: {rate_hz}\nunit: mm\n"
        f"params: [{FOCAL_PX}, {FOCAL_PX}, {CENTER_PX[0]}, {CENTER_PX[1]}]\n", encoding="utf-8")
