# ccache, where it is installed, unless another launcher is chosen.
if(RIO_TOP_LEVEL AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(RIO_CCACHE ccache)
  mark_as_advanced(RIO_CCACHE)
  if(RIO_CCACHE)
    # the precompiled headers are those of the build folder: their time stamps say nothing
    set(CMAKE_CXX_COMPILER_LAUNCHER
        ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${RIO_CCACHE})
  endif()
endif()
