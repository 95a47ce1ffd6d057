# Before cpack packs: manual pages as Debian has them.
file(GLOB_RECURSE manuals ${CPACK_TEMPORARY_DIRECTORY}/*/man1/*.1)
foreach(manual ${manuals})
  execute_process(COMMAND gzip -9nf ${manual})
endforeach()
