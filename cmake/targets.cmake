# What every target of the project has in common.

# Warnings are a private matter of our own targets; they never reach consumers.
function(rio_enable_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    $<$<BOOL:${RIO_WARNINGS_AS_ERRORS}>:-Werror>)
endfunction()

# Of a target that prints, asks, draws or tests: optimised little, which compiles in three quarters of
# the time. The estimator, the simulator and the readers are not such. Without a build type the flags
# are the user's; the presets of the tests have none, to keep the asserts.
function(rio_optimise_little target)
  target_compile_options(${target} PRIVATE $<$<OR:$<CONFIG:Release>,$<CONFIG:None>>:-O1>)
endfunction()

# The sources of a target in groups that are compiled in one go, so that what they share is parsed and
# instantiated once; from scratch that halves the time.
#   rio_sources(TARGET GROUP file...)
function(rio_sources target group)
  target_sources(${target} PRIVATE ${ARGN})
  set_source_files_properties(${ARGN} PROPERTIES UNITY_GROUP ${group})
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${RIO_UNITY_BUILD} UNITY_BUILD_MODE GROUP)
endfunction()

# A part of the library: C++20, hidden symbols, fit for a shared library.
function(rio_library_target target)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(${target} PROPERTIES
    CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_options(${target} PRIVATE -fno-fast-math)  # NaN and infinity have meanings
  if(RIO_NATIVE)  # public: Eigen aligns its types by it
    target_compile_options(${target} PUBLIC -march=native)
  else()  # the same bits on every processor, also where multiply-add is one instruction
    target_compile_options(${target} PRIVATE -ffp-contract=off)
  endif()
  rio_enable_warnings(${target})
endfunction()

# A part of the programs.
function(rio_part_of_programs target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_compile_features(${target} PUBLIC cxx_std_20)
  rio_enable_warnings(${target})
  rio_optimise_little(${target})
endfunction()

# A program that is installed, with the component `tools` if none is given.
function(rio_program target name)
  find_package(CLI11 REQUIRED)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name})
  target_link_libraries(${target} PRIVATE CLI11::CLI11 rio_version rio_io rio::core rio::rio rio::sim)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  rio_enable_warnings(${target})
  rio_optimise_little(${target})
  if(NOT ARGN)
    set(ARGN tools)
  endif()
  install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${ARGN})
endfunction()
