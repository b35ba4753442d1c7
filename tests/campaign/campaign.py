#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damages what the program reads, kills it, fills its disk and takes its resources away, and checks what must hold.

usage: campaign.py PROGRAM WORK [--fail_nth LIBRARY [--faulty_program PROGRAM]] [--minutes M | --cases N] [--seed S]
                   [--jobs J] [--kinds KIND ...]

Cases are drawn by the seed: damaged inputs (mutation), signals at random instants (kill), full disks (disk, as root),
limits on the size and the number of files (limit), runs that are stopped at random instants and resumed until they end,
which then have to be those that were not stopped byte for byte (resume), random options (options), scenes and motions
from which geometry cannot be had (scene), and, with LIBRARY (fail_nth.c), one call that fails: the n-th open, read,
write, fsync, rename, mkdir, thread start or large malloc, and, of the program that is built for it (fail_calls.cc), the
n-th image that is decoded or solver that is called (fault). After each of them the program has to have ended by itself
within a minute, with exit code 0, 1 or 2, a sentence of at most 400 characters where it failed, no file that breaks off under
its final name, and no more than 1 GB of memory. After random options and scenes the run has finite numbers, quaternions
of unit length, documented states, and as many poses as tracked frames. WORK/campaign.json has the counts; what does not
hold stays in WORK/wrong/NUMBER with its input and its command, and makes the exit code 1.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time

import checks
import material
import mutations
import options
import scenes

LONGEST_S = 60
STOP_WITHIN_S = 20
MOST_MEMORY_KB = 1_000_000
MOST_PARTS = 20  # of a run that is resumed
KINDS = ["mutation"] * 12 + ["kill"] * 4 + ["limit"] * 2 + ["disk"] * 2 + ["resume"] * 2 + ["fault"] * 4 + \
        ["options"] * 4 + ["scene"] * 4
FAULTS = ["open", "read", "write", "fsync", "rename", "mkdir", "thread", "malloc", "decode", "solve"]


class Ended:
    """How a process ended."""

    def __init__(self, code, stdout, stderr, kilobytes, hung):
        self.code, self.stdout, self.stderr, self.kilobytes, self.hung = code, stdout, stderr, kilobytes, hung


class Reader(threading.Thread):
    """What comes through a pipe: a file would fall under the limits."""

    def __init__(self, stream):
        super().__init__()
        self.stream, self.text = stream, ""
        self.start()

    def run(self):
        self.text = self.stream.read(1_000_000).decode("utf-8", errors="replace")
        while self.stream.read(1_000_000):
            pass

    def join_text(self):
        self.join()
        self.stream.close()
        return self.text


def run(command, folder, stop_after_s=None, stop=signal.SIGKILL, limits=None, longest_s=LONGEST_S, environment=None):
    """Runs it in `folder`, whose file `input` is its standard input where there is one."""
    def prepare():
        for what, most in (limits or {}).items():
            resource.setrlimit(what, (most, most))

    stdin_path = folder / "input"
    with open(stdin_path if stdin_path.exists() else os.devnull, "rb") as stdin:
        process = subprocess.Popen(command, cwd=folder, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   start_new_session=True, preexec_fn=prepare, env={**os.environ, **(environment or {})})
    readers = [Reader(process.stdout), Reader(process.stderr)]
    begin = time.monotonic()
    hung, stopped = False, False
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            break
        now = time.monotonic() - begin
        if stop_after_s is not None and not stopped and now >= stop_after_s:
            os.kill(process.pid, stop)
            stopped, longest_s = True, stop_after_s + STOP_WITHIN_S
        if now > longest_s and not hung:
            hung = True
            os.kill(process.pid, signal.SIGKILL)
        time.sleep(0.005)
    process.returncode = os.waitstatus_to_exitcode(status)
    stdout, stderr = (reader.join_text() for reader in readers)
    return Ended(process.returncode, stdout, stderr, usage.ru_maxrss, hung)


class Case:
    """One case: a folder with the material, what is done, and what did not hold."""

    fail_nth = None  # the library
    faulty_program = None  # the program for it, where it is another one

    def __init__(self, program, source, folder, seed):
        self.program, self.source, self.folder = str(program), source, folder
        self.chance = random.Random(seed)
        self.kind = self.chance.choice(KINDS)
        self.what = {"kind": self.kind, "seed": seed}
        self.wrong = []

    def execute(self):
        material.copy(self.source, self.folder, os.link)
        getattr(self, self.kind)()
        return self

    def command_of(self, words, out="out"):
        self.what["command"] = " ".join(words).replace("OUT", out)
        return [self.program, *(word.replace("OUT", out) for word in words)]

    def check(self, ended, stopped_by=None, out="."):
        if ended.hung:
            self.wrong.append("did not end in time")
        elif what := checks.wrong_end(ended.code, ended.stderr, stopped_by, ended.stdout):
            self.wrong.append(what + ": " + ended.stderr[-500:])
        if ended.kilobytes > MOST_MEMORY_KB:
            self.wrong.append(f"took {ended.kilobytes // 1000} MB")
        for path in self.outputs(out):
            found = checks.wrong_files(path) if path.is_dir() else [checks.wrong_file(path)]
            if path.stem.endswith(".part") and stopped_by == signal.SIGKILL:
                continue
            self.wrong += [f"left {path.name}/{what}" for what in found if what]

    def outputs(self, out="."):
        return [path for path in (self.folder / out).iterdir() if path.name.startswith("out")]

    def mutation(self):
        reader = self.chance.choice(material.READERS)
        path = self.chance.choice(sorted(path for path in self.folder.glob(reader.files) if path.is_file()))
        data, names = mutations.mutate(path.read_bytes(), self.chance)
        path.unlink()
        path.write_bytes(data)
        self.what |= {"file": str(path.relative_to(self.folder)), "mutations": names}
        if "-" in reader.command:
            (self.folder / "input").write_bytes(data)
        self.check(run(self.command_of(reader.command), self.folder))

    def kill(self):
        command = self.command_of(self.chance.choice(material.WRITERS))
        if self.chance.random() < 0.3 and run(command, self.folder).code != 0:
            self.wrong.append("failed before anything was done to it")
        stop = self.chance.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        self.what["signal"] = stop.name
        self.check(run(command, self.folder, 0.05 + 3 * self.chance.random() ** 2, stop), stop)
        again = run(command, self.folder)
        if again.code != 0 and ("already" in again.stderr or "is there" in again.stderr):
            for path in self.outputs():
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            again = run(command, self.folder)
        if again.code != 0:
            self.wrong.append(f"does not run again: {again.code} {again.stderr[-500:]}")
        self.check(again)

    def resume(self):
        command = self.command_of([*material.RESUMABLE, "-o", "OUT", "--resume"])
        self.what["stops"] = []
        for _ in range(MOST_PARTS):
            stop = self.chance.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
            after_s = 0.1 + 0.9 * self.chance.random()
            self.what["stops"].append(f"{stop.name} {after_s:.3f}")
            ended = run(command, self.folder, after_s, stop)
            self.check(ended, stop)
            if ended.code == 0:
                break
        else:
            self.check(run(command, self.folder))
        self.wrong += checks.differing_runs(self.folder / "whole", self.folder / "out")

    # The n-th of as many calls as the command makes when none fails.
    def fault(self):
        words = self.chance.choice([*material.WRITERS, (*material.RESUMABLE, "-o", "OUT")])
        command = self.command_of(words)
        command[0] = str(Case.faulty_program or command[0])
        counts_path = self.folder / "counts"
        loaded = {"LD_PRELOAD": str(Case.fail_nth)}
        self.check(run(command, self.folder, environment={**loaded, "PLIANT_FAIL_COUNTS": str(counts_path)}))
        counts = {kind: int(count) for kind, count in map(str.split, counts_path.read_text().splitlines())}
        for path in self.outputs():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        kind = self.chance.choice([kind for kind in FAULTS if counts[kind] > 0])
        self.what["fault"] = f"{kind}:{self.chance.randint(1, counts[kind])}"
        failed = run(command, self.folder, environment={**loaded, "PLIANT_FAIL": self.what["fault"]})
        self.check(failed)
        if failed.code != 0 and words[:len(material.RESUMABLE)] == material.RESUMABLE:
            self.check(run([*command, "--resume"], self.folder))
            self.wrong += checks.differing_runs(self.folder / "whole", self.folder / "out")

    def options(self):
        self.track(self.chance.choice(["seq", "moving", "moving"]), *self.drawn_options())

    def scene(self):
        names = [self.chance.choice(sorted(table)) for table in (scenes.SHAPES, scenes.MOTIONS)]
        names += [self.chance.choice(scenes.SPOILS), self.chance.choice(scenes.RATES_HZ), *self.chance.choice([(0, False), (18, False), (18, True)])]
        self.what["scene"] = names
        scenes.write(self.folder / "scene", *names, self.what["seed"])
        given = self.chance.random() < 0.5 or "huge_tracks" in names  # which are in the file of tracks alone
        words = ["--tracks", "scene/tracks.csv"] if given else []
        if self.chance.random() < 0.5:  # what a dozen points suffice for
            words += ["--Tracking.min_corners", "8", "--Init.min_points", "12", "--WindowInit.min_points", "12"]
        if self.chance.random() < 0.3:
            words += self.drawn_options()
        self.track("scene", *words, "--Init.method", self.chance.choice(["window", "window", "gated", "paper"]))

    def drawn_options(self):
        drawn = options.draw(self.program, self.chance)
        (self.folder / "options.yaml").write_text(options.yaml(drawn), encoding="utf-8")
        self.what["options"] = len(drawn)
        return ["--config", "options.yaml"]

    def track(self, *words):
        """And with some of the runs, what is made of one."""
        ended = run(self.command_of(["track", *words, "-o", "OUT"]), self.folder)
        if ended.code == 0 and self.chance.random() < 0.3:
            self.check(ended)
            command = self.chance.choice(["refine --run out -o OUT", "report --run out -o OUT.html",
                                          "export --run out -o OUT",
                                          f"evaluate --run out --sequence {words[0]} -o OUT"])
            self.what["before"] = self.what["command"]
            ended = run(self.command_of(command.split(), "out_of_it"), self.folder)
        self.check(ended)
        for path in [] if self.wrong else self.outputs():
            self.wrong += [f"left {path.name}/{what}" for what in checks.wrong_run(path)]

    def limit(self):
        what = self.chance.choice([resource.RLIMIT_FSIZE, resource.RLIMIT_NOFILE])
        most = (self.chance.choice([0, 100, 4096, 20000, 100000, 1000000]) if what == resource.RLIMIT_FSIZE else
                self.chance.randrange(4, 40))
        self.what["limit"] = f"{'bytes' if what == resource.RLIMIT_FSIZE else 'descriptors'} {most}"
        self.check(run(self.command_of(self.chance.choice(material.WRITERS)), self.folder, limits={what: most}))

    def disk(self):
        disk = self.folder / "disk"
        disk.mkdir()
        kilobytes = self.chance.choice([4, 16, 36, 64, 120, 250, 500])
        self.what["kilobytes"] = kilobytes
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(disk)], check=True)
        try:
            self.check(run(self.command_of(self.chance.choice(material.WRITERS), "disk/out"), self.folder), out="disk")
        finally:
            subprocess.run(["umount", str(disk)], check=True)


def can_mount():
    return os.geteuid() == 0 and shutil.which("mount") is not None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--fail_nth", type=pathlib.Path, default=None)
    parser.add_argument("--faulty_program", type=pathlib.Path, default=None)
    parser.add_argument("--minutes", type=float, default=None)
    parser.add_argument("--cases", type=int, default=None)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--kinds", nargs="+", choices=sorted(set(KINDS)), default=sorted(set(KINDS)))
    arguments = parser.parse_args()
    work = arguments.work.resolve()
    source, wrong = work / "material", work / "wrong"
    shutil.rmtree(wrong, ignore_errors=True)
    wrong.mkdir(parents=True)
    material.make(arguments.program.resolve(), source)
    if not can_mount():
        KINDS[:] = [kind for kind in KINDS if kind != "disk"]
        print("no full disks: only root can mount them", file=sys.stderr)
    if shutil.which("colmap") is None:
        material.WRITERS[:] = [command for command in material.WRITERS if "database" not in command]
        print("no export to a database: there is no program 'colmap' on PATH", file=sys.stderr)
    KINDS[:] = [kind for kind in KINDS if kind in arguments.kinds]
    Case.fail_nth = arguments.fail_nth and arguments.fail_nth.resolve()
    Case.faulty_program = arguments.faulty_program and arguments.faulty_program.resolve()
    if Case.fail_nth is None:
        KINDS[:] = [kind for kind in KINDS if kind != "fault"]
    if not KINDS:
        parser.error("none of these kinds can be drawn: disk needs root, fault --fail_nth")
    if "options" in KINDS or "scene" in KINDS:
        options.check(str(arguments.program.resolve()))
    if arguments.minutes is None and arguments.cases is None:
        arguments.minutes = 30.0
    end = time.monotonic() + 60 * arguments.minutes if arguments.minutes is not None else None

    counts, failures, lock, numbers = collections.Counter(), [], threading.Lock(), iter(range(10**9))

    def work_on():
        while True:
            with lock:
                number = next(numbers)
                if (arguments.cases is not None and number >= arguments.cases) or (end and time.monotonic() > end):
                    return
            folder = work / f"case_{number}"
            case = Case(arguments.program.resolve(), source, folder, arguments.seed * 1_000_003 + number).execute()
            with lock:
                counts[case.kind] += 1
                if case.wrong:
                    failures.append({"number": number, **case.what, "wrong": case.wrong})
                    print(json.dumps(failures[-1]), file=sys.stderr, flush=True)
            if case.wrong:
                shutil.move(folder, wrong / str(number))
            else:
                shutil.rmtree(folder)

    begin = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for done in [pool.submit(work_on) for _ in range(arguments.jobs)]:
            done.result()
    report = {"seed": arguments.seed, "minutes": round((time.monotonic() - begin) / 60, 1), "cases": dict(counts),
              "wrong": failures}
    (work / "campaign.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    table = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    print(f"{sum(counts.values())} cases in {report['minutes']} minutes ({table}): {len(failures)} wrong")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
