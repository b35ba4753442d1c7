# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# `cmake --install`: the program, the headers, every module but the program's own, and a package that another project
# finds with find_package(Pliant). Pliant::pliant stands for all modules; Pliant::<module> for one and what lies below it.
include(CMakePackageConfigHelpers)

get_property(_pliant_modules GLOBAL PROPERTY PLIANT_MODULES)
list(REMOVE_ITEM _pliant_modules pliant_cli)

add_library(pliant_all INTERFACE)
add_library(Pliant::pliant ALIAS pliant_all)
set_target_properties(pliant_all PROPERTIES EXPORT_NAME pliant)
target_compile_features(pliant_all INTERFACE cxx_std_20)
target_link_libraries(pliant_all INTERFACE ${_pliant_modules})

set(_pliant_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Pliant)
install(TARGETS pliant_all ${_pliant_modules} EXPORT PliantTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET pliant)
  install(TARGETS pliant RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/pliant DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN *.h)
install(EXPORT PliantTargets NAMESPACE Pliant:: DESTINATION ${_pliant_package_dir})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/PliantConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/PliantConfig.cmake INSTALL_DESTINATION ${_pliant_package_dir}
                              NO_SET_AND_CHECK_MACRO)
# Before 1.0 every minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/PliantConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/PliantConfig.cmake ${PROJECT_BINARY_DIR}/PliantConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/PliantDependencies.cmake ${CMAKE_CURRENT_LIST_DIR}/PliantRefuseAvx.cmake
        DESTINATION ${_pliant_package_dir})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
