# What every target of the project has in common.

# Warnings are a private matter of our own targets; they never reach consumers.
function(rio_enable_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    $<$<BOOL:${RIO_WARNINGS_AS_ERRORS}>:-Werror>)
endfunction()

# A part of the library: C++20, hidden symbols, fit for a shared library; Eigen is parsed once.
function(rio_library_target target)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(${target} PROPERTIES
    CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_precompile_headers(${target} PRIVATE
    <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <optional> <vector>)
  rio_enable_warnings(${target})
endfunction()
