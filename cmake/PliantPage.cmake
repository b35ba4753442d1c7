# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The page of reports and of the live view: one HTML file, which the program carries.
option(PLIANT_BUILD_VIEWER "Build the page of reports and of the live view into the program" ON)
# A source archive holds the page (the target `archive`, `./run archive`): it needs neither Node nor a network.
set(PLIANT_ARCHIVED_PAGE ${PROJECT_SOURCE_DIR}/web/page.html)

# pliant_page(OUTPUT): makes the file OUTPUT, which is empty where PLIANT_BUILD_VIEWER is off. PLIANT_PAGE_IS_BUNDLED
# says whether it is bundled from web/ here.
function(pliant_page output)
  set(bundled FALSE)
  if(NOT PLIANT_BUILD_VIEWER)
    file(GENERATE OUTPUT ${output} CONTENT "")
  elseif(EXISTS ${PLIANT_ARCHIVED_PAGE})
    configure_file(${PLIANT_ARCHIVED_PAGE} ${output} COPYONLY)
  else()
    pliant_bundle_page(${output})
    pliant_archive_target(${output})
    set(bundled TRUE)
  endif()
  set_property(GLOBAL PROPERTY PLIANT_PAGE_IS_BUNDLED ${bundled})
endfunction()

# npm fetches what package-lock.json names, once; who runs the program needs no Node.
function(pliant_bundle_page output)
  find_program(PLIANT_NODE NAMES node nodejs)
  find_program(PLIANT_NPM npm)
  if(NOT PLIANT_NODE OR NOT PLIANT_NPM)
    message(FATAL_ERROR "Pliant's report page is bundled with Node 18 or newer and npm, which are not here; install them "
                        "(Debian: nodejs, npm), build a source archive, which holds the page, or configure with "
                        "-DPLIANT_BUILD_VIEWER=OFF to build without the page")
  endif()
  set(web ${PROJECT_SOURCE_DIR}/web)
  set(folder ${PROJECT_BINARY_DIR}/web)
  set(fetched ${folder}/node_modules/.package-lock.json)
  set(lock ${web}/package.json ${web}/package-lock.json)
  add_custom_command(
    OUTPUT ${fetched}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
    COMMAND ${CMAKE_COMMAND} -E copy ${lock} ${folder}
    COMMAND ${PLIANT_NPM} ci --prefix ${folder} --ignore-scripts --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${fetched}
    DEPENDS ${lock}
    COMMENT "Fetching the libraries of the report page"
    VERBATIM)
  file(GLOB sources CONFIGURE_DEPENDS ${web}/src/*)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${PLIANT_NODE} ${web}/build.mjs ${output} ${folder}
    DEPENDS ${fetched} ${sources} ${web}/build.mjs ${web}/tsconfig.json
    COMMENT "Bundling the report page"
    VERBATIM)
endfunction()

# The target `archive`: pliant-VERSION.tar.gz in the build folder, of the last commit and the bundled page.
function(pliant_archive_target page)
  set(name pliant-${PROJECT_VERSION})
  add_custom_target(
    archive
    COMMAND git archive --output=${PROJECT_BINARY_DIR}/${name}.tar.gz --prefix=${name}/web/ --add-file=${page}
            --prefix=${name}/ HEAD
    DEPENDS ${page}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Writing ${name}.tar.gz"
    VERBATIM)
endfunction()
