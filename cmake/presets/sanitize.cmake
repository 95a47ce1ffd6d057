# The tests with AddressSanitizer and UBSan.
include(${CMAKE_CURRENT_LIST_DIR}/test.cmake)
set(CMAKE_CXX_FLAGS "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all" CACHE STRING "" FORCE)
