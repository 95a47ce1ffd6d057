# An unoptimised estimator is a hundred times slower: Eigen lives by inlining.
get_property(RIO_MULTI_CONFIG GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT RIO_MULTI_CONFIG AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CXX_FLAGS MATCHES "-O[1-3sf]")
  if(RIO_TOP_LEVEL)
    message(STATUS "rio: CMAKE_BUILD_TYPE is not set, Release is taken")
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
  else()
    message(WARNING "rio: CMAKE_BUILD_TYPE is not set. Without optimisation rio is about a hundred "
                    "times slower, a 40 s recording takes 40 s. Set CMAKE_BUILD_TYPE to Release.")
  endif()
endif()
