#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the bill of materials of a program as SPDX 2.3 in JSON: every shared library that it loads, directly or not,
by the Debian package that it comes from, with version and source; and the development packages that it is compiled
with, of which headers and static libraries (Eigen, Ceres, OpenGV, ...) are in the program itself.

usage: sbom.py PROGRAM VERSION OUTPUT
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import time


def said(*command):
    return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE).stdout


def libraries(program):
    """The files that the dynamic linker finds for it. Fails where one is missing."""
    lines = said("ldd", program).splitlines()
    missing = [line.split()[0] for line in lines if "not found" in line]
    if missing:
        sys.exit(f"sbom.py: {program} does not start here, {missing[0]} is missing; install it")
    return sorted({match[1] for line in lines if (match := re.search(r"(/\S+) \(0x", line))})


def packages_of(files):
    """The packages that have them; dpkg knows some files by where they lay before /lib became /usr/lib."""
    wanted = {}
    for file in files:
        for path in (file, os.path.realpath(file)):
            for alias in (path, path.removeprefix("/usr"), "/usr" + path):
                wanted[alias] = file
    found = {}
    for names in pathlib.Path("/var/lib/dpkg/info").glob("*.list"):
        for line in names.read_text(encoding="utf-8").splitlines():
            if line in wanted:
                found[wanted[line]] = names.name.removesuffix(".list")
    if len(found) < len(files):
        missing = next(file for file in files if file not in found)
        sys.exit(f"sbom.py: no Debian package has {missing}; this works on Debian and Ubuntu, for their libraries")
    return sorted(set(found.values()))


def compiled_in():
    """The development packages of packages.txt, [build], that are installed here."""
    section, names = "", []
    for line in pathlib.Path(__file__).with_name("packages.txt").read_text(encoding="utf-8").splitlines():
        word = line.split("#")[0].strip()
        section = word if word.startswith("[") else section
        if section == "[build]" and word.endswith("-dev"):
            names.append(word)
    installed = subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Status} ${Package}\\n", *names], check=False,
                               text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    return [name for name in names if f"installed {name}" in installed.splitlines()]


def described(package):
    """The package as SPDX has it, with its licenses where Debian's copyright file says them by name."""
    name, version, source, homepage = said(
        "dpkg-query", "-W", "-f", "${Package}\\t${Version}\\t${source:Package} ${source:Version}\\t${Homepage}", package
    ).split("\t")
    copyright_file = pathlib.Path("/usr/share/doc") / name / "copyright"
    text = copyright_file.read_text(encoding="utf-8", errors="replace") if copyright_file.exists() else ""
    licenses = sorted(set(re.findall(r"^License: *(\S.*)$", text, re.MULTILINE)))
    return {"SPDXID": "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", name), "name": name, "versionInfo": version,
            "supplier": "Organization: Debian", "sourceInfo": "built from " + source,
            "downloadLocation": "NOASSERTION", "homepage": homepage or "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION",
            "comment": "licenses named in Debian's copyright file: " + (", ".join(licenses) or "see " + str(copyright_file)),
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                              "referenceLocator": f"pkg:deb/debian/{name}@{version}"}]}


def main():
    program, version, output = sys.argv[1:4]
    packages = packages_of(libraries(program))
    root = {"SPDXID": "SPDXRef-pliant", "name": "pliant", "versionInfo": version, "downloadLocation": "NOASSERTION",
            "filesAnalyzed": False, "licenseConcluded": "BSD-3-Clause", "licenseDeclared": "BSD-3-Clause",
            "copyrightText": "2026 The Pliant authors"}
    loaded = [described(package) for package in packages]
    compiled = [described(package) for package in compiled_in()]
    # The same bytes for the same source and libraries, where the time is given as reproducible builds have it.
    created = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", time.time()))))
    document = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
                "name": f"pliant-{version}", "documentNamespace": f"https://spdx.org/spdxdocs/pliant-{version}",
                "creationInfo": {"created": created, "creators": ["Tool: sbom.py"]},
                "packages": [root, *loaded, *compiled],
                "relationships": [
                    {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES",
                     "relatedSpdxElement": "SPDXRef-pliant"},
                    *({"spdxElementId": "SPDXRef-pliant", "relationshipType": "DYNAMIC_LINK",
                       "relatedSpdxElement": part["SPDXID"]} for part in loaded),
                    *({"spdxElementId": part["SPDXID"], "relationshipType": "BUILD_DEPENDENCY_OF",
                       "relatedSpdxElement": "SPDXRef-pliant"} for part in compiled)]}
    pathlib.Path(output).write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{len(loaded)} packages with libraries that {program} loads, {len(compiled)} that it is compiled with: {output}")


if __name__ == "__main__":
    main()
