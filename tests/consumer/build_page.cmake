# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# What the program carries of the page, from builds without Node, npm and network: once from a source archive that
# PLIANT_BUILD makes, once from SOURCE with PLIANT_BUILD_VIEWER off. Everything is made in WORK.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "'${command}' gave ${code}:\n${output}")
  endif()
endfunction()

# Builds the object file that holds the page; its size in bytes.
function(size_of_page_object source build result)
  run(${CMAKE_COMMAND} -S ${source} -B ${build} -G Ninja -DPLIANT_NODE=/bin/false -DPLIANT_NPM=/bin/false
      -DPLIANT_BUILD_TESTS=OFF -DPLIANT_BUILD_BENCHMARKS=OFF ${ARGN})
  set(object src/viewer/CMakeFiles/pliant_viewer.dir/page_asset.S.o)
  run(${CMAKE_COMMAND} --build ${build} --target ${object})
  file(SIZE ${build}/${object} size)
  set(${result} ${size} PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run(${CMAKE_COMMAND} --build ${PLIANT_BUILD} --target archive)
file(ARCHIVE_EXTRACT INPUT ${PLIANT_BUILD}/pliant-${VERSION}.tar.gz DESTINATION ${WORK})

size_of_page_object(${WORK}/pliant-${VERSION} ${WORK}/archived with)
size_of_page_object(${SOURCE} ${WORK}/without without -DPLIANT_BUILD_VIEWER=OFF)
set(smallest_page 100000)
if(with LESS smallest_page OR without GREATER smallest_page)
  message(FATAL_ERROR "the page takes ${with} bytes from the archive, and ${without} where it is left out")
endif()
