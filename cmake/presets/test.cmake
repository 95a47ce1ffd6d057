# The tests as test/run.sh builds them: asserts on, warnings are errors.
set(CMAKE_BUILD_TYPE None CACHE STRING "" FORCE)
set(CMAKE_CXX_FLAGS "-O2" CACHE STRING "" FORCE)
set(RIO_WARNINGS_AS_ERRORS ON CACHE BOOL "" FORCE)
