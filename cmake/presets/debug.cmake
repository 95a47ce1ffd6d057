# Everything, for a debugger.
set(CMAKE_BUILD_TYPE Debug CACHE STRING "" FORCE)
set(RIO_UNITY_BUILD OFF CACHE BOOL "" FORCE)
