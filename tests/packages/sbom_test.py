#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The bill of materials names the packages of the libraries that the program needs, and is valid SPDX 2.3.

usage: sbom_test.py SOURCE PROGRAM
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
SOURCE, PROGRAM = (pathlib.Path(argument) for argument in sys.argv[1:3])


def made(folder, name):
    output = folder / name
    subprocess.run([sys.executable, "-B", SOURCE / "third_party_configs/debian/sbom.py", PROGRAM, "1.2.3", output],
                   check=True, stdout=subprocess.DEVNULL, env={**os.environ, "SOURCE_DATE_EPOCH": "1700000000"})
    return output.read_bytes()


def main():
    if shutil.which("dpkg-query") is None:
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text = made(folder, "one.json")
        assert made(folder, "two.json") == text, "two bills of one program differ"
    document = json.loads(text)
    assert document["spdxVersion"] == "SPDX-2.3" and document["dataLicense"] == "CC0-1.0"
    assert document["creationInfo"]["created"] == "2023-11-14T22:13:20Z"
    packages = {package["name"]: package for package in document["packages"]}
    assert packages["pliant"]["versionInfo"] == "1.2.3"
    for needed in ("libopencv-core", "libc6", "libceres-dev", "libeigen3-dev"):
        assert any(found.startswith(needed) for found in packages), f"{needed} is missing"
    for package in document["packages"]:
        assert re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]), package["SPDXID"]
        assert package["versionInfo"] and package["downloadLocation"], package
    identifiers = [package["SPDXID"] for package in document["packages"]]
    assert len(set(identifiers)) == len(identifiers)
    for relation in document["relationships"]:
        assert relation["relatedSpdxElement"] in identifiers, relation
    return 0


if __name__ == "__main__":
    sys.exit(main())
