#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The man pages and the completion of shells hold what the program says of itself, and Bash completes with it.

usage: manual_test.py PROGRAM FOLDER      FOLDER: what make_manual.py left (PLIANT_BUILD/share)
"""

import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SHARE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
BASH = SHARE / "bash-completion" / "completions" / "pliant"
ZSH = SHARE / "zsh" / "site-functions" / "_pliant"
FISH = SHARE / "fish" / "vendor_completions.d" / "pliant.fish"


def output(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL, **options).stdout


@functools.cache
def manual(*words):
    return output(PROGRAM, *words, "--help-all") or output(PROGRAM, *words, "--help")


def commands():
    """The words of every command that has a manual: ("track",), ("dataset", "info")."""
    for name in re.findall(r"^  ([a-z][\w-]*)  ", output(PROGRAM, "--help"), re.MULTILINE):
        text = manual(name)
        if text.startswith("usage:"):
            yield from ((name, verb) for verb in re.findall(rf"pliant {name} ([a-z]+)", text))
        else:
            yield (name,)


def flags(words):
    """Every --name that the manual lists, as an argument or as an option."""
    lists = manual(*words).partition("\nARGUMENTS\n")[2].partition("\nEXIT CODES\n")[0]
    return re.findall(r"^ {2}(?: {2})?(?:-\w, )?\[?(--[\w.-]+)", lists, re.MULTILINE)


def completed(*words, folder=None):
    """What Bash offers for the last of the words."""
    script = (f'source "{BASH}"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _pliant 2>/dev/null; '
              'printf "%s\\n" "${COMPREPLY[@]}"')
    # Bash takes "=" for a word of its own.
    split = [part for word in words for part in re.split("(=)", word) if part or "=" not in word]
    return output("bash", "--norc", "-c", script, "bash", *split, cwd=folder).split()


class Manual(unittest.TestCase):
    def test_there_are_commands_and_they_have_flags(self):
        self.assertIn(("track",), list(commands()))
        self.assertIn("--Init.method", flags(["track"]))
        self.assertIn("--image_path", flags(["dataset", "info"]))

    def test_every_flag_is_in_the_man_page_of_its_command(self):
        for words in commands():
            text = (SHARE / "man" / "man1" / f"pliant-{'-'.join(words)}.1").read_text().replace("\\-", "-")
            tags = set(re.findall(r"^\.TP\n.*?(--[\w.-]+)", text, re.MULTILINE))
            self.assertEqual(set(flags(words)), tags, words)

    def test_the_text_of_the_manual_is_in_the_man_page(self):
        text = (SHARE / "man" / "man1" / "pliant-track.1").read_text().replace("\\-", "-").replace("\\(aq", "'")
        for sentence in re.findall(r"^        (\w[\w ,]+)\n", manual("track"), re.MULTILINE):
            self.assertIn(sentence, text)

    def test_every_command_is_in_the_overview_which_names_all_pages(self):
        text = (SHARE / "man" / "man1" / "pliant.1").read_text()
        for words in commands():
            self.assertIn(rf"\fB{words[0]}" + r"\fR", text)
            self.assertIn(f"pliant-{'-'.join(words)} (1)", text)

    @unittest.skipUnless(shutil.which("man"), "there is no man")
    def test_man_formats_every_page_without_a_warning(self):
        for page in sorted((SHARE / "man" / "man1").iterdir()):
            run = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(page)],
                                 capture_output=True, text=True, env={**os.environ, "LC_ALL": "C.UTF-8", "MANROFFSEQ": ""})
            self.assertEqual("", run.stderr, page.name)


class Completion(unittest.TestCase):
    def test_bash_knows_exactly_the_flags_of_every_command(self):
        for words in commands():
            known = output("bash", "--norc", "-c", f'source "{BASH}"; _pliant_words "$1"', "bash", " ".join(words))
            self.assertEqual(set(flags(words)), {name for name in known.split() if name.startswith("--")}, words)

    def test_zsh_and_fish_know_every_flag(self):
        zsh, fish = ZSH.read_text(), FISH.read_text()
        for words in commands():
            for flag in flags(words):
                self.assertRegex(zsh, re.escape(flag) + r"[\[=]")
                self.assertRegex(fish, rf"from {words[-1]}' (-s . )?-l {re.escape(flag[2:])} ")

    def test_shells_that_are_here_read_their_files(self):
        for shell, path in (("bash", BASH), ("zsh", ZSH), ("fish", FISH)):
            if shutil.which(shell):
                self.assertEqual(0, subprocess.run([shell, "-n", str(path)]).returncode, shell)

    def test_commands_and_their_verbs(self):
        self.assertEqual(["simulate"], completed("pliant", "si"))
        self.assertIn("track", completed("pliant", ""))
        self.assertEqual(["info"], completed("pliant", "dataset", "i"))
        self.assertIn("--image_path", completed("pliant", "dataset", "convert", "--im"))
        self.assertIn("help", completed("pliant", "he"))
        self.assertEqual(["dataset", "demo"], sorted(completed("pliant", "help", "d")))
        self.assertEqual(["info"], completed("pliant", "help", "dataset", "i"))
        self.assertEqual([], completed("pliant", "help", "track", ""))
        self.assertEqual([], completed("pliant", "help", "dataset", "info", ""))

    def test_arguments_then_groups_of_options_then_options(self):
        self.assertEqual(["--image_path"], completed("pliant", "track", "--image"))
        self.assertEqual(["--Init."], completed("pliant", "track", "--Init"))
        self.assertEqual(["--Init.method"], completed("pliant", "track", "--Init.meth"))
        self.assertEqual(["--output_path"], completed("pliant", "track", "--quiet", "--out"))

    def test_choices(self):
        self.assertEqual(["default", "paper"], completed("pliant", "track", "--preset", ""))
        self.assertEqual(["paper"], completed("pliant", "track", "--preset=p"))
        self.assertIn("window", completed("pliant", "track", "--Init.method", ""))
        self.assertIn("window", completed("pliant", "track", "--Init.method="))
        self.assertEqual(["surface,tracks"], completed("pliant", "evaluate", "--parts", "surface,t"))
        self.assertEqual([], completed("pliant", "track", "--start", ""))

    def test_files_where_a_path_is_wanted(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "clip.mp4").touch()
            (pathlib.Path(folder) / "clips").mkdir()
            self.assertEqual({"clip.mp4", "clips"}, set(completed("pliant", "track", "--image_path", "cl", folder=folder)))
            self.assertEqual(["clips"], completed("pliant", "track", "-o", "cl", folder=folder))
            self.assertIn("clip.mp4", completed("pliant", "dataset", "info", "cl", folder=folder))
            self.assertEqual(["clips"], completed("pliant", "report", "cl", folder=folder))
            self.assertIn("clip.mp4", completed("pliant", "track", "--TrackFile.path=cl", folder=folder))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
