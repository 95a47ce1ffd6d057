# Library and programs, optimised.
set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
set(RIO_BUILD_TESTS OFF CACHE BOOL "" FORCE)
