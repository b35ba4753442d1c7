#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The version of packages tells the release from the commits after it, by the source archive alone.

usage: version_test.py SOURCE VERSION      exits with 77 where there is no git, and in a source archive
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest

SOURCE, VERSION = pathlib.Path(sys.argv[1]), sys.argv[2]
FILES = (".gitattributes", "include/pliant/base/version.h", "third_party_configs/debian/version.py")
ENVIRONMENT = {"PATH": os.environ["PATH"], "HOME": "/nonexistent", "GIT_CONFIG_NOSYSTEM": "1", "TZ": "UTC",
               **{f"GIT_{who}_{what}": value for who in ("AUTHOR", "COMMITTER")
                  for what, value in (("NAME", "a"), ("EMAIL", "a@b"), ("DATE", "2026-12-01T12:00:00Z"))}}


def said(*command, folder):
    result = subprocess.run(command, cwd=folder, env=ENVIRONMENT, check=True, text=True, stdout=subprocess.PIPE)
    return result.stdout.strip()


class Version(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.clone = self.folder / "clone"
        for name in FILES:
            (self.clone / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, self.clone / name)
        self.git("init", "--quiet")
        self.git("add", ".")
        self.commit()

    def git(self, *arguments):
        return said("git", *arguments, folder=self.clone)

    def commit(self):
        self.git("commit", "--quiet", "--allow-empty", "--message", "a")

    def archived(self):
        """What an archive of the last commit says."""
        archive, tree = self.folder / "a.tar", self.folder / "tree"
        self.git("archive", f"--output={archive}", "HEAD")
        shutil.rmtree(tree, ignore_errors=True)
        with tarfile.open(archive) as files:
            files.extractall(tree)
        return said(sys.executable, "-B", tree / "third_party_configs/debian/version.py", folder=tree)

    def later(self):
        return f"{VERSION}+git20261201.{self.git('log', '-1', '--format=%h')}"

    def test_the_archive_of_a_release_has_its_version(self):
        self.git("tag", "--annotate", "--message", "a", f"v{VERSION}")
        self.assertEqual(VERSION, self.archived())

    def test_the_tag_of_a_release_may_be_a_name_alone_as_in_clones_of_ci(self):
        self.git("tag", f"v{VERSION}")
        self.assertEqual(VERSION, self.archived())

    def test_a_commit_after_the_release_sorts_after_it_and_before_the_next(self):
        self.git("tag", "--annotate", "--message", "a", f"v{VERSION}")
        self.commit()
        self.assertEqual(self.later(), self.archived())
        if shutil.which("dpkg"):
            following = VERSION.rpartition(".")[0] + ".999"
            for low, high in ((VERSION, self.archived()), (self.archived(), following)):
                subprocess.run(["dpkg", "--compare-versions", low + "-1", "lt", high + "-1"], check=True)

    def test_a_release_of_another_version_and_no_release_are_not_this_one(self):
        self.assertEqual(self.later(), self.archived())
        self.git("tag", "--annotate", "--message", "a", "v0.0.1")
        self.assertEqual(self.later(), self.archived())

    def test_a_working_tree_has_the_version_of_the_project(self):
        self.assertEqual(VERSION, said(sys.executable, "-B", self.clone / FILES[2], folder=self.clone))


if __name__ == "__main__":
    if shutil.which("git") is None or "$Format" not in (SOURCE / FILES[2]).read_text():
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
