# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every rule of check_architecture.py finds its violation, in a small library made for it, and nothing else."""

import pathlib
import tempfile
import unittest

import check_architecture

HEAD = "// SPDX-FileCopyrightText: 2026 The Pliant authors\n// SPDX-License-Identifier: BSD-3-Clause\n"


def violations(files):
    """What the check finds in a library of these files (path: text after the SPDX lines)."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text if text.startswith("no head") else HEAD + text)
        return check_architecture.violations(folder)


class Rules(unittest.TestCase):
    def test_a_clean_house_has_no_violation(self):
        self.assertEqual(violations({
            "include/pliant/camera/a.h": '#include "pliant/base/b.h"\n#include "pliant/camera/c.h"\n',
            "src/camera/a.cc": '#include <camera/private.h>\n// std::cout, exit(1)\nconst char* s = "abort()";\n',
            "src/deformation/graph.cc": "#include <flann/flann.hpp>\n#include <flann/io.h>\n",
            "src/cli/main.cc": "std::cout << 1; exit(2);\n",
        }), [])

    def test_a_module_that_includes_one_above_it_is_found(self):
        for include in ('"pliant/tracking/tracker.h"', "<tracking/private.h>"):
            found = violations({"src/camera/a.cc": f"\n#include {include}\n"})
            self.assertEqual(found, ["src/camera/a.cc:4: module camera includes module tracking, which lies above it"])

    def test_an_unknown_module_is_found(self):
        self.assertEqual(len(violations({"src/cellar/a.cc": "\n"})), 1)

    def test_flann_in_a_second_file_is_found(self):
        found = violations({"src/deformation/a.cc": "#include <flann/flann.hpp>\n",
                            "src/deformation/b.cc": "#include <flann/flann.hpp>\n"})
        self.assertEqual(found, ["src/deformation/b.cc:3: flann is already included in src/deformation/a.cc"])

    def test_opengv_in_another_module_is_found(self):
        found = violations({"src/geometry/a.cc": "#include <opengv/types.hpp>\n"})
        self.assertEqual(found, ["src/geometry/a.cc:3: opengv may be included in module estimation only"])

    def test_opengv_in_a_file_of_another_name_is_found(self):
        found = violations({"src/estimation/a.cc": "#include <opengv/types.hpp>\n",
                            "src/estimation/opengv_a.cc": "#include <opengv/types.hpp>\n",
                            "src/estimation/opengv_b.cc": "#include <opengv/types.hpp>\n"})
        self.assertEqual(found, ["src/estimation/a.cc:3: opengv may be included in files opengv_* only"])

    def test_a_private_header_of_another_folder_is_found(self):
        found = violations({"src/estimation/window/a.h": "\n", "src/estimation/b.h": "\n",
                            "src/estimation/window/a.cc": '#include "estimation/window/a.h"\n',
                            "src/estimation/pose/b.cc": '#include "estimation/b.h"\n#include "estimation/window/a.h"\n'})
        self.assertEqual(found, ["src/estimation/pose/b.cc:4: estimation/window/a.h is private to its folder"])

    def test_folders_that_have_an_order_build_on_those_below(self):
        found = violations({"src/tracking/submap/a.h": "\n", "src/tracking/frame/b.h": "\n",
                            "src/tracking/frame/b.cc": '#include "tracking/submap/a.h"\n',
                            "src/tracking/tracker.cc": '#include "tracking/frame/b.h"\n',
                            "src/tracking/submap/a.cc": '#include "tracking/frame/b.h"\n'})
        self.assertEqual(found, ["src/tracking/submap/a.cc:3: tracking/frame/b.h is private to its folder"])

    def test_printing_and_ending_the_process_are_found(self):
        for call in ("std::cout << 1;", "std::cerr << 1;", 'printf("x");', "exit(1);", "std::exit(1);", "abort();",
                     "std::abort();", 'spdlog::info("x");'):
            self.assertEqual(len(violations({"src/io/a.cc": f"void F() {{ {call} }}\n"})), 1, call)

    def test_a_call_of_a_like_name_is_none(self):
        for call in ("reader.abort();", "Snprintf(x);", "std::snprintf(b, 2, x);", "on_exit_(1);"):
            self.assertEqual(violations({"src/io/a.cc": f"void F() {{ {call} }}\n"}), [], call)

    def test_a_missing_spdx_head_is_found(self):
        found = violations({"src/io/a.cc": "no head\n"})
        self.assertEqual(found, ["src/io/a.cc:1: the two SPDX lines are not the first ones"])
        found = violations({"src/io/CMakeLists.txt": "no head\n"})
        self.assertEqual(found, ["src/io/CMakeLists.txt:1: the two SPDX lines are not the first ones"])

    def test_a_link_that_leads_nowhere_is_found(self):
        page = "no head\n\n# A page: `code`, 2 words\n\n"
        found = violations({"docs/a.md": page + "[a](b.md), [wrapped\ntext](c.md)\n", "docs/b.md": "no head\n"})
        self.assertEqual(found, ["docs/a.md:5: the link c.md leads nowhere"])
        found = violations({"docs/a.md": page + "![a](b.png) and <img src=\"c.png\">\n"})
        self.assertEqual(found, ["docs/a.md:5: the link b.png leads nowhere", "docs/a.md:5: the link c.png leads nowhere"])

    def test_an_anchor_that_is_not_there_is_found(self):
        pages = {"docs/b.md": 'no head\n## The terms: (E1) `x_y`\n## Twice\n## Twice\n<a id="free"></a>\n```\n# none\n```\n'}
        good = "[a](b.md#the-terms-e1-x_y) [b](b.md#twice-1) [c](b.md#free) [d](#here) <https://a.b/#c>\n"
        self.assertEqual(violations({**pages, "docs/a.md": "no head\n# Here\n" + good}), [])
        found = violations({**pages, "docs/a.md": "no head\n[a](b.md#none) [b](#here)\n"})
        self.assertEqual(found, ["docs/a.md:2: b.md has no heading '#none'", "docs/a.md:2: a.md has no heading '#here'"])

    def test_a_link_in_code_is_none(self):
        self.assertEqual(violations({"docs/a.md": "no head\n`[a](b)`\n```\n[a](b)\n```\n"}), [])


if __name__ == "__main__":
    unittest.main()
