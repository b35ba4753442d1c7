#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""debian/, CITATION.cff and the project that uses the library say the same as the rest of the project.

usage: debian_test.py SOURCE VERSION
"""

import json
import pathlib
import re
import sys
import unittest

SOURCE, VERSION = pathlib.Path(sys.argv[1]), sys.argv[2]
# What only ./run and the tests need of the section [build], and what only a package build needs.
NOT_FOR_PACKAGES = set("build-essential ca-certificates ccache python3 nodejs npm libgtest-dev libgmock-dev "
                       "libbenchmark-dev".split())
ONLY_FOR_PACKAGES = {"debhelper-compat", "dh-python"}
# What the installed library does not use, though it is built with it.
NOT_FOR_USERS = {"cmake", "ninja-build", "libcli11-dev", "pybind11-dev", "python3-dev", "python3-numpy"}


def listed(section):
    text = (SOURCE / "third_party_configs" / "debian" / "packages.txt").read_text()
    part = text.partition(f"\n[{section}]\n")[2].partition("\n[")[0]
    return {line.split()[0] for line in part.splitlines() if line.split("#")[0].strip()}


def stated(package, name):
    """The packages of a field in debian/control."""
    paragraph = re.search(rf"^{package}\n.*?(?=\n\n|\Z)", (SOURCE / "debian" / "control").read_text(), re.S | re.M)[0]
    value = re.search(rf"^{name}:(.*(?:\n .*)*)", paragraph, re.M)[1]
    return {entry.split()[0] for entry in value.split(",") if entry.strip() and not entry.strip().startswith("$")}


class Debian(unittest.TestCase):
    def test_the_packages_have_the_version_of_the_project(self):
        self.assertTrue((SOURCE / "debian" / "changelog").read_text().startswith(f"pliant ({VERSION}-"))

    def test_a_package_is_built_with_what_run_installs(self):
        self.assertEqual(listed("build") - NOT_FOR_PACKAGES, stated("Source: pliant", "Build-Depends") - ONLY_FOR_PACKAGES)

    def test_the_documentation_is_built_with_what_run_installs(self):
        self.assertEqual(listed("docs"), stated("Source: pliant", "Build-Depends-Indep"))

    def test_the_library_depends_on_what_it_is_built_with(self):
        self.assertEqual(listed("build") - NOT_FOR_PACKAGES - NOT_FOR_USERS,
                         stated("Package: libpliant-dev", "Depends"))

    def test_the_copyright_names_the_libraries_of_the_page_with_their_versions(self):
        text = " ".join((SOURCE / "debian" / "copyright").read_text().split())
        libraries = json.loads((SOURCE / "web" / "package.json").read_text())["dependencies"]
        self.assertEqual({"three", "uplot"}, set(libraries))
        self.assertIn(f"three.js {libraries['three']} and uPlot {libraries['uplot']}", text)


class Citation(unittest.TestCase):
    def test_it_has_the_version_of_the_project_and_of_the_readme(self):
        self.assertIn(f"\nversion: {VERSION}\n", (SOURCE / "CITATION.cff").read_text())
        self.assertIn(f"version = {{{VERSION}}}", (SOURCE / "README.md").read_text())

    def test_the_change_log_has_the_version_and_the_date_of_the_citation(self):
        date = re.search(r"\ndate-released: (\S+)\n", (SOURCE / "CITATION.cff").read_text()).group(1)
        self.assertIn(f"\n## {VERSION}, {date}\n", (SOURCE / "CHANGELOG.md").read_text())


class Library(unittest.TestCase):
    def test_the_project_that_uses_it_asks_for_its_minor_version(self):
        text = (SOURCE / "tests" / "consumer" / "project" / "CMakeLists.txt").read_text()
        self.assertIn(f"find_package(Pliant {VERSION.rpartition('.')[0]} REQUIRED)", text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
