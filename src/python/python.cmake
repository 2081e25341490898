# SPDX-License-Identifier: MIT
# The Python module: build/PRESET/python/fabseq.*.so, a component of its own of `cmake --install`. Where it is not built, its
# target does nothing.
if(NOT FABSEQ_PYTHON)
  add_custom_target(fabseq_python)
  return()
endif()
if(NOT pybind11_FOUND)
  message(FATAL_ERROR "FABSEQ_PYTHON: found ON without pybind11 2.9 or Python's headers; allowed: OFF, or with both")
endif()

pybind11_add_module(fabseq_python MODULE NO_EXTRAS src/python/module.cc)
target_link_libraries(fabseq_python PRIVATE fabseq_core)
set(exports ${PROJECT_SOURCE_DIR}/src/python/exports.map)
target_link_options(fabseq_python PRIVATE LINKER:--version-script=${exports})
set_target_properties(fabseq_python PROPERTIES OUTPUT_NAME fabseq LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python
                                               LINK_DEPENDS ${exports})
# OPTIONAL: who builds the target fabseq alone can install all the same.
install(TARGETS fabseq_python LIBRARY
        DESTINATION lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages COMPONENT python OPTIONAL)
