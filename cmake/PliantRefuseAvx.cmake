# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The distributed OpenGV is compiled for SSE2. Eigen aligns its types by the widest vectors that the compiler may use,
# so code compiled for AVX and OpenGV disagree about the layout and the allocation of the same types.
set(_pliant_flags "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_RELEASE} ${CMAKE_CXX_FLAGS_DEBUG} \
${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")
if(_pliant_flags MATCHES "(-mavx[^ ]*|-mfma|-march=[^ ]*)")
  set(_pliant_flag "${CMAKE_MATCH_1}")
  if(NOT _pliant_flag MATCHES "^-march=(x86-64|x86-64-v2)$")
    message(FATAL_ERROR
      "Pliant cannot be built with ${_pliant_flag}: OpenGV's library is compiled for SSE2, and under AVX Eigen aligns "
      "its types differently, so calls into OpenGV crash with a double free. Remove the flag; wide vectors are chosen "
      "at run time where they pay.")
  endif()
endif()
