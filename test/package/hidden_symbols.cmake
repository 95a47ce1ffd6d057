# The shared library shows the symbols of the odometry API and of the rotations that models of other
# sensors need, and no others of the project.
execute_process(COMMAND ${NM} -D -C --defined-only ${LIBRARY} OUTPUT_VARIABLE symbols RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${NM} failed on ${LIBRARY}")
endif()
string(REGEX MATCHALL "rio::[^\n]*" shown "${symbols}")
list(FILTER shown EXCLUDE REGEX
  "^rio::(Odometry::|Options::validate|preset\\(|to_string\\((rio::)?(Status|Model|HealthState|HealthReason)\\))")
list(FILTER shown EXCLUDE REGEX
  "^rio::(GammaSeries::|RigidPose::|PoseBlock::|gamma\\(|d_gamma_a_d_phi|quaternion_|rotation_between|attitude_variance)")
if(NOT symbols MATCHES "rio::Odometry::add_imu" OR NOT symbols MATCHES "rio::to_string")
  message(FATAL_ERROR "the odometry API is missing in:\n${symbols}")
endif()
if(shown)
  message(FATAL_ERROR "symbols that should be hidden:\n${shown}")
endif()
