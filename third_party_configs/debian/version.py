#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the version of packages that are built of this source: that of the project, or, in a source archive of another
commit than the release's, VERSION+gitDAY.COMMIT, which sorts after the release and before the next one.

usage: version.py
"""

import pathlib
import re

SOURCE = pathlib.Path(__file__).resolve().parents[2]
# In a source archive git has put here the nearest release, the day and the commit (.gitattributes).
ARCHIVED = "$Format:%(describe:tags=true,match=v*) %cs %h$"


def project_version():
    text = (SOURCE / "include" / "pliant" / "base" / "version.h").read_text(encoding="utf-8")
    return re.search(r'kVersion = "([^"]+)"', text).group(1)


def package_version():
    version = project_version()
    if ARCHIVED.startswith("$"):
        return version
    *release, day, commit = ARCHIVED.split()  # there is no release where the clone has no tags
    return version if release == ["v" + version] else f"{version}+git{day.replace('-', '')}.{commit}"


if __name__ == "__main__":
    print(package_version())
