# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Configures SOURCE in a fresh BUILD with the compiler flags FLAGS, and fails unless that stops with SENTENCE.
file(REMOVE_RECURSE ${BUILD})
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -DCMAKE_CXX_FLAGS=${FLAGS}
                RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result EQUAL 0)
  message(FATAL_ERROR "configuring with ${FLAGS} went through")
endif()
# CMake wraps the sentence into lines.
string(REGEX REPLACE "[ \n]+" " " words "${output}")
string(FIND "${words}" "${SENTENCE}" position)
if(position EQUAL -1)
  message(FATAL_ERROR "configuring with ${FLAGS} stopped without saying '${SENTENCE}' but with:\n${output}")
endif()
