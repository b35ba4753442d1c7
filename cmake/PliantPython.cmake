# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The Python package `pliant`: python/pliant and the compiled module _pliant of src/python. In the build tree it is
# whole in python/ (PYTHONPATH=build/release/python).

# Of several interpreters on PATH the first that has NumPy, with which the package is built; -DPython3_EXECUTABLE=...
# decides otherwise. The tests that are written in Python run in it too.
function(pliant_has_numpy result python)
  execute_process(COMMAND ${python} -c "import numpy" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(NOT failed EQUAL 0)
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

if(NOT Python3_EXECUTABLE)
  find_program(PLIANT_PYTHON_EXECUTABLE NAMES python3 python VALIDATOR pliant_has_numpy
               DOC "The Python interpreter that the package pliant is built for")
  if(NOT PLIANT_PYTHON_EXECUTABLE)
    message(FATAL_ERROR "Pliant's Python package needs a Python 3 with NumPy, and there is none on PATH; install them "
                        "(Debian: python3-dev, python3-numpy), or configure with -DPLIANT_PYTHON=OFF")
  endif()
  set(Python3_EXECUTABLE ${PLIANT_PYTHON_EXECUTABLE})
endif()
find_package(Python3 3.9 REQUIRED COMPONENTS Interpreter Development.Module NumPy)
find_package(pybind11 2.10 CONFIG REQUIRED)

set(PLIANT_PYTHON_BUILD_DIR ${PROJECT_BINARY_DIR}/python)
set(PLIANT_PYTHON_DIR "" CACHE STRING
    "Where the Python package is installed, below the prefix; empty: where the Python of that prefix looks")

# pliant_python_package(MODULE): puts the package's files beside the target MODULE in the build tree, and installs both.
function(pliant_python_package module)
  file(GLOB files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/python
       ${PROJECT_SOURCE_DIR}/python/pliant/*.py ${PROJECT_SOURCE_DIR}/python/pliant/*.pyi
       ${PROJECT_SOURCE_DIR}/python/pliant/py.typed)
  foreach(file IN LISTS files)
    configure_file(${PROJECT_SOURCE_DIR}/python/${file} ${PLIANT_PYTHON_BUILD_DIR}/${file} COPYONLY)
  endforeach()
  set_target_properties(${module} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PLIANT_PYTHON_BUILD_DIR}/pliant)
  # The prefix may be chosen when it is installed. Debian's own Python looks into dist-packages below /usr/local.
  install(CODE "
    set(pliant_python_dir \"${PLIANT_PYTHON_DIR}\")
    if(pliant_python_dir STREQUAL \"\")
      set(pliant_python_dir lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages)
      string(FIND \"${Python3_SITEARCH}\" \"\${CMAKE_INSTALL_PREFIX}/lib/\" pliant_python_at)
      if(pliant_python_at EQUAL 0)
        file(RELATIVE_PATH pliant_python_dir \"\${CMAKE_INSTALL_PREFIX}\" \"${Python3_SITEARCH}\")
      endif()
    endif()" COMPONENT python)
  list(TRANSFORM files PREPEND ${PROJECT_SOURCE_DIR}/python/)
  install(FILES ${files} DESTINATION "\${pliant_python_dir}/pliant" COMPONENT python)
  install(TARGETS ${module} LIBRARY DESTINATION "\${pliant_python_dir}/pliant" COMPONENT python)
endfunction()
