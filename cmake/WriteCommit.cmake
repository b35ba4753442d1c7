# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause

# cmake -DSOURCE=DIR -DOUTPUT=FILE -P WriteCommit.cmake: a header with the commit that is built, for pliant --version. It
# is written only where it changes, so that it can be asked for at every build. In a source archive git has put the
# commit here (.gitattributes); where neither says it the text is empty.
set(commit "$Format:%h$")
if(NOT commit MATCHES "^[0-9a-f]+$")
  execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --exclude=*
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(text "")
if(commit)
  set(text " (commit ${commit})")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n\ninline constexpr const char* kCommitText = \"@text@\";\n" @ONLY)
