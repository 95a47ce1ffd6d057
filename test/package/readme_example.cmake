# Every piece of C++ in the README is a marked part of a file that is compiled, word for word.
file(READ ${SOURCE}/README.md readme)
set(parts 0)

# The part of the file between two lines of the marker.
function(expect_in_readme file marker)
  file(READ ${SOURCE}/${file} text)
  string(REGEX MATCH "// \\[${marker}\\](\n.*)  // \\[${marker}\\]" matched "${text}")
  string(REPLACE "\n  " "\n" expected "${CMAKE_MATCH_1}")
  string(FIND "${readme}" "```cpp${expected}```" found)
  if(expected STREQUAL "" OR found EQUAL -1)
    message(FATAL_ERROR "README.md and ${file} differ. Expected in README.md:\n${expected}")
  endif()
  math(EXPR parts "${parts} + 1")
  set(parts ${parts} PARENT_SCOPE)
endfunction()

expect_in_readme(src/examples/01_link.cpp "README")
foreach(part aids radars ti mavlink)
  expect_in_readme(test/package/readme_snippets.cpp "README ${part}")
endforeach()

string(REGEX MATCHALL "```cpp\n" pieces "${readme}")
list(LENGTH pieces pieces)
if(NOT pieces EQUAL parts)
  message(FATAL_ERROR "README.md has ${pieces} pieces of C++, of which ${parts} are compiled")
endif()
