# g++ frees what it no longer needs each time its heap has grown by a share, first at 128 MB. Beginning at 500 MB and
# a share of 30 % saves time in files full of Eigen and stays at 1.1 GB. clang-tidy, which reads
# compile_commands.json, refuses the options.
if(RIO_TOP_LEVEL AND CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT CMAKE_EXPORT_COMPILE_COMMANDS)
  add_compile_options(--param=ggc-min-heapsize=500000 --param=ggc-min-expand=30)  # [kB], [%]
endif()
