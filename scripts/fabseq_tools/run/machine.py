# SPDX-License-Identifier: MIT
"""The machine of a config. The program alone knows what follows from a machine's file (-task machine)."""

import json
import os
import tempfile

from fabseq_tools.run.command_line import RunError, reason_of, run_command, write_json

OPTION = "--machine"
HELP = "machine file, or the name of one of configs/machines, in place of what the config says of its machine"
NOT_OF_MACHINE = "most_places", "places_share"  # keys of tool that no machine file replaces
OF_MACHINE = {"process": ("deposition_rate",), "thermal": ("passes", "interpass_limit")}
NOT_TURNED = "tilt"  # the constraint that a torch that does not tilt has not


def machine_of(word):
    """The value of the key `machine` for a word of the command line: a file's absolute path, or else the name
    of one of configs/machines."""
    return os.path.abspath(word) if os.path.isfile(word) else word


def settings_for(config, word):
    """Settings, by path, that put a machine in place of the one that a config, as it was written, has. Empty
    without one."""
    if word is None:
        return {}
    settings = {"machine": machine_of(word)}
    if "tool" in config:
        settings["tool"] = {key: value for key, value in config["tool"].items() if key in NOT_OF_MACHINE}
    for section, keys in OF_MACHINE.items():
        if set(keys) & set(config.get(section, {})):
            settings[section] = {key: value for key, value in config[section].items() if key not in keys}
    return settings


def config_with_machine(program, path, *options):
    """A config with what follows from its machine's file. Raises RunError with the program's own line."""
    try:
        done = run_command([program, "-config", path, "-task", "machine", *options])
    except RunError as error:
        raise RunError(reason_of(error)) from error
    return json.loads(done.stdout)


def keys_of_machine(program, machine, unit, thickness=None):
    """What follows from a machine for a config in a unit of length, with layers of that thickness if one is
    given."""
    layers = {} if thickness is None else {"target": thickness}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "machine.json")
        write_json(path, {"domain": {"unit": unit}, "machine": machine, "layers": layers})
        return config_with_machine(program, path)


def torch_tilts(tool):
    """Whether the torch of a config's block `tool` stands on the layers."""
    return tool.get("axis", "normal") == "normal"
