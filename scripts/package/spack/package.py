# SPDX-License-Identifier: MIT
"""Spack's recipe of fabseq. Its syntax and style were checked; nobody has built with it yet.

A repository of recipes (`spack repo create`, `spack repo add`) holds this file as packages/fabseq/package.py,
and lib3mf/package.py as packages/lib3mf/package.py. Spack looks for the source in the folder in which it is
started:

    git archive --prefix=fabseq-0.1.0/ -o fabseq-0.1.0.tar.gz HEAD
    spack install --no-checksum fabseq
"""

import os

from spack.package import *


class Fabseq(CMakePackage):
    """Fabrication sequences for parts built by arc welding, optimized for little distortion."""

    manual_download = True
    url = f"file://{os.getcwd()}/fabseq-0.1.0.tar.gz"

    license("MIT")

    version("0.1.0")  # the archive is your own, so there is no checksum

    variant("tools", default=True, description="Python packages of fabseq-tools")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")

    # The program and its scripts rely on Open MPI's names, options and signals.
    depends_on("openmpi@4.1", type=("build", "link", "run"))
    depends_on("petsc@3.18: +mpi+mumps~complex+double")
    depends_on("hdf5@1.10: +mpi+hl")
    depends_on("openblas threads=none +pic")
    depends_on("nlohmann-json@3.11:")
    depends_on("lib3mf@1.8")
    depends_on("libzip@1.7:")
    depends_on("expat@2.4:")
    depends_on("hwloc@2.5:")

    with when("+tools"):
        depends_on("python@3.11:", type="run")
        depends_on("py-numpy", type="run")
        depends_on("py-scipy", type="run")
        depends_on("py-h5py", type="run")
        depends_on("py-matplotlib", type="run")
        depends_on("py-pillow", type="run")
        depends_on("vtk@9: +python", type="run")

    generator("ninja")

    conflicts("%gcc@:11", msg="fabseq is written in C++20")

    def cmake_args(self):
        # Spack's compiler wrapper names the processor itself.
        return [
            self.define("FABSEQ_NATIVE", False),
            self.define("FABSEQ_TESTS", False),
            self.define("FABSEQ_UNITY", True),
            self.define("FABSEQ_WARNINGS_AS_ERRORS", False),
            self.define("FABSEQ_64_BIT_INDICES", False),
            self.define("FABSEQ_HDF5_PACKAGE", "hdf5"),
            self.define("FABSEQ_LAPACK_PACKAGES", "openblas"),
        ]

    def setup_run_environment(self, env):
        env.set("FABSEQ_PROGRAM", join_path(self.prefix.bin, "fabseq"))
        env.set("FABSEQ_CONFIGS", join_path(self.prefix.share, "fabseq", "configs"))
        # One thread a rank: the ranks are the parallelism.
        env.set("OPENBLAS_NUM_THREADS", "1")
        env.set("OMP_NUM_THREADS", "1")

    @run_after("install")
    def name_python(self):
        if self.spec.satisfies("+tools"):
            tools = join_path(self.prefix.share, "fabseq", "scripts", "fabseq-tools")
            filter_file("^#!.*python3$", f"#!{self.spec['python'].command.path}", tools)

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def check_version(self):
        program = Executable(join_path(self.prefix.bin, "fabseq"))
        assert str(self.version) in program("-version", output=str)
