# Flags that all of volmark's own targets share.
function(volmark_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
  # GCC 12 warns about designated initialisers that leave members to their defaults.
  target_compile_options(${target} PRIVATE -Wno-missing-field-initializers)
  if(VOLMARK_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(VOLMARK_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                            -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
  if(VOLMARK_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()
