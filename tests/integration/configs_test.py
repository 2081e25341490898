# SPDX-License-Identifier: MIT
"""Every config of configs/ and configs/published/ is one that the program checks and optimizes, and is said
to cost what it does."""

import json
import math
import os
import re

import run_fabseq
from run_fabseq import FabseqTest, ROOT

CONFIGS = os.path.join(ROOT, "configs")
PUBLISHED = os.path.join(CONFIGS, "published")
MOST_ELEMENTS = 3000  # of the box of an iteration
FINER = {"bracket.json": 6000}  # or its hole has no nodes
COARSE_PART = ("-set", "part.voxels.file=" + os.path.join(CONFIGS, "parts", "demo_part_20x20x30.h5"))


def reduced(path):
    """Options for a grid that is coarser by the smallest factor that divides it and makes it small enough."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if '"voxels"' in text:
        return ("-elements", "20,20,30", *COARSE_PART)
    elements = json.loads(re.search(r'"elements": *(\[[^]]*\])', text).group(1))
    divisors = [d for d in range(1, min(elements) + 1) if math.gcd(d, *elements) == d]
    most = FINER.get(os.path.basename(path), MOST_ELEMENTS)
    factor = next(d for d in divisors if math.prod(elements) <= most * d**len(elements))
    return ("-elements", ",".join(str(count // factor) for count in elements))


@run_fabseq.only_release
class ConfigsTest(FabseqTest):
    def for_each_config(self, test, but=()):
        folders = (CONFIGS, PUBLISHED)
        paths = sorted(os.path.join(folder, name) for folder in folders for name in os.listdir(folder)
                       if name.endswith(".json") and not name.endswith("cases.json"))
        self.assertIn(os.path.join(CONFIGS, "demo.json"), paths)
        self.assertIn(os.path.join(PUBLISHED, "two_faces.json"), paths)
        for path in paths:
            if path not in but:
                with self.subTest(config=os.path.relpath(path, CONFIGS)):
                    test(path)

    def test_checked(self):
        """But for those of cases, each of which reproduce_test checks."""
        def check(path):
            run = self.run_program(1, "-config", path, "-task", "check", output="")
            self.assert_done(run)
            self.assertIn("estimate", run.stdout)

        with open(os.path.join(PUBLISHED, "cases.json"), encoding="utf-8") as file:
            names = [case["config"] for case in json.load(file).values() if "config" in case]
        self.for_each_config(check, {os.path.normpath(os.path.join(PUBLISHED, name)) for name in names})

    def test_one_iteration(self):
        def iterate(path):
            with open(path, encoding="utf-8") as file:
                simulated = re.search(r'"sequence": *\{ *"type": *"planar"', file.read())  # has nothing to vary
            # The elbow has voxels of one grid only, on which an iteration takes too long.
            simulated = simulated or path.endswith("flanged_elbow.json")
            # The nodes on the wall's middle line exist on its own grid only.
            task = ("-task", "simulate", "-layers", 3) if simulated else ("-max_iterations", 1, *reduced(path))
            run = self.run_program(2, "-config", path, "-output_every", 0, *task)
            self.assert_done(run)
            self.assertTrue(os.path.exists(run.path("result.h5")))
            if not simulated:
                self.assertEqual(len(run.history()), 1)
                self.assertTrue(all(value > 0 for value in run.history()[0]["objective"]), str(run))

        self.for_each_config(iterate)

    def test_memory_is_estimated_to_a_factor_of_two(self):
        path = os.path.join(CONFIGS, "v_shape_coarse.json")
        for ranks in (1, 2):
            check = self.run_program(ranks, "-config", path, "-task", "check", output="")
            estimate = 1e9 * float(re.search(r"memory ([0-9.]+) GB", check.stdout).group(1))
            run = self.run_program(ranks, "-config", path, "-max_iterations", 1)
            self.assert_done(run)
            peak = run.json("summary.json")["peak_memory_bytes"]
            print(f"{ranks} ranks: estimate {estimate / 1e6:.0f} MB, peak {peak / 1e6:.0f} MB")
            self.assertLess(abs(estimate / peak - 1.25), 0.75, f"{ranks} ranks")


if __name__ == "__main__":
    run_fabseq.main()
