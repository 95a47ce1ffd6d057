# libFuzzer is a part of clang.
if(RIO_BUILD_FUZZERS AND NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "rio: RIO_BUILD_FUZZERS needs clang, this is ${CMAKE_CXX_COMPILER_ID}: "
                      "cmake -C cmake/presets/fuzz.cmake, or -DCMAKE_CXX_COMPILER=clang++-14")
endif()
