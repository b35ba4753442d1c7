# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""docs/site/doxygen_filter.py shows Doxygen the comments of declarations, and of nothing else."""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs" / "site"))
import doxygen_filter  # noqa: E402

HEAD = "// SPDX-FileCopyrightText: x\n// SPDX-License-Identifier: x\n\n"
PATH = "include/pliant/estimation/pose/camera_pose.h"


def filtered(text):
    return doxygen_filter.filtered(text).splitlines()


class Comments(unittest.TestCase):
    def test_a_comment_above_a_declaration_describes_it(self):
        self.assertEqual(filtered("#include <x>\n// Of x.\n// More.\nint F(int x);\n"),
                         ["#include <x>", "/// Of x.", "/// More.", "int F(int x);"])

    def test_a_comment_behind_a_member_describes_it_with_its_next_lines(self):
        self.assertEqual(filtered("struct A {\n  int a = 1;  // one,\n              // two\n  int b;  // x\n};\n"),
                         ["struct A {", "  int a = 1;  ///< one,", "              ///< two", "  int b;  ///< x", "};"])

    def test_overloads_that_follow_share_the_comment(self):
        lines = filtered("#include <x>\n// Of x.\nint F(int x);\nint F(float x);\nint G();\n")
        self.assertEqual(lines[3:], ["/** Of x. */ int F(float x);", "int G();"])

    def test_bodies_initializers_and_remarks_stay(self):
        for text in ("inline int F() {\n  // why\n  return 1;  // x\n}", "const int k[] = {\n    1,  // one\n};",
                     "#include <x>\n// A remark.\n\nint a;", "namespace a {\n// end\n}  // namespace a"):
            self.assertEqual(filtered(text), text.splitlines())

    def test_formulas_are_kept_as_written_and_lists_are_lists(self):
        self.assertEqual(filtered("int z;\n// Of x:\n//   a < b\n//    = *c*\n// - one\n//   more\nint x;\n"),
                         ["int z;", "/// Of x:", r"/// \verbatim   a < b", r"///    = *c* \endverbatim", "/// - one",
                          "///   more", "int x;"])

    def test_what_doxygen_would_read_as_a_command_is_escaped(self):
        self.assertEqual(filtered("int z;\n// `a` <b> \\c @d #e --f & 5 %.\nint x;\n")[1],
                         r"/// <code>a</code> &lt;b&gt; \\c \@d \#e \--f &amp; 5 \%.")

    def test_equations_and_pages_are_linked(self):
        line = filtered("int z;\n// See docs/method.md, eq. E7.\nint x;\n")[1]
        self.assertIn('<a href="../../docs/method.html">docs/method.md</a>', line)
        self.assertIn('<a href="../../docs/method.html#E7">E7</a>', line)

    def test_a_header_is_a_group_and_keeps_its_lines(self):
        text = HEAD + "// The pose. In mm.\n#pragma once\n\nnamespace pliant {\n\nint F();\n\n}  // namespace pliant\n"
        lines = doxygen_filter.filtered(text, PATH).split("\n")
        self.assertEqual(lines, [
            r"/// \defgroup estimation__pose__camera_pose pose/camera_pose.h", r"/// \ingroup estimation", "///",
            "/// The pose. In mm.", "#pragma once", "",
            r"namespace pliant { /** \addtogroup estimation__pose__camera_pose", r" * \{ */",
            "int F();", "", r"/** \} */ }  // namespace pliant", ""])

    def test_every_header_is_a_group_and_only_comments_differ(self):
        def code(text):
            return [re.sub(r"\s*(//|/\*).*| \* .*", "", re.sub(r"/\*\*.*?\*/ ", "", line)) for line in text.split("\n")]
        for path in sorted((ROOT / "include").rglob("*.h")):
            text = path.read_text(encoding="utf-8")
            out = doxygen_filter.filtered(text, path)
            self.assertIn(r"\addtogroup", out, path)
            self.assertEqual(code(out), code(text), path)


if __name__ == "__main__":
    unittest.main()
