# SPDX-License-Identifier: MIT
"""The command line: help, options of PETSc and of the program, an exit status on every rank, copies that do
not know of each other, and output directories that are refused."""

import os
import shutil
from unittest import mock

import run_fabseq
from bad_input_case import BadInputTest
from run_fabseq import BAD_INPUT, DONE, ENVIRONMENT, FabseqTest, OUTPUT_FAILURE, PROGRAM, distinct
from small_parts import plate_2d, post_on_substrate
from terminal import Terminal


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
        self.assert_refused(plate_2d(), words=["link", "'nowhere', which is not there"], output=output,
                            status=OUTPUT_FAILURE)


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
            for run, word in ((from_environment, "-layers"), (from_file, "-max_iterations"),
                              (from_folder, "-max_iterations")):
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
            # Within a job: one run on purpose, and two ranks.
            with mock.patch.dict(os.environ, {count: "2", rank: "0"}):
                command = ["mpirun", "-np", "1", PROGRAM, "-config", path, "-task", "check"]
                status, _, stderr = run_fabseq.run_command(command, self.directory, 120)
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
