# SPDX-License-Identifier: MIT
# What `cmake --install` leaves: the program, its manual page, the configs, and the library as a CMake package.
install(TARGETS fabseq RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES docs/fabseq.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(DIRECTORY configs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fabseq/configs)
if(FABSEQ_SANITIZE)
  return() # whoever links the library would have to be instrumented, too
endif()

add_library(fabseq::core ALIAS fabseq_core)
set_target_properties(fabseq_core PROPERTIES EXPORT_NAME core)
set_target_properties(fabseq_usage PROPERTIES EXPORT_NAME usage)
set_target_properties(fabseq_registered PROPERTIES EXPORT_NAME registered)
set(FABSEQ_PACKAGE_DIRECTORY ${CMAKE_INSTALL_LIBDIR}/cmake/fabseq)
install(DIRECTORY include/fabseq DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS fabseq_core fabseq_registered fabseq_usage EXPORT fabseq
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/fabseq)
install(EXPORT fabseq NAMESPACE fabseq:: FILE fabseqTargets.cmake DESTINATION ${FABSEQ_PACKAGE_DIRECTORY})

include(src/package/register_bytes.cmake)
get_target_property(FABSEQ_ARCHITECTURE fabseq_usage INTERFACE_COMPILE_OPTIONS)
if(NOT FABSEQ_ARCHITECTURE)
  set(FABSEQ_ARCHITECTURE "")
endif()
fabseq_register_bytes(FABSEQ_REGISTER_BYTES ${FABSEQ_ARCHITECTURE})
include(CMakePackageConfigHelpers)
configure_package_config_file(src/package/fabseqConfig.cmake.in ${PROJECT_BINARY_DIR}/package/fabseqConfig.cmake
                              INSTALL_DESTINATION ${FABSEQ_PACKAGE_DIRECTORY})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/fabseqConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES src/package/register_bytes.cmake ${PROJECT_BINARY_DIR}/package/fabseqConfig.cmake
              ${PROJECT_BINARY_DIR}/package/fabseqConfigVersion.cmake
        DESTINATION ${FABSEQ_PACKAGE_DIRECTORY})
