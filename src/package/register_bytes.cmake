# SPDX-License-Identifier: MIT
# fabseq_register_bytes(RESULT OPTION...): bytes of the vector registers that include/fabseq/lanes/lanes.h finds when it is
# compiled with CMAKE_CXX_FLAGS and these options.
function(fabseq_register_bytes result)
  separate_arguments(flags NATIVE_COMMAND "${CMAKE_CXX_FLAGS}")
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flags} ${ARGN} -dM -E -x c++ /dev/null
                  OUTPUT_VARIABLE macros COMMAND_ERROR_IS_FATAL ANY)
  set(bytes 16)
  if(macros MATCHES "__AVX512F__")
    set(bytes 64)
  elseif(macros MATCHES "__AVX__")
    set(bytes 32)
  endif()
  set(${result} ${bytes} PARENT_SCOPE)
endfunction()
