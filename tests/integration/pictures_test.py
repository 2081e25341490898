# SPDX-License-Identifier: MIT
"""fabseq-tools overview on results of the program, and the made-up results of tests/scripts held against
them."""

import json
import os
import subprocess

import h5py
import numpy as np

import fake_results
import run_fabseq
from pictures import filled
from run_fabseq import FabseqTest, ROOT
from small_parts import hook_3d, plate_2d


def kind(value):
    """Of a JSON value: names of members and kinds of entries; numbers are one kind, and null is any."""
    if isinstance(value, dict):
        return {name: kind(entry) for name, entry in value.items()}
    if isinstance(value, list):
        return [kind(value[0])] if value else []
    return "number" if isinstance(value, (int, float)) and not isinstance(value, bool) else type(value).__name__


def strangers(made_up, real, place=""):
    """Where `made_up` has a member, or a kind of entry, that `real` has not."""
    if "NoneType" in (made_up, real):
        return []
    if isinstance(made_up, dict) and isinstance(real, dict):
        found = [f"{place}/{name}" for name in made_up if name not in real]
        for name in made_up.keys() & real.keys():
            found += strangers(made_up[name], real[name], f"{place}/{name}")
        return found
    if isinstance(made_up, list) and isinstance(real, list) and made_up and real:
        return strangers(made_up[0], real[0], place + "/0")
    return [] if type(made_up) is type(real) and (isinstance(made_up, list) or made_up == real) else [place]


@run_fabseq.only_release
class PicturesTest(FabseqTest):
    def optimized(self, config):
        run = self.run_config(2, config, "-max_iterations", 3)
        self.assert_done(run)
        return run

    def test_overview(self):
        for config in (plate_2d(), hook_3d()):
            run = self.optimized(config)
            done = subprocess.run([os.path.join(ROOT, "scripts", "fabseq-tools"), "overview", run.output, "--table"],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater(min(filled(run.path("overview.png"), 0.25, 0.55, 2)), 0.1)
            self.assertGreater(min(filled(run.path("overview.png"), 0.75, 0.9, 4)), 0.01)
            rows = {line[:22].strip(): line[22:].split() for line in done.stdout.splitlines()}
            values = [run.json("summary.json")[block]["responses"][0]["value"]
                      for block in ("baseline", "start", "optimized", "binary")]
            self.assertEqual(rows["distortion"], [f"{value:.3e}" for value in values])
            self.assertIn("3 iterations", done.stdout)

    def test_made_up_results_have_the_form_of_real_ones(self):
        """They may lack what the scripts do not read, but have nothing that a run does not leave."""
        for config, density in ((plate_2d(), np.ones((12, 20))), (hook_3d(), np.ones((8, 4, 8)))):
            config["objective"] = [{"type": "distortion", "nodes": "top"}, {"type": "layer_uniformity"}]
            config["constraints"] = config["constraints"][:1]
            config["domain"]["unit"] = "mm"
            config["material"] = {**config.get("material", {}), "yield_stress": 1.0, "mass_density": 1.0}
            config["process"] = {**config.get("process", {}), "deposition_rate": 1.0}
            config["baseline"] = {**config.get("baseline", {}), "layers": 2}
            run = self.optimized(config)
            fake = os.path.join(self.directory, "made_up_" + config["name"])
            fake_results.write_run(fake, config["name"], density, config["domain"]["size"], count=4, planar_count=4)
            fake_results.add_checks(fake)
            for name in ("summary.json", "config.json", "history.jsonl"):
                with open(os.path.join(fake, name), encoding="utf-8") as file:
                    made_up = json.loads(file.readline() if name.endswith("l") else file.read())
                real = run.history()[0] if name.endswith("l") else run.json(name)
                if name == "config.json":  # whose node sets are named by the user
                    made_up["node_sets"], real["node_sets"] = (list(sets.values())
                                                               for sets in (made_up["node_sets"], real["node_sets"]))
                self.assertEqual(strangers(kind(made_up), kind(real)), [], name)
            with h5py.File(os.path.join(fake, "result.h5")) as made_up, h5py.File(run.path("result.h5")) as real:
                datasets = []
                made_up.visititems(lambda name, item: datasets.append(name) if isinstance(item, h5py.Dataset) else None)
                for name in datasets:
                    if name.startswith("model/node_sets/"):  # of any name and size
                        self.assertEqual(made_up[name].dtype, real["model/node_sets/top"].dtype)
                        continue
                    self.assertEqual((made_up[name].shape, made_up[name].dtype), (real[name].shape, real[name].dtype), name)


if __name__ == "__main__":
    run_fabseq.main()
