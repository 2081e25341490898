# SPDX-License-Identifier: MIT
"""Configs and options that are wrong by themselves: status 2 on every rank, one line with the key, what was
found and what is allowed, nothing written."""

from unittest import mock

import run_fabseq
from bad_input_case import BadInputTest
from run_fabseq import BAD_INPUT
from small_parts import hook_3d, plate_2d


class ConfigErrorsTest(BadInputTest):
    def test_unknown_key_names_the_nearest(self):
        config = plate_2d()
        config["projection"] = {"bta": 3}
        self.assert_refused(config, words=["/projection/bta", "unknown key", '"beta"'])

    def test_unknown_path_of_set(self):
        self.assert_refused(plate_2d(), "-set", "layers.cuont=3", words=["/layers/cuont", '"count"'])
        self.assert_refused(plate_2d(), "-set", "objective.7.weight=3", words=["/objective/7", "0 to 1"])
        self.assert_refused(plate_2d(), "-set", "layers", words=["-set", "layers", "path.to.key=VALUE"])

    def test_wrong_type(self):
        self.assert_refused(plate_2d(), "-layers", "many", words=["/layers/count", '"many"', "integer in [1, 10000]"])
        self.assert_refused(plate_2d(), "-set", "domain.size=[2,1,2]", words=["/domain", "[2,1,2]", "2 numbers"])

    def test_out_of_range(self):
        self.assert_refused(plate_2d(), "-poisson", "0.5", words=["/material/poisson", "found 0.5", "(-1, 0.5)"])
        self.assert_refused(plate_2d(), "-layers", "0", words=["/layers/count", "found 0", "[1, 10000]"])

    def test_nodes_that_make_no_plane(self):
        """As objective and as constraint, before anything is written."""
        config = plate_2d()
        config["node_sets"]["point"] = {"box": {"min": [0, 0], "max": [0, 0]}}
        term = {"type": "distortion", "measure": "angle", "nodes": "point", "to": "top"}
        words = ["/node_sets/point", "1 nodes determine no line for measure angle; allowed: nodes of an edge"]
        for key, terms in (("objective", [term]), ("constraints", [{**term, "limit": 1.0}])):
            for task in ("optimize", "simulate", "evaluate"):
                self.assert_refused({**config, key: terms}, "-task", task, words=words)
        config["node_sets"]["corner"] = {"polygon": {"points": [[0, 0], [0.5, 0], [0.5, 0.5], [0, 0.5]]}}
        words = ["/node_sets/corner", "nodes determine no line for measure angle"]
        self.assert_refused({**config, "objective": [{**term, "nodes": "corner"}]}, "-task", "simulate", words=words)

    def test_sharpness(self):
        for value in ("-1", "0", "inf", "nan", "1e999", "1e300", "1e-300"):
            for key in ("beta", "max"):
                self.assert_refused(plate_2d(), "-set", f"projection.{key}={value}",
                                    words=[f"/projection/{key}: found "])

    @run_fabseq.only_release  # sanitizers take address space by the terabyte
    def test_address_space(self):
        """Limits with which libraries would end, or wait for ever; the last leaves the part too little."""
        launcher = run_fabseq.launcher

        def limited(kilobytes):
            return mock.patch.object(run_fabseq, "launcher", lambda ranks: [
                *launcher(ranks), "bash", "-c", f'ulimit -v {kilobytes} && exec "$0" "$@"'])
        with limited(300000):
            self.assert_refused(plate_2d(), words=[
                "the limit of the address space: found 0.307 GB (ulimit -v); allowed: "])
        config = hook_3d()
        config["domain"]["elements"] = [6 * n for n in config["domain"]["elements"]]
        with limited(700000):
            self.assert_refused(config, "-layers", 400, words=[
                "/layers/count: ", "; the limit of the address space is "])

    def test_absurd_sizes(self):
        """Numbers that size memory: refused before anything of that size is asked for."""
        for arguments, words in (
                (("-layers", "2147483647"), ["/layers/count", "found 2147483647", "[1, 10000]"]),
                (("-baseline_layers", "2e9"), ["/baseline/layers", "[1, 10000]"]),
                (("-layers", "auto", "-target", "1e-9"), ["/constraints/0/target", "found 1e-09", "10000 layers"]),
                (("-target", "1e-300"), ["/constraints/0/target", "found 1e-300", "10000 layers"]),
                (("-elements", "2147483647,1"), ["/domain/elements", "[2147483647,1]"]),
                (("-elements", "1e5,1e5"), ["/domain/elements", "[100000,100000]"]),
                (("-set", "node_sets.top.samples=2147483647"), ["/node_sets/top/samples", "2147483647", "21"]),
                (("-set", "objective.2147483647.weight=1"), ["/objective/2147483647", "0 to 1"])):
            self.assert_refused(plate_2d(), *arguments, words=words, timeout=60)

    def test_layers_that_could_only_be_empty(self):
        config = plate_2d()
        config["domain"]["elements"] = [4, 3]
        config["part"] = {"box": {"min": [0, 0], "max": [2, 1.2]}}
        self.assert_refused(config, "-layers", 121, words=["/layers/count: found 121; allowed: at most 120 layers"])

    def test_a_key_of_another_section(self):
        config = plate_2d()
        config["part"] = {"box": {"min": [0, 0], "max": [2, 1.2], "keep": "connected"}}
        self.assert_refused(config, words=["/part/box/keep: unknown key; it is a key of part;"])

    def test_missing_key(self):
        config = plate_2d()
        del config["layers"]
        self.assert_refused(config, words=["/layers", "missing"])

    def test_config_that_is_no_json(self):
        path = self.write_config('{"name": "plate",\n "domain": }')
        self.assert_refused(path, words=["case.json", "2"])

    def test_missing_config_file(self):
        self.assert_refused("nowhere.json", words=["-config", "nowhere.json", "No such file"])
        self.assert_refused(self.directory, words=["-config", "is a directory"])

    def test_no_config(self):
        for ranks in self.rank_counts:
            result = self.run_program(ranks)
            self.assertEqual(result.status, BAD_INPUT, str(result))
            self.assertEqual(len(result.messages()), 1, str(result))
            self.assertIn("-config: missing", result.messages()[0])

    def test_unknown_node_set(self):
        config = plate_2d()
        config["objective"][0]["nodes"] = "topp"
        self.assert_refused(config, words=["/objective/0/nodes", '"topp"', '"top"'])

    def test_unknown_task(self):
        words = ["-task", '"optimise"', "optimize", "check_gradients"]
        self.assert_refused(plate_2d(), "-task", "optimise", words=words)

    def test_misspelt_option(self):
        """Before the config is read, which is not there."""
        for option, meant in (("-max_iteratons", "-max_iterations"),
                              ("-elastcity_ksp_max_it", "-elasticity_ksp_max_it"),
                              ("-sub_parts", "-subparts")):
            self.assert_refused("missing.json", option, "3", words=[option, "unknown option", f'"{meant}"', "-help"])

    def test_word_that_belongs_to_no_option(self):
        self.assert_refused(plate_2d(), "stray", words=['"stray"'])

    def test_a_measure_that_is_no_sum_of_squares(self):
        config = plate_2d()
        config["objective"][0]["measure"] = "layerwise"
        del config["objective"][0]["nodes"]
        config["objective"][0]["least_squares"] = True
        self.assert_refused(config, words=["/objective/0/least_squares"])

    def test_task_without_anything_to_vary(self):
        planar = ("-set", 'sequence={"type": "planar"}')
        self.assert_refused(plate_2d(), *planar, words=["/sequence/type", "planar", "heat"])


if __name__ == "__main__":
    run_fabseq.main()
