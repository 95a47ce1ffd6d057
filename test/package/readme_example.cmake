# The README's link example is the marked part of src/examples/01_link.cpp, word for word.
file(READ ${SOURCE}/src/examples/01_link.cpp example)
string(REGEX MATCH "// \\[README\\](\n.*)  // \\[README\\]" matched "${example}")
string(REPLACE "\n  " "\n" expected "${CMAKE_MATCH_1}")
file(READ ${SOURCE}/README.md readme)
string(FIND "${readme}" "```cpp${expected}```" found)
if(expected STREQUAL "" OR found EQUAL -1)
  message(FATAL_ERROR "README.md and src/examples/01_link.cpp differ. Expected in README.md:\n${expected}")
endif()
