# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# One result on every machine: the compiler may not fuse or reorder floating-point operations.
add_compile_options(-ffp-contract=off)

include(GNUInstallDirs)

add_library(pliant_warnings INTERFACE)
target_compile_options(pliant_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual -Wcast-align -Wunused
                       # False alarms of GCC 12 inside std::string and Eigen.
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
if(PROJECT_IS_TOP_LEVEL)
  target_compile_options(pliant_warnings INTERFACE -Werror)
endif()

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
  if(ARG_WHOLE)
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES TIMEOUT 600)
  else()
    gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
  endif()
endfunction()
