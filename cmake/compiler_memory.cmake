# g++ collects garbage from 128 MB on, a tenth of the time of a file full of Eigen. Where two gigabytes
# a core are there, it is told to wait. clang-tidy, which reads compile_commands.json, refuses the option.
if(RIO_TOP_LEVEL AND CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT CMAKE_EXPORT_COMPILE_COMMANDS)
  cmake_host_system_information(RESULT memory QUERY TOTAL_PHYSICAL_MEMORY)  # [MiB]
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  math(EXPR memory_per_core "${memory} / ${cores}")
  if(memory_per_core GREATER_EQUAL 2000)
    add_compile_options(--param=ggc-min-heapsize=1500000)  # [kB]
  endif()
endif()
