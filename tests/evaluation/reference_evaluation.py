# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's surface error and evo's ATE once more, in NumPy alone: prints mean RMSE, pooled median, ATE RMSE.

Usage: reference_evaluation.py RUN DEPTH_FOLDER GROUNDTRUTH fx fy cx cy   (depth: float32 files NNNNNN.npy, mm)
"""
import sys
import numpy as np

run, depth, truth, fx, fy, cx, cy = sys.argv[1:4] + [float(a) for a in sys.argv[4:8]]
poses, true_poses = np.loadtxt(f"{run}/trajectory.txt"), np.loadtxt(truth)
rows = np.loadtxt(f"{run}/observations.csv", delimiter=",", skiprows=1)


def rotation(q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


rmses, errors = [], []
for pose, frame in zip(poses, np.unique(rows[:, 0])):
    points = rows[rows[:, 0] == frame]
    estimate = (points[:, 4:7] - pose[1:4]) @ rotation(pose[4:8])
    z = np.load(f"{depth}/{int(frame):06d}.npy")
    u, v = points[:, 2], points[:, 3]
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = u - i, v - j
    d = (1 - b) * ((1 - a) * z[j, i] + a * z[j, i + 1]) + b * ((1 - a) * z[j + 1, i] + a * z[j + 1, i + 1])
    surface = np.stack([(u - cx) / fx * d, (v - cy) / fy * d, d], axis=1)
    scale = (estimate * surface).sum() / (estimate ** 2).sum()
    e = np.linalg.norm(scale * estimate - surface, axis=1)
    rmses.append(np.sqrt((e ** 2).mean()))
    errors.extend(e)

a, b = poses[:, 1:4], true_poses[:len(poses), 1:4]
a0, b0 = a - a.mean(0), b - b.mean(0)
U, D, Vt = np.linalg.svd(b0.T @ a0 / len(a))
S = np.diag([1, 1, np.sign(np.linalg.det(U) * np.linalg.det(Vt))])
s = np.trace(np.diag(D) @ S) / (a0 ** 2).sum(1).mean()
residual = s * a0 @ (U @ S @ Vt).T - b0
print(repr(float(np.mean(rmses))), repr(float(np.median(errors))), repr(float(np.sqrt((residual ** 2).sum(1).mean()))))
