# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# pliant_page(OUTPUT): the page of reports, bundled from web/ into one HTML file. npm fetches what package-lock.json names,
# once; who runs the program needs no Node.
find_program(PLIANT_NODE NAMES node nodejs)
find_program(PLIANT_NPM npm)

function(pliant_page output)
  if(NOT PLIANT_NODE OR NOT PLIANT_NPM)
    message(FATAL_ERROR "Pliant's report page is bundled with Node 18 or newer and npm, which are not here; install them "
                        "(Debian: nodejs, npm)")
  endif()
  set(web ${PROJECT_SOURCE_DIR}/web)
  set(place ${PROJECT_BINARY_DIR}/web)
  set(fetched ${place}/node_modules/.package-lock.json)
  set(lock ${web}/package.json ${web}/package-lock.json)
  add_custom_command(
    OUTPUT ${fetched}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${place}
    COMMAND ${CMAKE_COMMAND} -E copy ${lock} ${place}
    COMMAND ${PLIANT_NPM} ci --prefix ${place} --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${fetched}
    DEPENDS ${lock}
    COMMENT "Fetching the libraries of the report page"
    VERBATIM)
  file(GLOB sources CONFIGURE_DEPENDS ${web}/src/*)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${PLIANT_NODE} ${web}/build.mjs ${output} ${place}
    DEPENDS ${fetched} ${sources} ${web}/build.mjs ${web}/tsconfig.json
    COMMENT "Bundling the report page"
    VERBATIM)
endfunction()
