#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools coarsen."""

import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

PROJECT = Path(__file__).resolve().parents[2]


class CoarsenPart(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.fine, self.coarse = (Path(folder.name) / name for name in ("fine.h5", "coarse.h5"))

    def coarsen(self, *arguments, fine=None):
        return subprocess.run(["/usr/bin/python3", PROJECT / "scripts/fabseq-tools", "coarsen", fine or self.fine, self.coarse,
                               *map(str, arguments)], capture_output=True, text=True, check=False)

    def density(self):
        with h5py.File(self.coarse) as file:
            return file["density"][()]

    def test_the_demo_part_is_made_so(self):
        done = self.coarsen(2, 0.5, fine=PROJECT / "configs/parts/topopt_cantilever_40x40x60.h5")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with h5py.File(PROJECT / "configs/parts/demo_part_20x20x30.h5") as file:
            np.testing.assert_array_equal(self.density(), file["density"][()])

    def test_means_threshold_and_largest_piece(self):
        """Blocks [z][y][x] of 2^3 voxels: one that is filled to 5/8, its neighbour to 3/8, and one far
        away."""
        grey = np.zeros((4, 2, 8))
        grey[:2, :, 2:4].flat[:5] = 1.0
        grey[:2, :, 4:6].flat[:3] = 1.0
        grey[2:, :, 2:4] = 0.5
        grey[2:, :, 6:] = 1.0
        with h5py.File(self.fine, "w") as file:
            file["density_grey"], file["density"] = grey, np.zeros_like(grey)
            file["density"].attrs["spacing"] = [0.5, 0.5, 0.5]
        for threshold, filled, dropped in ((0.5, [(0, 0, 1), (1, 0, 1)], 1), (0.3, [(0, 0, 1), (0, 0, 2), (1, 0, 1)], 1),
                                           (0.51, None, 1)):
            done = self.coarsen(2, threshold)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn(f"{dropped} smaller pieces dropped ({dropped} voxels)", done.stdout)
            density = self.density()
            self.assertEqual((density.shape, density.dtype), ((2, 1, 4), np.uint8))
            if filled:
                self.assertEqual([tuple(voxel) for voxel in np.argwhere(density)], filled)
            else:  # of pieces of one size, either
                self.assertEqual(density.sum(), 1)
        with h5py.File(self.coarse) as file:
            np.testing.assert_array_equal(file["density"].attrs["spacing"], [1.0, 1.0, 1.0])
            self.assertIn("threshold 0.51", file.attrs["origin"])

    def test_mistakes(self):
        with h5py.File(self.fine, "w") as file:
            file["density"] = np.full((4, 4, 4), 0.2)
        for arguments, message in (((3, 0.5), "the factor 3 does not divide the shape (4, 4, 4)"),
                                   ((2, 0.5), "no block reaches the threshold 0.5"),
                                   ((0, 0.5), "factor: found 0; allowed: an integer >= 1"),
                                   ((2, 1.5), "threshold: found 1.5; allowed: above 0, up to 1"),
                                   ((2, 0.5, "--dataset", "rho"), "dataset 'rho'")):
            done = self.coarsen(*arguments)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(message, done.stderr)
            self.assertFalse(self.coarse.exists())
        done = self.coarsen(2, 0.5, fine=self.fine.with_name("none.h5"))
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))


if __name__ == "__main__":
    unittest.main(verbosity=2)
