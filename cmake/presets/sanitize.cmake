# The tests with AddressSanitizer and UBSan; lines alone (-g1), which saves a third of the time to compile.
include(${CMAKE_CURRENT_LIST_DIR}/test.cmake)
set(CMAKE_CXX_FLAGS "-O1 -g1 -fsanitize=address,undefined -fno-sanitize-recover=all" CACHE STRING "" FORCE)
