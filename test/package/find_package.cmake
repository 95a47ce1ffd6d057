# Installs the built library into a prefix, then configures, builds and runs a project that only knows
# find_package(rio).
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nfailed:\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/test/package/consumer -B ${WORK}/build
  -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
  -DEXAMPLES=${SOURCE}/src/examples)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/link)
# a program of rio::core with another layout of its state does not link
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE}/test/package/consumer -B ${WORK}/aligned
  -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${COMPILER}
  "-DCMAKE_CXX_FLAGS=${FLAGS} -DEIGEN_MAX_ALIGN_BYTES=0" -DEXAMPLES=${SOURCE}/src/examples OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/aligned --target core RESULT_VARIABLE result
  OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "is_aligned_as_in_the_library<0>")
  message(FATAL_ERROR "rio::core links with another alignment of Eigen:\n${output}")
endif()
run(${WORK}/build/driver)
run(${WORK}/build/autopilot)
run(${WORK}/build/core)
run(${WORK}/build/files ${SOURCE}/data/sample_flight)
run(${WORK}/build/research)
run(${WORK}/build/new_model)
run(${WORK}/build/new_model_test)
run(${WORK}/build/own_front_end)
run(${WORK}/build/own_back_end)
run(${WORK}/build/radar_point_model)
