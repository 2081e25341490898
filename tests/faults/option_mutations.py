# SPDX-License-Identifier: MIT
"""Words of a command line: odd ones, wrong ones, and ones that do not go together."""

from config_mutations import NUMBERS, VALUES, Raw, dumps, misspelt, places
from config_schema import TEXTS, legal_value

TASKS = ("optimize", "simulate", "sensitivity", "evaluate", "check_gradients", "check")
# Where the words below may point to: a file, a folder, what is not there, and a run of the config as it was.
FILE, FOLDER, MISSING, RUN = "a_file", "a_folder", "missing", "a_run"
ODD_WORDS = ("", "-", "--", "---", "-1", "0", "nan", "1e999", "1.5", "auto", "\u00e9", "-é", " ", "x=1", "-x=1", "n" * 5000)


def setting(chance, config, _):
    """-set of a place of the config, or near it."""
    path = ".".join(chance.choice(list(places(config)))[2])
    path = chance.choice([path, path, path, misspelt(chance, path), path + ".x", path + ".0", "." + path, path + ".", ""])
    value = chance.choice([*NUMBERS, *VALUES, Raw("{"), Raw("[1,"), Raw("")])
    return ["-set", path + chance.choice(["=", "=", "=", "", "=="]) + dumps(value)]


def flat_option(chance, config, keys):
    """A flat option, or nearly one, with a value that is legal or any other."""
    key = chance.choice([key for key in keys if key.option])
    value = legal_value(chance, key, len(config["domain"]["size"])) if chance.random() < 0.5 else chance.choice(NUMBERS)
    word = ",".join(map(str, value)) if isinstance(value, list) else value if isinstance(value, str) else dumps(value)
    return [key.option if chance.random() < 0.9 else misspelt(chance, key.option), word]


def iterations(chance, *_):
    return ["-max_iterations", chance.choice(["-1", "0", "1", "1.5", "1e0", "", "two", "2147483648", "9" * 20, "nan"])]


def output(chance, *_):
    return ["-output", chance.choice(["", ".", "..", FILE, FOLDER, FILE + "/below", "/dev/null/x", "/proc/nothing", "n" * 300,
                                      "a/b/c/d", "ü/é €", " ", "-", "with\nline", "./out/", "out//x", "n/" * 3000])]


def restart(chance, *_):
    return ["-restart", chance.choice(["auto", "AUTO", MISSING, FILE, FOLDER, "", ".", "out"])]


def input_file(chance, *_):
    option = chance.choice(["-design", "-sequence", "-config"])
    return [option, chance.choice([FILE, FOLDER, MISSING, "case.json", "/dev/null", "/dev/zero", ""])]


def of_a_run(chance, *_):
    """Something that a finished run has left."""
    return chance.choice([
        ["-restart", RUN], ["-restart", RUN, "-output", "other"], ["-restart", RUN, "-max_iterations", "3"],
        ["-restart", "auto", "-output", RUN], ["-restart", "auto", "-output", RUN, "-max_iterations", "4"],
        ["-output", RUN, "-overwrite"], ["-output", RUN], ["-output", RUN + "/deeper"], ["-design", RUN + "/result.h5"],
        ["-design", RUN + "/checkpoint/slot_0.h5"], ["-design", RUN + "/config.json"], ["-design", RUN],
        ["-task", "simulate", "-sequence", RUN + "/result.h5"], ["-task", "sensitivity", "-sequence", RUN + "/result.h5"],
        ["-task", "simulate", "-design", RUN + "/result.h5", "-output", RUN, "-overwrite"], ["-restart", RUN + "/checkpoint"],
        ["-output", RUN, "-overwrite", "-design", RUN + "/result.h5"], ["-restart", RUN, "-overwrite"],
        ["-task", chance.choice(["simulate", "sensitivity"]), "-sequence", RUN + "/result.h5", "-output", RUN, "-overwrite"]])


def groups(chance, *_):
    return ["-layer_groups", chance.choice(["0", "1", "2", "3", "4", "-1", "auto", "1000000", "1.5", "three"])]


def wall_time(chance, *_):
    return ["-max_wall_time", chance.choice(["0", "-1", "1e-9", "0.5", "nan", "inf", "1e400", "1:2", "0:0:1", "0:0:0", "a:b:c",
                                             ""])]


def task(chance, *_):
    return ["-task", chance.choice([*TASKS, "check", "Optimize", "", "all", "-check"])]


def petsc_option(chance, *_):
    return chance.choice([
        ["-elasticity_ksp_max_it", "0"], ["-elasticity_ksp_max_it", "-3"], ["-elasticity_ksp_type", "nothing"],
        ["-heat_pc_type", "nothing"], ["-elasticity_ksp_rtol", "0"], ["-elasticity_ksp_rtol", "x"], ["-options_file", MISSING],
        ["-options_file", "case.json"], ["-log_view"], ["-malloc_debug"], ["-ksp_monitor"], ["-info", "x"], ["-mat_type", "x"],
        ["-heat_ksp_max_it", "1"], ["-elasticity_pc_type", "none"], ["-options_left"], ["-on_error_abort", "0"],
        ["-release_ksp_type", "preonly"], ["-vec_type", "none"], ["-options_view"]])


def stray(chance, *_):
    return [chance.choice([*ODD_WORDS, *TEXTS])]


def flags(chance, *_):
    return [chance.choice(["-overwrite", "-picture", "-help", "-version", "-help_markdown", "-binary", "-stages", "-sensitivity",
                           "-Help", "-overwrite=1", "--version"])]


def reference_path(*_):
    return ["-solver_path", "reference"]


OPTIONS = (setting, setting, setting, flat_option, flat_option, iterations, output, restart, input_file, groups, wall_time, task,
           petsc_option, stray, flags, reference_path)
