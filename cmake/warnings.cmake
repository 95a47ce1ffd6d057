# Warnings are a private matter of our own targets; they never reach consumers.
function(rio_enable_warnings target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    $<$<BOOL:${RIO_WARNINGS_AS_ERRORS}>:-Werror>)
endfunction()
