# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a campaign damages and what it runs: a small simulated sequence with everything that is made of it."""

import dataclasses
import os
import pathlib
import random
import shutil
import subprocess
import tempfile

BOARD = "%YAML:1.0\n---\nimage_width: 160\nimage_height: 120\nK: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n" \
        "   data: [ 114., 0., 79.5, 0., 114., 59.5, 0., 0., 1. ]\nD: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n" \
        "   data: [ 0.01, 0., 0., 0., 0. ]\n"
XML = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>160</image_width><image_height>120</image_height>\n" \
      "<K type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>114. 0. 79.5 0. 114. 59.5 0. 0. 1.</data></K>\n" \
      "</opencv_storage>\n"


def _raw_video():
    """Eight images of a texture that moves, for standard input, in which nobody can go back to an index."""
    chance = random.Random(1)
    texture = [chance.randbytes(240) for _ in range(120)]
    frames = b"".join(b"FRAME\n" + b"".join(row[2 * k:2 * k + 160] for row in texture) for k in range(8))
    return b"YUV4MPEG2 W160 H120 F30:1 Ip A1:1 Cmono\n" + frames


# A run with a few checkpoints, from which no wall time is written.
RESUMABLE = ("track", "seq", "--General.timings", "none", "--General.checkpoint_frames", "3", "--Init.method", "depth")


def make(program, folder):
    """Makes it once; a folder that this version of it, and of the program, made is taken as it is."""
    state = pathlib.Path(program).stat()
    version = f"{state.st_size} {state.st_mtime_ns}\n" + pathlib.Path(__file__).read_text(encoding="utf-8")
    if (folder / "done").exists() and (folder / "done").read_text(encoding="utf-8") == version:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)

    def run(*arguments):
        subprocess.run([program, *arguments, "--quiet"], cwd=folder, check=True)

    run("simulate", "-o", "seq", "--Trajectory.frames", "24", "--Camera.width", "160", "--Camera.height", "120",
        "--Camera.baseline_mm", "4")
    run("simulate", "-o", "moving", "--Trajectory.frames", "48", "--Camera.width", "240", "--Camera.height", "180",
        "--Scene.kind", "surface", "--Trajectory.kind", "sway", "--Trajectory.sway_period_s", "1.6",
        "--Deformation.amplitude_mm", "2", "--Deformation.omega_rad_s", "8", "--Interruption.blackout_period_s", "1",
        "--Interruption.blackout_s", "0.1", "--Sensor.samples", "1")
    (folder / "seq" / "masks").mkdir()
    for image in sorted((folder / "seq" / "images").iterdir()):  # any image is a mask
        (folder / "seq" / "masks" / image.name).write_bytes(image.read_bytes())
    run("track", "seq", "-o", "run", "--Init.method", "depth")
    run(*RESUMABLE, "-o", "whole")
    run("refine", "--run", "run", "-o", "refined")
    run("surface", "--run", "run", "-o", "surface", "--frames", "4,8")
    run("export", "--run", "run", "-o", "text", "--Export.files", "text")
    run("export", "--run", "run", "-o", "csv", "--format", "tracks_csv")
    run("export", "--run", "run", "-o", "npz", "--format", "tracks_npz")
    run("export", "--run", "run", "-o", "tum", "--format", "tum")
    run("report", "--run", "run", "--video", "-o", "film.mp4")
    (folder / "film.y4m").write_bytes(_raw_video())
    (folder / "opencv.yaml").write_text(BOARD, encoding="utf-8")
    (folder / "opencv.xml").write_text(XML, encoding="utf-8")
    check(program, folder)
    (folder / "done").write_text(version, encoding="utf-8")


def copy(folder, place, copy_function=shutil.copy2):
    """A surface knows its run by its path."""
    shutil.copytree(folder, place, copy_function=copy_function)
    summary = place / "surface" / "surface.json"
    text = summary.read_text(encoding="utf-8").replace(str(folder.resolve()), str(place.resolve()))
    summary.unlink()
    summary.write_text(text, encoding="utf-8")


def check(program, folder):
    """That every reader reads its files before they are damaged: one that is refused for its command tests nothing."""
    with tempfile.TemporaryDirectory() as name:
        place = pathlib.Path(name) / "material"
        copy(folder, place)
        for number, reader in enumerate(READERS):
            words = [word.replace("OUT", f"out_{number}") for word in reader.command]
            stdin = sorted(place.glob(reader.files))[0] if "-" in words else os.devnull
            with open(stdin, "rb") as given:
                ended = subprocess.run([program, *words, "--quiet"], cwd=place, stdin=given, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE, text=True, check=False)
            # Tracking that has nothing to begin with has read what there is.
            has_tracked = any(words in ended.stderr for words in ["ended without a first map", "not enough for a map"])
            if ended.returncode != 0 and not has_tracked:
                raise ValueError(f"{' '.join(words)} fails before anything is damaged: {ended.stderr}")


@dataclasses.dataclass(frozen=True)
class Reader:
    """Files below the material (a glob), and a command that reads them. OUT is a new path."""
    files: str
    command: tuple


def _reader(files, command):
    return Reader(files, tuple(command.split()))


TRACK = "track seq -o OUT --end 5 --Init.method depth"
READERS = [
    _reader("seq/camera.yaml", TRACK),
    _reader("seq/times.txt", TRACK),
    _reader("seq/groundtruth.txt", "dataset info seq"),
    _reader("seq/groundtruth.txt", "evaluate --run run --sequence seq -o OUT"),
    _reader("seq/simulation.yaml", "truth --sequence seq --grid_px 16 -o OUT.csv"),
    _reader("seq/images/00000[0-4].png", TRACK),
    _reader("seq/masks/00000[0-4].png", TRACK + " --mask_path seq/masks"),
    _reader("seq/right/000000.png", "track seq -o OUT --end 5 --Init.method stereo"),
    _reader("seq/depth/00000*.png", TRACK),
    _reader("seq/depth/00000*.png", "evaluate --run run --sequence seq -o OUT"),
    _reader("run/run.json", "report --run run -o OUT.html"),
    _reader("run/config.yaml", "report --run run -o OUT.html"),
    _reader("run/config.yaml", "track seq -o OUT --end 3 --config run/config.yaml"),
    _reader("run/frames.csv", "report --run run -o OUT.html"),
    _reader("run/trajectory.txt", "evaluate --run run --sequence seq -o OUT"),
    _reader("run/observations.csv", "evaluate --run run --sequence seq -o OUT"),
    _reader("run/observations.csv", "export --run run -o OUT"),
    _reader("run/observations.csv", "refine --run run -o OUT"),
    _reader("run/observations.csv", "refine --run run -o OUT --Refine.focal_length estimated"),
    _reader("run/map.ply", "report --run run -o OUT.html"),
    _reader("run/sparse/*.bin", "model check run/sparse"),
    _reader("refined/*.csv", "compare --run run --run refined --sequence seq"),
    _reader("text/*.txt", "model check text"),
    _reader("text/*.txt", "model convert --input_path text --output_path OUT"),
    _reader("text/*.txt", "import --input_path text --sequence seq -o OUT"),
    _reader("tum/*.txt", "import --format tum --input_path tum/trajectory.txt --sequence seq -o OUT"),
    _reader("csv/*.csv", "track seq -o OUT --end 6 --Init.method depth --tracks csv/tracks.csv"),
    _reader("npz/*.npz", "track seq -o OUT --end 6 --Init.method depth --tracks npz/tracks.npz"),
    _reader("surface/surface.json", "report --run run --surface surface -o OUT.html"),
    _reader("surface/depth/*", "report --run run --surface surface -o OUT.html"),
    _reader("surface/mesh/*", "report --run run --surface surface -o OUT.html"),
    _reader("surface/undeformed.ply", "track seq -o OUT --end 3 --Init.method depth --Init.depth_cloud surface/undeformed.ply"),
    _reader("surface/undeformed.ply", "simulate -o OUT --Scene.kind mesh --Scene.mesh_path surface/undeformed.ply"
                                      " --Trajectory.start_pose 0,0,0,0,0,0,1 --Trajectory.frames 1 --Camera.width 64"
                                      " --Camera.height 48"),
    _reader("film.mp4", "dataset info film.mp4 --camera unknown"),
    _reader("film.mp4", "track film.mp4 --camera unknown -o OUT --end 3"),
    _reader("film.y4m", "track - --camera unknown -o OUT --end 6"),
    _reader("opencv.yaml", "track seq -o OUT --end 2 --camera opencv.yaml"),
    _reader("opencv.xml", "track seq -o OUT --end 2 --camera opencv.xml"),
]

# Commands that write, for kills, full disks and limits. OUT is the output.
WRITERS = [tuple(command.split()) for command in [
    "track seq -o OUT --Init.method depth --overwrite",
    "surface --run run -o OUT --frames 4 --overwrite",
    "refine --run run -o OUT --overwrite",
    "report --run run -o OUT.html",
    "report --run run --figure 2,5 -o OUT.pdf",
    "report --run run --figure 2 -o OUT.png",
    "report --run run --video -o OUT.mp4",
    "report --run run --bundle -o OUT",
    "export --run run -o OUT",
    "export --run run --format database -o OUT",
    "export --run run --format tracks_npz -o OUT",
    "export --run run --format nerfstudio -o OUT",
    "evaluate --run run --sequence seq -o OUT",
    "compare --run run --run refined --sequence seq -o OUT.json",
    "model convert --input_path text --output_path OUT",
    "import --input_path text --sequence seq -o OUT --overwrite",
    "dataset convert seq -o OUT --end 6",
    "truth --sequence seq --grid_px 16 -o OUT.csv",
]]
