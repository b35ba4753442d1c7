# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs the build PLIANT_BUILD into WORK/prefix, builds the project SOURCE and that of the folder EXAMPLES against
# that with compiler flags FLAGS, and runs them: on a small sequence that the installed program simulates, and the first
# one on a folder that is not there.
function(run expected_code expected_text)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(FIND "${output}" "${expected_text}" position)
  if(NOT code EQUAL ${expected_code} OR position EQUAL -1)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "'${command}' gave ${code}, expected was ${expected_code} and '${expected_text}':\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(0 "" ${CMAKE_COMMAND} --install ${PLIANT_BUILD} --prefix ${WORK}/prefix)
foreach(project SOURCE EXAMPLES)
  run(0 "" ${CMAKE_COMMAND} -S ${${project}} -B ${WORK}/build/${project} -G ${GENERATOR}
      -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
  run(0 "" ${CMAKE_COMMAND} --build ${WORK}/build/${project})
endforeach()

set(sequence ${WORK}/sequence)
run(0 "8 frames" ${WORK}/prefix/bin/pliant simulate --output_path ${sequence} --Trajectory.frames 8
    --Camera.width 160 --Camera.height 120 --Sensor.samples 1
    --Scene.view_mm 80 --Scene.mesh_step_mm 2 --Texture.smallest_mm 2 --Texture.texel_mm 0.8)
# Eight small frames need not carry a map: what counts is that the pipeline ran to the sequence's end.
run(0 "8 frames" ${WORK}/build/SOURCE/consumer ${sequence} ${WORK}/run)
run(1 "${WORK}/nowhere" ${WORK}/build/SOURCE/consumer ${WORK}/nowhere ${WORK}/run2)
run(0 "sequence" ${WORK}/build/EXAMPLES/live_overlay ${sequence} ${sequence}/camera.yaml ${WORK}/run3 ${WORK}/pictures)
