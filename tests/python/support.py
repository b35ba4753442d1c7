# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the package share: the sequence and the run of the end-to-end tests."""

import os
import pathlib
import re
import shutil
import tempfile
import unittest

import numpy as np

SEQUENCE = pathlib.Path(os.environ.get("PLIANT_TEST_SEQUENCE", ""))
RUN = pathlib.Path(os.environ.get("PLIANT_TEST_RUN", ""))


class TestCase(unittest.TestCase):
    """With a folder that is removed in the end."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)


def read_csv(path):
    """The header and the rows of a CSV file, read by Python alone."""
    lines = path.read_text().splitlines()
    return lines[0].split(","), [line.split(",") for line in lines[1:]]


def read_png(path):
    """An 8-bit PNG as OpenCV gives it, by Python alone: (height, width) or (height, width, 3) blue, green, red."""
    bits, color, image = read_png_bytes(path)
    assert bits == 8 and color in (0, 2), (bits, color)
    return image[:, :, 0] if color == 0 else np.ascontiguousarray(image[:, :, ::-1])


def read_png16(path):
    """A 16-bit PNG of one channel: (height, width)."""
    bits, color, image = read_png_bytes(path)
    assert bits == 16 and color == 0, (bits, color)
    return image[:, :, 0].astype(np.uint16) << 8 | image[:, :, 1]


def read_png_bytes(path):
    """Bits of a channel, type of colors, and the bytes of every pixel: (height, width, bytes a pixel)."""
    import struct
    import zlib
    data = path.read_bytes()
    chunks, at = {}, 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunks.setdefault(kind, b"")
        chunks[kind] += data[at + 8:at + 8 + length]
        at += 12 + length
    width, height, depth, color = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    channels = (1 if color == 0 else 3) * depth // 8
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, 1 + width * channels)
    image = np.zeros((height, width * channels), np.uint8)
    above = np.zeros(width * channels, np.uint8)
    for y, row in enumerate(rows):
        above = image[y] = unfiltered(int(row[0]), row[1:], above, channels)
    return depth, color, image.reshape(height, width, channels)


def unfiltered(kind, row, above, channels):
    """A row of a PNG without its filter (0 none, 1 left, 2 above, 3 both, 4 Paeth's)."""
    if kind == 0:
        return row
    if kind == 2:
        return row + above
    if kind == 1:
        return np.cumsum(row.reshape(-1, channels), axis=0, dtype=np.uint8).reshape(-1)
    out = [0] * channels + [0] * len(row)
    above = [0] * channels + above.tolist()
    for i, value in enumerate(row.tolist(), channels):
        left, up, corner = out[i - channels], above[i], above[i - channels]
        if kind == 3:
            guess = (left + up) // 2
        else:
            guess = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                        (abs(left + up - 2 * corner), 2, corner))[2]
        out[i] = (value + guess) & 255
    return np.array(out[channels:], np.uint8)


def images(count):
    """The first images of the sequence."""
    paths = sorted((SEQUENCE / "images").iterdir())[:count]
    return [read_png(path) for path in paths]


def sentence(test, error):
    """The message of an exception, which is one line, and names arguments and options as Python has them."""
    text = str(error)
    test.assertTrue(text and "\n" not in text, text)
    test.assertNotRegex(text, re.compile(r"[.!]$"))
    test.assertNotRegex(text, re.compile(r"(^|[ (])--[A-Za-z]"))
    return text
