# SPDX-License-Identifier: MIT
"""Bad input: status 2 on every rank, one line with the key, what was found and what is allowed, nothing
written."""

import os
import shutil
import time
from unittest import mock

import h5py
import numpy as np

import run_fabseq
from run_fabseq import BAD_INPUT, DONE, ENVIRONMENT, FabseqTest, OUTPUT_FAILURE, PROGRAM, distinct
from small_parts import hook_3d, plate_2d, post_on_substrate, write_voxels
from terminal import Terminal


class BadInputTest(FabseqTest):
    rank_counts = distinct(3, 1)

    def assert_refused(self, config, *arguments, words, timeout=None, status=BAD_INPUT, **options):
        """The run must be refused with one line that holds all `words`, and leave the working directory as it
        was."""
        path = config if isinstance(config, str) else self.write_config(config)
        before = self.tree()
        for ranks in self.rank_counts:
            with self.subTest(ranks=ranks, words=words):
                result = self.run_program(ranks, "-config", path, *arguments, timeout=timeout, **options)
                self.assertEqual(result.status, status, str(result))
                self.assertEqual(result.stdout.strip(), "", str(result))
                messages = result.messages()
                self.assertEqual(len(messages), 1, str(result))
                self.assertTrue(messages[0].startswith("fabseq: "), str(result))
                for word in words:
                    self.assertIn(word, messages[0])
                self.assertEqual(self.tree(), before, "a refused run has touched files")


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
                self.assert_refused(plate_2d(), "-set", f"projection.{key}={value}", words=[f"/projection/{key}: found "])

    @run_fabseq.only_release  # sanitizers take address space by the terabyte
    def test_address_space(self):
        """Limits with which libraries would end, or wait for ever; the last leaves the part too little."""
        launcher = run_fabseq.launcher

        def limited(kilobytes):
            return mock.patch.object(run_fabseq, "launcher", lambda ranks: [
                *launcher(ranks), "bash", "-c", f'ulimit -v {kilobytes} && exec "$0" "$@"'])
        with limited(300000):
            self.assert_refused(plate_2d(), words=["the limit of the address space: found 0.307 GB (ulimit -v); allowed: "])
        config = hook_3d()
        config["domain"]["elements"] = [6 * n for n in config["domain"]["elements"]]
        with limited(700000):
            self.assert_refused(config, "-layers", 400, words=["/layers/count: ", "; the limit of the address space is "])

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
        for option, meant in (("-max_iteratons", "-max_iterations"), ("-elastcity_ksp_max_it", "-elasticity_ksp_max_it"),
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


class PartErrorsTest(BadInputTest):
    rank_counts = (3,)  # on one rank everybody says the same

    def test_empty_part(self):
        config = plate_2d()
        config["part"] = {"box": {"min": [3, 3], "max": [4, 4]}}
        self.assert_refused(config, words=["/part", "no element"])

    def hanging_blocks(self):
        """A wall, a block of 4 x 2 elements 0.3 above the plate and one element in the air."""
        config = plate_2d()
        config["part"] = {"union": [{"box": {"min": [0, 0], "max": [1.0, 1.2]}},
                                    {"box": {"min": [1.4, 0.3], "max": [1.8, 0.5]}},
                                    {"box": {"min": [1.2, 0.8], "max": [1.3, 0.9]}}]}
        return config

    def test_hanging_pieces_are_listed(self):
        self.assert_refused(self.hanging_blocks(), words=["/part", "2 pieces", "8 elements in [1.4,0.3]..[1.8,0.5]",
                                                          "1 element in [1.2,0.8]..[1.3,0.9]", "part.keep"])

    def test_hanging_pieces_are_dropped_with_a_warning(self):
        config = self.hanging_blocks()
        config["part"]["keep"] = "connected"
        for ranks in self.rank_counts:
            result = self.run_config(ranks, config, "-max_iterations", 1)
            self.assert_done(result)
            messages = result.messages()
            self.assertEqual(len(messages), 1, str(result))
            self.assertTrue(messages[0].startswith("warning: /part: 2 pieces"), str(result))
            self.assertEqual(result.json("summary.json")["part_elements"], 120)

    def test_pieces_that_touch_at_an_edge_only_are_not_connected(self):
        config = hook_3d()
        config["part"] = {"union": [{"box": {"min": [0, 0, 0], "max": [0.8, 0.8, 0.8]}},
                                    {"box": {"min": [0.8, 0, 0.8], "max": [1.6, 0.8, 1.6]}}]}
        self.assert_refused(config, words=["/part", "1 piece", "64 elements in [0.8,0,0.8]..[1.6,0.8,1.6]"])

    def test_no_contact_with_the_plate(self):
        config = plate_2d()
        config["part"] = {"box": {"min": [0, 0.3], "max": [2, 1.2]}}
        self.assert_refused(config, words=["/build_plate", "y-", "180 elements in [0,0.3]..[2,1.2]"])

    def test_node_set_without_nodes(self):
        config = plate_2d()
        config["node_sets"]["far"] = {"box": {"min": [5, 5], "max": [6, 6]}}
        self.assert_refused(config, words=["/node_sets/far", "no node"])

    def test_more_samples_than_nodes(self):
        config = plate_2d()
        config["node_sets"]["top"]["samples"] = 500
        self.assert_refused(config, words=["/node_sets/top/samples", "500", "21"])

    def test_too_large_for_the_indices(self):
        """Also where the nodes can be counted and only the components of their displacements cannot."""
        for edge in (100000, 1000):
            config = hook_3d()
            config["domain"]["elements"] = [edge] * 3
            start = time.monotonic()
            self.assert_refused(config, words=["/domain/elements", f"[{edge},{edge},{edge}]"], timeout=60)
            self.assertLess(time.monotonic() - start, 60)

    def test_substrate_and_clamps(self):
        config = post_on_substrate(2)
        config["substrate"] = {"box": {"min": [5, 5], "max": [6, 6]}}
        self.assert_refused(config, words=["/substrate", "no element"])
        config = post_on_substrate(2)
        config["clamps"] = {"box": {"min": [0, 0.9], "max": [0.1, 1.2]}}
        self.assert_refused(config, words=["/clamps", "no node of part or substrate"])
        for task in ("optimize", "simulate", "check"):
            config["clamps"] = {"box": {"min": [0, 0], "max": [0, 0]}}
            self.assert_refused(config, "-task", task, words=["/clamps", "rigid motion"])
        config = post_on_substrate(2)
        config["part"] = {"box": {"min": [0.4, 0.6], "max": [1.0, 1.2]}}
        self.assert_refused(config, words=["/build_plate", "substrate"])

    def test_release_of_pieces_that_only_the_plate_holds(self):
        config = plate_2d()
        config["part"] = {"union": [{"box": {"min": [0, 0], "max": [0.5, 1.2]}}, {"box": {"min": [1, 0], "max": [2, 1.2]}}]}
        config["objective"][0]["after_release"] = True
        for task in ("optimize", "evaluate", "check"):
            self.assert_refused(config, "-task", task, words=["/objective/0/after_release", "2 pieces"])
        config["objective"][0]["after_release"] = False
        run = self.run_config(2, config, "-task", "simulate")
        self.assert_done(run)
        self.assertIn("2 pieces", run.messages()[0])
        with h5py.File(run.path("result.h5"), "r") as file:
            self.assertNotIn("release_displacement", file)
            self.assertNotIn("released_displacement", file)

    def test_strain_that_turns_with_a_time_from_a_file(self):
        config = plate_2d()
        write_voxels(os.path.join(self.directory, "time.h5"), np.full((12, 20), 0.5), dataset="time")
        config["sequence"] = {"type": "file", "file": "time.h5"}
        config["objective"], config["constraints"] = config["objective"][:1], []
        config["material"] = {"inherent_strain": {"tangential": -0.01, "normal": 0}}
        self.assert_refused(config, "-task", "simulate", words=["/material/inherent_strain", "file"])


class FileErrorsTest(BadInputTest):
    rank_counts = (3,)

    def voxel_config(self, **voxels):
        config = plate_2d()
        config["part"] = {"voxels": {"file": "part.h5", **voxels}}
        return config

    def write_part(self, density, **options):
        write_voxels(os.path.join(self.directory, "part.h5"), density, **options)

    def test_missing_voxel_file(self):
        self.assert_refused(self.voxel_config(), words=["/part/voxels/file", "part.h5", "No such file"])

    def test_voxel_file_that_is_no_hdf5(self):
        with open(os.path.join(self.directory, "part.h5"), "w", encoding="utf-8") as file:
            file.write("solid part\n")
        self.assert_refused(self.voxel_config(), words=["/part/voxels/file", "part.h5"])

    def test_missing_voxel_dataset(self):
        self.write_part(np.ones((12, 20)))
        self.assert_refused(self.voxel_config(dataset="rho"), words=["/part/voxels/dataset", "rho"])

    def test_wrong_voxel_shape(self):
        self.write_part(np.ones((20, 12)))
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "20", "12"])
        self.write_part(np.ones((3, 12, 20)))
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset"])

    def test_voxels_that_are_no_densities(self):
        density = np.ones((12, 20))
        density[3, 4] = np.nan
        self.write_part(density)
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "1 value"])
        density[3, 4] = 1.5
        self.write_part(density)
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "1.5"])

    def test_values_outside_the_dataset(self):
        """Of a pipe nobody would ever see the end."""
        os.mkfifo(os.path.join(self.directory, "pipe"))
        with h5py.File(os.path.join(self.directory, "part.h5"), "w") as file:
            file.create_dataset("density", (12, 20), "u1", external=[("pipe", 0, 240)])
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "external files"], timeout=60)
        layout = h5py.VirtualLayout((12, 20), "u1")
        layout[...] = h5py.VirtualSource("other.h5", "density", (12, 20))
        with h5py.File(os.path.join(self.directory, "part.h5"), "w") as file:
            file.create_virtual_dataset("density", layout)
        self.assert_refused(self.voxel_config(), words=["/part/voxels/dataset", "is virtual"])

    def test_empty_voxel_part(self):
        self.write_part(np.full((12, 20), 0.3))
        self.assert_refused(self.voxel_config(threshold=0.5), words=["/part", "no element", "threshold"])

    def test_design_file(self):
        evaluate = ("-task", "evaluate", "-design", "design.h5")
        self.assert_refused(plate_2d(), *evaluate, words=["-design", "design.h5"])
        path = os.path.join(self.directory, "design.h5")
        write_voxels(path, np.ones((3, 3)), dataset="design")
        self.assert_refused(plate_2d(), *evaluate, words=["-design: dataset 'design'", "[3,3]", "[12,20]"])
        write_voxels(path, np.full((12, 20), 7.0), dataset="design")
        self.assert_refused(plate_2d(), *evaluate, words=["-design", "/sequence/bounds"])

    def test_file_without_a_design(self):
        """Then the initial values count, as without the option."""
        write_voxels(os.path.join(self.directory, "design.h5"), np.ones((3, 3)))
        for ranks in self.rank_counts:
            expected = self.run_config(ranks, plate_2d(), "-task", "evaluate")
            result = self.run_config(ranks, plate_2d(), "-task", "evaluate", "-design", "design.h5")
            self.assert_done(result)
            self.assertEqual(len(result.messages()), 1, str(result))
            self.assertIn("-design: 'design.h5' has no dataset 'design'", result.messages()[0])
            self.assertEqual(result.json("evaluation.json")["responses"], expected.json("evaluation.json")["responses"])

    def test_time_file(self):
        config = plate_2d()
        config["sequence"] = {"type": "file", "file": "time.h5"}
        del config["objective"][1], config["constraints"]
        self.assert_refused(config, "-task", "simulate", words=["/sequence/file", "time.h5"])
        write_voxels(os.path.join(self.directory, "time.h5"), np.full((12, 20), -3.0), dataset="time")
        self.assert_refused(config, "-task", "simulate", words=["/sequence", "time.h5"])


class OutputDirectoryTest(BadInputTest):
    def test_a_run_is_not_overwritten(self):
        output = os.path.join(self.directory, "kept")
        first = self.run_config(1, plate_2d(), "-max_iterations", 1, output=output)
        self.assert_done(first)
        for task in ("optimize", "simulate", "sensitivity", "evaluate", "check_gradients"):
            self.assert_refused(plate_2d(), "-task", task, words=["kept", "-overwrite"], output=output)

    def test_a_file_in_the_place_of_the_directory(self):
        output = os.path.join(self.directory, "occupied")
        with open(output, "w", encoding="utf-8") as file:
            file.write("mine\n")
        self.assert_refused(plate_2d(), words=["occupied"], output=output, status=OUTPUT_FAILURE)

    def test_a_link_that_leads_nowhere(self):
        output = os.path.join(self.directory, "link")
        os.symlink("nowhere", output)
        self.assert_refused(plate_2d(), words=["link", "'nowhere', which is not there"], output=output, status=OUTPUT_FAILURE)


class CommandLineTest(FabseqTest):
    def test_every_rank_exits_with_2(self):
        """mpirun shows one rank's status and then kills the others: here each notes its own and ends with
        0."""
        script = os.path.join(self.directory, "note_status.sh")
        with open(script, "w", encoding="utf-8") as file:
            file.write('"$@" 2>message.$OMPI_COMM_WORLD_RANK\necho $? >status.$OMPI_COMM_WORLD_RANK\n')
        hanging = plate_2d()
        hanging["part"] = {"box": {"min": [0, 0.3], "max": [2, 1.2]}}
        too_many_samples = plate_2d()
        too_many_samples["node_sets"]["top"]["samples"] = 500
        for config, arguments in ((plate_2d(), ["-task", "none"]), (plate_2d(), ["-poisson", "7"]), (hanging, []),
                                  (too_many_samples, [])):
            with self.subTest(arguments=arguments, part=config["part"]):
                path = self.write_config(config)
                command = ["mpirun", "-np", "3", "sh", script, PROGRAM, "-config", path, *arguments]
                status, stdout, stderr = run_fabseq.run_command(command, self.directory, 120)
                self.assertEqual(status, 0, stdout + stderr)
                noted, lines = [], []
                for rank in range(3):
                    with open(os.path.join(self.directory, f"status.{rank}"), encoding="utf-8") as file:
                        noted.append(int(file.read()))
                    with open(os.path.join(self.directory, f"message.{rank}"), encoding="utf-8") as file:
                        lines += file.read().splitlines()
                self.assertEqual(noted, [BAD_INPUT] * 3)
                self.assertEqual(len(lines), 1, lines)

    def test_options_that_petsc_does_not_start_with(self):
        """One line, too, of an option that PETSc reads when it starts."""
        path = self.write_config(plate_2d())
        before = self.tree()
        for option, value, word in (("-options_file", "nothing", "nothing"), ("-malloc_debug", "perhaps", "perhaps")):
            for ranks in distinct(3, 1):
                result = self.run_program(ranks, "-config", path, option, value)
                self.assertEqual(result.status, BAD_INPUT, str(result))
                (message,) = result.messages()
                self.assertTrue(message.startswith("fabseq: PETSc: "), message)
                self.assertIn(word, message)
        self.assertEqual(self.tree(), before)

    def test_unread_petsc_option_is_a_warning(self):
        for ranks in distinct(3, 1):
            result = self.run_config(ranks, plate_2d(), "-max_iterations", 1, "-elasticity_ksp_max_itt", 7)
            self.assertEqual(result.status, DONE, str(result))
            self.assertEqual(len(result.messages()), 1, str(result))
            self.assertIn("-elasticity_ksp_max_itt", result.messages()[0])
            self.assertTrue(result.messages()[0].startswith("warning: "))

    def test_petsc_options_that_are_read_are_no_warning(self):
        options = [word for solver in ("elasticity", "heat", "release") for word in (f"-{solver}_ksp_max_it", 700)]
        result = self.run_config(1, post_on_substrate(2), "-max_iterations", 1, "-solver_path", "reference", *options)
        self.assert_done(result)
        self.assertEqual(result.messages(), [])

    def test_own_options_that_only_petsc_would_see(self):
        path = self.write_config(plate_2d())
        options, petscrc = (os.path.join(self.directory, name) for name in ("options", ".petscrc"))
        with open(options, "w", encoding="utf-8") as file:
            file.write("-max_iterations 3\n")
        for ranks in distinct(2, 1):
            with mock.patch.dict(os.environ, {"PETSC_OPTIONS": "-layers 7"}):
                from_environment = self.run_program(ranks, "-config", path)
            from_file = self.run_program(ranks, "-config", path, "-options_file", options)
            shutil.copy(options, petscrc)
            from_folder = self.run_program(ranks, "-config", path)
            os.remove(petscrc)
            for run, word in ((from_environment, "-layers"), (from_file, "-max_iterations"), (from_folder, "-max_iterations")):
                self.assertEqual(run.status, BAD_INPUT, str(run))
                (message,) = run.messages()
                self.assertIn(f"fabseq: {word}: found in PETSC_OPTIONS", message)
        with mock.patch.dict(os.environ, {"PETSC_OPTIONS": "-heat_ksp_max_it 500"}):
            self.assert_done(self.run_program(1, "-config", path, "-task", "check"))

    def test_petscs_own_table_of_options(self):
        run = self.run_config(1, plate_2d(), "-max_iterations", 1, "-options_left")
        self.assert_done(run)
        self.assertIn("#PETSc Option Table entries:", run.stdout)
        self.assertIn("There are no unused options.", run.stdout)
        self.assertEqual(run.messages(), [])

    def test_copies_that_do_not_know_of_each_other(self):
        """As srun starts them without PMIx, or the mpirun of another MPI."""
        path = self.write_config(plate_2d())
        for count, rank in (("SLURM_STEP_NUM_TASKS", "SLURM_PROCID"), ("PMI_SIZE", "PMI_RANK")):
            said = []
            for number in "01":
                with mock.patch.dict(os.environ, {count: "2", rank: number}):
                    run = self.run_program(1, "-config", path)
                self.assertEqual(run.status, BAD_INPUT, str(run))
                said += run.messages()
            self.assertEqual(len(said), 1, said)
            self.assertIn("started 2 processes that do not know of each other", said[0])
            with mock.patch.dict(os.environ, {count: "2", rank: "0"}):  # within a job: one run on purpose, and two ranks
                status, _, stderr = run_fabseq.run_command(["mpirun", "-np", "1", PROGRAM, "-config", path, "-task", "check"],
                                                           self.directory, 120)
                self.assertEqual(status, DONE, stderr)
                self.assert_done(self.run_program(2, "-config", path, "-task", "check"))

    def test_a_shell_of_several_tasks(self):
        """As `srun --pty -n 4 bash` starts it: what is typed there, or started by the task with the terminal,
        is one process."""
        command = f"{PROGRAM} -config {self.write_config(plate_2d())} -task check"
        environment = {**ENVIRONMENT, **os.environ, "SLURM_STEP_NUM_TASKS": "4", "SLURM_PROCID": "0"}
        with Terminal(self.directory, environment, 120) as terminal:
            for line in (command, f"bash -c '{command}; exit $?'"):
                terminal.run(line)
                terminal.wait_for("pieces: 1")
                self.assertEqual(terminal.wait_for_status(), DONE)
            terminal.run(f"SLURM_PTY_PORT=1 setsid --wait bash -c '{command}; exit $?'")
            terminal.wait_for("pieces: 1")
            self.assertEqual(terminal.wait_for_status(), DONE)
            terminal.run(f"SLURM_PTY_PORT=1 SLURM_PROCID=1 setsid --wait bash -c '{command}; exit $?'")
            self.assertEqual(terminal.wait_for_status(), BAD_INPUT)
            terminal.run(f"setsid --ctty --wait bash -c '{command}; exit $?'")
            terminal.wait_for("srun started 4 processes that do not know of each other")

    def test_help_and_version(self):
        for ranks in distinct(3, 1):
            for option in ("-help", "--help", "-h"):
                result = self.run_program(ranks, option, output="")
                self.assert_done(result)
                for word in ("Usage", "-max_iterations", "layer_thickness", "filter_radius", "Exit status",
                             "every task but check"):
                    self.assertIn(word, result.stdout)
                self.assertEqual(result.stdout.count("Usage"), 1)  # one rank prints
            result = self.run_program(ranks, "-version", output="")
            self.assert_done(result)
            self.assertRegex(result.stdout.strip(), r"^fabseq \d+\.\d+\.\d+$")
        self.assertEqual(self.tree(), {})

    def test_check_prints_the_part_and_writes_nothing(self):
        path = self.write_config(plate_2d())
        before = self.tree()
        for ranks in distinct(3, 1):
            for options in ({}, {"output": ""}):
                result = self.run_program(ranks, "-config", path, "-task", "check", **options)
                self.assert_done(result)
                self.assertEqual(self.tree(), before)
                # The disc around (2, 0.6) with radius 0.31 holds the centres of 16 elements.
                for words in ("224 elements of 240", "pieces: 1", "plate contact: 20 elements",
                              "node set top: 21 nodes", "memory", "s an iteration"):
                    self.assertIn(words, result.stdout)


if __name__ == "__main__":
    run_fabseq.main()
