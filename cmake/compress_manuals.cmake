# Before cpack packs: manual pages as Debian has them.
file(GLOB_RECURSE manuals ${CPACK_TEMPORARY_DIRECTORY}/*.1)
list(FILTER manuals INCLUDE REGEX "/man1/")
foreach(manual ${manuals})
  execute_process(COMMAND gzip -9nf ${manual})
endforeach()
