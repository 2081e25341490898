# SPDX-License-Identifier: MIT
# `cpack -G DEB` in a build folder makes a Debian package of the program, the tools, the configs and the documents. The
# library stays out: it is static, its objects are made for one kind of processor, and its interface may change with
# every version. Who programs against it builds it from the source.
set(FABSEQ_DEBIAN_REVISION 1)
set(FABSEQ_MAINTAINER "The fabseq developers <root@localhost>")
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL}) # Debian's own tools read these two
  set(FABSEQ_MAINTAINER "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(FABSEQ_DOCUMENTS ${CMAKE_INSTALL_DATADIR}/doc/fabseq)

# The pages that users read, with their pictures and links as in the source tree.
install(FILES README.md CITATION.cff DESTINATION ${FABSEQ_DOCUMENTS} COMPONENT debian EXCLUDE_FROM_ALL)
install(DIRECTORY docs DESTINATION ${FABSEQ_DOCUMENTS} COMPONENT debian EXCLUDE_FROM_ALL
        FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN "*.csv"
        PATTERN architecture.md EXCLUDE
        PATTERN example EXCLUDE)
install(DIRECTORY benchmarks/evidence DESTINATION ${FABSEQ_DOCUMENTS}/benchmarks COMPONENT debian EXCLUDE_FROM_ALL
        FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN "*.csv"
        PATTERN figures EXCLUDE
        PATTERN scaling EXCLUDE
        PATTERN studies EXCLUDE
        PATTERN tests EXCLUDE)
fabseq_install_link(${FABSEQ_DATA}/configs ${FABSEQ_DOCUMENTS}/examples COMPONENT debian EXCLUDE_FROM_ALL)
install(FILES src/package/debian/copyright DESTINATION ${FABSEQ_DOCUMENTS} COMPONENT debian EXCLUDE_FROM_ALL)
install(FILES src/package/debian/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME fabseq
        COMPONENT debian EXCLUDE_FROM_ALL)
configure_file(src/package/debian/changelog.in package/changelog.in @ONLY)
configure_file(src/package/debian/compressed.cmake.in package/compressed.cmake @ONLY)
install(SCRIPT ${PROJECT_BINARY_DIR}/package/compressed.cmake COMPONENT debian EXCLUDE_FROM_ALL)

set(CPACK_PACKAGE_NAME fabseq)
set(CPACK_PACKAGE_CONTACT ${FABSEQ_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "fabrication sequences for parts built by arc welding")
set(CPACK_PACKAGE_DESCRIPTION
    "fabseq finds the order in which a metal part should be built by wire-arc
additive manufacturing so that it distorts as little as possible. It divides
the part into layers, simulates the shrinkage of every layer, and optimizes
the layers with gradients from adjoint solves.
.
The package has the program, which runs on one core or on many, tools that
draw and measure its results, configs to start from, and the documents.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};fabseq;program;/;${PROJECT_BINARY_DIR};fabseq;debian;/")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${FABSEQ_DEBIAN_REVISION})
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
# Libraries as dpkg-shlibdeps finds them. A program that is started without mpirun needs it, too: its daemon.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS
    "openmpi-bin, python3, python3-numpy, python3-scipy, python3-h5py, python3-matplotlib, python3-pil")
# With the BLAS of reference PETSc is several times slower. Some tools need VTK, which ParaView brings, and a screen.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libopenblas0-serial, python3-paraview | python3-vtk9, xvfb")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/src/package/debian/prerm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
