# SPDX-License-Identifier: MIT
"""Spack's recipe of lib3mf, which Spack does not have; fabseq needs its version 1. Its syntax and style were
checked; nobody has built with it yet."""

from spack.package import *


class Lib3mf(CMakePackage):
    """Reads and writes 3MF, a file format of additive manufacturing."""

    homepage = "https://3mf.io"
    git = "https://github.com/3MFConsortium/lib3mf.git"

    license("BSD-2-Clause")

    version("1.8.1", tag="v1.8.1")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.0:", type="build")
    depends_on("uuid")

    def cmake_args(self):
        return [self.define("LIB3MF_TESTS", False)]
