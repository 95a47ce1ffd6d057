# The fuzz targets, with AddressSanitizer and UBSan.
set(CMAKE_BUILD_TYPE None CACHE STRING "" FORCE)
set(CMAKE_CXX_COMPILER clang++-14 CACHE STRING "" FORCE)
string(JOIN " " flags -O2 -g1 -fsanitize=address,undefined -fno-sanitize-recover=all
  -fsanitize-coverage=inline-8bit-counters,pc-table -ffp-exception-behavior=maytrap)
set(CMAKE_CXX_FLAGS "${flags}" CACHE STRING "" FORCE)
set(RIO_BUILD_FUZZERS ON CACHE BOOL "" FORCE)
foreach(part RIO_BUILD_TOOLS RIO_BUILD_LAB RIO_BUILD_TESTS RIO_BUILD_EXAMPLES RIO_INSTALL)
  set(${part} OFF CACHE BOOL "" FORCE)
endforeach()
