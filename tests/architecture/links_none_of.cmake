# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Fails where one of LIBRARIES, in small letters, matches the regular expression UNWANTED, or pliant_io is not among them.
string(TOLOWER "${LIBRARIES}" libraries)
if(NOT libraries MATCHES "pliant_io")
  message(FATAL_ERROR "the libraries were not found: '${LIBRARIES}'")
endif()
if(libraries MATCHES "${UNWANTED}")
  message(FATAL_ERROR "${CMAKE_MATCH_0} is linked: ${LIBRARIES}")
endif()
