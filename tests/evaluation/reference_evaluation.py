# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of `pliant evaluate` once more, in NumPy alone and from its documentation; printed as JSON.

Usage: reference_evaluation.py RUN DEPTH_FOLDER GROUNDTRUTH fx fy cx cy [A omega wavelength fps | REFERENCE DECLARED]
Depth: float32 files NNNNNN.npy, mm. With the deformation's four numbers the material error too: its truth is the depth
of a track's first frame, moved by the formula V_y + A sin(omega t + k (V_x + V_y + V_z)). With the two frames of a first
map its error too.
"""
import json
import sys
import numpy as np

run, depth, truth, fx, fy, cx, cy = sys.argv[1:4] + [float(a) for a in sys.argv[4:8]]
motion = [float(a) for a in sys.argv[8:]] if len(sys.argv) == 12 else []
first_map = [int(a) for a in sys.argv[8:]] if len(sys.argv) == 10 else []
poses, true_poses = np.loadtxt(f"{run}/trajectory.txt"), np.loadtxt(truth)
rows = np.loadtxt(f"{run}/observations.csv", delimiter=",", skiprows=1)


def rotation(q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rays(u, v):
    return np.stack([(u - cx) / fx, (v - cy) / fy, np.ones_like(u)], axis=1)


def surface(frame, u, v):
    z = np.load(f"{depth}/{int(frame):06d}.npy").astype(float)
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j
    d = (1 - b) * ((1 - a) * z[j, i] + a * z[j, i + 1]) + b * ((1 - a) * z[j + 1, i] + a * z[j + 1, i + 1])
    return rays(u, v) * d[:, None]


def wave(points, time):
    amplitude, omega, wavelength, _ = motion
    return amplitude * np.sin(omega * time + 2 * np.pi / wavelength * points.sum(1))


def rest(points, time):
    at_rest = points.copy()
    for _ in range(200):  # A k < 1: a contraction
        at_rest[:, 1] = points[:, 1] - wave(at_rest, time)
    return at_rest


def least_median_scale(x, y):
    a, b, c = (x * x).sum(1), (x * y).sum(1), (y * y).sum(1)
    i, j = np.triu_indices(len(a), 1)
    da, db, root = a[i] - a[j], b[i] - b[j], np.sqrt(np.maximum((b[i] - b[j]) ** 2 - (a[i] - a[j]) * (c[i] - c[j]), 0))
    s = np.concatenate([b / a, (db + root) / da, (db - root) / da])  # least of one parabola, or where two meet
    s = s[np.isfinite(s)]
    squares = a[:, None] * s ** 2 - 2 * b[:, None] * s + c[:, None]
    return s[np.argmin(np.partition(squares, len(a) // 2, axis=0)[len(a) // 2])]


def errors(protocol, x, y):
    """Errors of the points that count, at the frame's best scale, and that scale."""
    if protocol == "paper":
        s = (x * y).sum() / (x ** 2).sum()
        return np.linalg.norm(s * x - y, axis=1), s
    if protocol == "depth_trimmed":
        s = np.median(y[:, 2] / x[:, 2])
        e = np.sort(np.abs(s * x[:, 2] - y[:, 2]))
        return e[:len(e) - int(0.05 * len(e))], s
    s = least_median_scale(x, y)
    e = np.linalg.norm(s * x - y, axis=1)
    return e[e <= 2.5 * 1.4826 * (1 + 5 / (len(e) - 1)) * np.sort(e)[len(e) // 2]], s


def figures(frames):
    result = {}
    for protocol in ("paper", "depth_trimmed", "lmeds"):
        for name, index in (("estimate", 0), ("null", 2)):
            by_frame = [errors(protocol, frame[index], frame[1]) for frame in frames]
            pooled = np.concatenate([e for e, _ in by_frame])
            result[f"{protocol}_{name}"] = {
                "mean_rmse_mm": np.mean([np.sqrt((e ** 2).mean()) for e, _ in by_frame]),
                "pooled_median_mm": np.median(pooled),
                "left_out_share": 1 - len(pooled) / sum(len(frame[1]) for frame in frames),
                "max_scale": max(s for _, s in by_frame)}
    return result


def first_map_depth(estimate, null, truth):
    result = {}
    for name, points in (("estimate", estimate), ("null", null)):
        ratios = points[:, 2] / truth[:, 2]
        errors = np.abs(ratios / np.median(ratios) - 1)
        result[name] = {"scale": 1 / np.median(ratios), "median_relative_depth": np.median(errors),
                        "rmse_relative_depth": np.sqrt((errors ** 2).mean()),
                        "p90_relative_depth": np.quantile(errors, 0.9)}
    return result


def angle_deg(a, b):
    return np.degrees(np.arccos(np.clip(a @ b / np.linalg.norm(a) / np.linalg.norm(b), -1, 1)))


on_surface, on_material, drift_mm, drift_px, rest_of = [], [], [], [], {}
for pose, true_pose, frame in zip(poses, true_poses, np.unique(rows[:, 0])):
    points = rows[rows[:, 0] == frame]
    estimate = (points[:, 4:7] - pose[1:4]) @ rotation(pose[4:8])
    u, v = points[:, 2], points[:, 3]
    true_surface = surface(frame, u, v)
    on_surface.append((estimate, true_surface, rays(u, v)))
    if not motion:
        continue
    R, t, time = rotation(true_pose[4:8]), true_pose[1:4], frame / motion[3]
    for point, start in zip(points[:, 1], rest(true_surface @ R.T + t, time)):
        rest_of.setdefault(point, start)
    material = np.array([rest_of[point] for point in points[:, 1]])
    material[:, 1] += wave(material, time)
    material = (material - t) @ R
    on_material.append((estimate, material, rays(u, v)))
    drift_mm.extend(np.linalg.norm(true_surface - material, axis=1))
    pixel = material[:, :2] / material[:, 2:] * [fx, fy] + [cx, cy]
    drift_px.extend(np.linalg.norm(points[:, 2:4] - pixel, axis=1))

a, b = poses[:, 1:4], true_poses[:len(poses), 1:4]
a0, b0 = a - a.mean(0), b - b.mean(0)
U, D, Vt = np.linalg.svd(b0.T @ a0 / len(a))
S = np.diag([1, 1, np.sign(np.linalg.det(U) * np.linalg.det(Vt))])
align = U @ S @ Vt
s = np.trace(np.diag(D) @ S) / (a0 ** 2).sum(1).mean()
residual = s * a0 @ align.T - b0


def matrices(centers, quaternions):
    result = np.tile(np.eye(4), (len(centers), 1, 1))
    result[:, :3, 3] = centers
    result[:, :3, :3] = [rotation(q) for q in quaternions]
    return result


P, Q = matrices(s * a, poses[:, 4:8]), matrices(b, true_poses[:len(poses), 4:8])
E = [np.linalg.inv(np.linalg.inv(Q[i]) @ Q[i + 1]) @ np.linalg.inv(P[i]) @ P[i + 1] for i in range(len(P) - 1)]
result = {"surface": figures(on_surface), "ate_rmse_mm": np.sqrt((residual ** 2).sum(1).mean()),
          "rpe_translation_rmse_mm": np.sqrt(np.mean([e[:3, 3] @ e[:3, 3] for e in E])),
          "rpe_rotation_rmse_deg": np.degrees(np.sqrt(np.mean(
              [np.arccos(np.clip((np.trace(e[:3, :3]) - 1) / 2, -1, 1)) ** 2 for e in E])))}
if motion:
    result["material"] = figures(on_material)
    result["drift"] = {"median_mm": np.median(drift_mm), "rmse_mm": np.sqrt(np.mean(np.square(drift_mm))),
                       "median_px": np.median(drift_px), "p95_px": np.quantile(drift_px, 0.95)}
if first_map:
    numbers = list(np.unique(rows[:, 0]).astype(int))
    reference, declared = [numbers.index(frame) for frame in first_map]
    result["first_map"] = {name: first_map_depth(on_surface[i][0], on_surface[i][2], on_surface[i][1])
                           for name, i in (("reference", reference), ("declared", declared))}
    P, Q = (np.linalg.inv(poses_of[reference]) @ poses_of[declared] for poses_of in (P, Q))
    result["first_map"]["motion"] = {
        "rotation_error_deg": np.degrees(np.arccos(np.clip((np.trace(Q[:3, :3].T @ P[:3, :3]) - 1) / 2, -1, 1))),
        "direction_error_deg": angle_deg(P[:3, 3], Q[:3, 3]), "true_translation_mm": np.linalg.norm(Q[:3, 3])}
json.dump(result, sys.stdout, indent=1)
