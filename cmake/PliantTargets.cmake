# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# One result on every machine: the compiler may not fuse or reorder floating-point operations.
add_compile_options(-ffp-contract=off)
# Nor does it write where the sources lie into what it compiles: ccache shares the results of all clones.
add_compile_options(-fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)

include(GNUInstallDirs)

add_library(pliant_warnings INTERFACE)
target_compile_options(pliant_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual -Wcast-align -Wunused
                       # False alarms of GCC 12 inside std::string and Eigen.
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
option(PLIANT_WARNINGS_ARE_ERRORS "Let a warning end the build" ${PROJECT_IS_TOP_LEVEL})
if(PLIANT_WARNINGS_ARE_ERRORS)
  target_compile_options(pliant_warnings INTERFACE -Werror)
endif()

# Most of the time that a file takes to compile goes into the headers of the libraries and of the modules below, and into
# the templates that they instantiate. Two remedies, which must not hide a missing #include: `./run lint` parses without
# them.
# 1. What nearly every file includes is parsed once (CMAKE_DISABLE_PRECOMPILE_HEADERS=ON: not).
# 2. Several files of a module are compiled at a time. Who works inside a module may prefer 1.
set(PLIANT_BATCH_SIZE 8 CACHE STRING "So many files are compiled at a time")
set(PLIANT_PRECOMPILED_HEADERS
  <algorithm> <array> <cassert> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numbers> <optional>
  <set> <span> <string> <string_view> <utility> <variant> <vector> <Eigen/Dense> <opencv2/core.hpp>)

# pliant_precompile(NAME LIBRARIES ... HEADERS ...): the object library NAME, which precompiles HEADERS for targets with
# the same compiler flags; they say pliant_reuse_precompiled(TARGET NAME).
function(pliant_precompile name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES;HEADERS" ${ARGN})
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cc CONTENT "")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cc)
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} pliant_warnings)
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

function(pliant_reuse_precompiled target name)
  target_precompile_headers(${target} REUSE_FROM ${name})
  # Without it ccache finds nothing that was compiled with a precompiled header.
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>)
  endif()
endfunction()

# Compiles several files of the target at a time: names in their anonymous namespaces must differ.
function(pliant_batch target)
  if(PLIANT_BATCH_SIZE GREATER 1)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${PLIANT_BATCH_SIZE})
    # In a batch every file is taken for a header.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

pliant_precompile(pliant_precompiled LIBRARIES Eigen3::Eigen opencv_core HEADERS ${PLIANT_PRECOMPILED_HEADERS})
set_target_properties(pliant_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)

set_property(GLOBAL PROPERTY PLIANT_MODULES "")

# A module: one static library. DEPENDS names the modules below that it may include, LIBRARIES what it takes from outside.
function(pliant_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LIBRARIES" ${ARGN})
  set(target pliant_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(Pliant::${name} ALIAS ${target})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
                             PRIVATE ${PROJECT_SOURCE_DIR}/src)
  foreach(module IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC pliant_${module})
  endforeach()
  target_link_libraries(${target} PUBLIC ${ARG_LIBRARIES} PRIVATE $<BUILD_INTERFACE:pliant_warnings>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  pliant_reuse_precompiled(${target} pliant_precompiled)
  pliant_batch(${target})
  set_property(GLOBAL APPEND PROPERTY PLIANT_MODULES ${target})
endfunction()

# One test program a module, each of its tests known to CTest by its own name; WHOLE: they share something costly, and are
# one test of CTest.
function(pliant_test name)
  cmake_parse_arguments(ARG "WHOLE" "" "SOURCES;MODULES;LIBRARIES" ${ARGN})
  set(target ${name}_test)
  add_executable(${target} ${ARG_SOURCES})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests)
  foreach(module IN LISTS ARG_MODULES)
    target_link_libraries(${target} PRIVATE pliant_${module})
  endforeach()
  target_link_libraries(${target} PRIVATE ${ARG_LIBRARIES} GTest::gmock GTest::gtest_main pliant_warnings)
  pliant_reuse_precompiled(${target} pliant_test_precompiled)
  pliant_batch(${target})
  if(ARG_WHOLE)
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES TIMEOUT 600)
  else()
    gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300 LABELS ${name})
  endif()
endfunction()
