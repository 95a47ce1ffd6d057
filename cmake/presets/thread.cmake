# The test of two threads with ThreadSanitizer.
include(${CMAKE_CURRENT_LIST_DIR}/test.cmake)
set(CMAKE_CXX_FLAGS "-O1 -g1 -fsanitize=thread" CACHE STRING "" FORCE)
