# SPDX-License-Identifier: MIT
# What `cmake --install` leaves: the program, its manual page, the configs, the tools, and the library as a CMake package.
# Debian's package takes the component `program` only (debian.cmake).
install(TARGETS fabseq RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES docs/fabseq.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT manual)
install(DIRECTORY configs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fabseq/configs COMPONENT program)

# The tools and what starts runs lie as in the source tree. Their entry is a link among the programs, and they find the
# program by a link of theirs.
set(FABSEQ_DATA ${CMAKE_INSTALL_DATADIR}/fabseq)
install(DIRECTORY scripts/fabseq_tools DESTINATION ${FABSEQ_DATA}/scripts COMPONENT program
        PATTERN __pycache__ EXCLUDE
        PATTERN node_modules EXCLUDE
        PATTERN src EXCLUDE
        PATTERN build.sh EXCLUDE
        PATTERN "package*.json" EXCLUDE
        PATTERN .npmrc EXCLUDE)
install(PROGRAMS scripts/fabseq-tools DESTINATION ${FABSEQ_DATA}/scripts COMPONENT program)
install(FILES scripts/environment.sh scripts/launch.sh DESTINATION ${FABSEQ_DATA}/scripts COMPONENT program)
install(DIRECTORY scripts/use scripts/slurm DESTINATION ${FABSEQ_DATA}/scripts USE_SOURCE_PERMISSIONS COMPONENT program
        PATTERN __pycache__ EXCLUDE)
function(fabseq_install_link target link) # and what install() may add
  cmake_path(ABSOLUTE_PATH target BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} NORMALIZE)
  cmake_path(ABSOLUTE_PATH link BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX} NORMALIZE OUTPUT_VARIABLE at)
  cmake_path(GET at PARENT_PATH folder)
  cmake_path(GET at FILENAME name)
  cmake_path(RELATIVE_PATH target BASE_DIRECTORY ${folder})
  cmake_path(GET link PARENT_PATH folder)
  set(made ${PROJECT_BINARY_DIR}/package/links/${link})
  cmake_path(GET made PARENT_PATH made_in)
  file(MAKE_DIRECTORY ${made_in})
  file(CREATE_LINK ${target} ${made} SYMBOLIC)
  install(FILES ${made} DESTINATION ${folder} ${ARGN})
endfunction()
fabseq_install_link(${FABSEQ_DATA}/scripts/fabseq-tools ${CMAKE_INSTALL_BINDIR}/fabseq-tools
                    COMPONENT program)
fabseq_install_link(${CMAKE_INSTALL_BINDIR}/fabseq ${FABSEQ_DATA}/fabseq COMPONENT program)
if(FABSEQ_SANITIZE)
  return() # whoever links the library would have to be instrumented, too
endif()

add_library(fabseq::core ALIAS fabseq_core)
set_target_properties(fabseq_core PROPERTIES EXPORT_NAME core)
set_target_properties(fabseq_usage PROPERTIES EXPORT_NAME usage)
set_target_properties(fabseq_registered PROPERTIES EXPORT_NAME registered)
set(FABSEQ_PACKAGE_DIRECTORY ${CMAKE_INSTALL_LIBDIR}/cmake/fabseq)
install(DIRECTORY include/fabseq DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(TARGETS fabseq_core fabseq_registered fabseq_usage EXPORT fabseq
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/fabseq COMPONENT development)
install(EXPORT fabseq NAMESPACE fabseq:: FILE fabseqTargets.cmake DESTINATION ${FABSEQ_PACKAGE_DIRECTORY}
        COMPONENT development)

include(CMakePackageConfigHelpers)
configure_package_config_file(src/package/fabseqConfig.cmake.in ${PROJECT_BINARY_DIR}/package/fabseqConfig.cmake
                              INSTALL_DESTINATION ${FABSEQ_PACKAGE_DIRECTORY})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/fabseqConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/fabseqConfig.cmake
              ${PROJECT_BINARY_DIR}/package/fabseqConfigVersion.cmake
        DESTINATION ${FABSEQ_PACKAGE_DIRECTORY} COMPONENT development)
