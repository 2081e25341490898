# SPDX-License-Identifier: MIT
"""The materials on the shelf, whose lengths are in mm, for a config in any unit of length."""

import os

from fabseq_tools.run.command_line import RunError
from fabseq_tools.run.places import ROOT
from fabseq_tools.run.read_run import read_config
from fabseq_tools.start.config_text import Entry

MATERIALS = os.path.join(ROOT, "configs", "materials")
DEFAULT_MATERIAL = "ER70S-6"
POWERS = {"mass_density": -3, "conductivity": -1}  # of the length in each key's unit; stresses stay in MPa


def known_materials():
    names = os.listdir(MATERIALS) if os.path.isdir(MATERIALS) else []
    return sorted(os.path.splitext(name)[0] for name in names if name.endswith(".json"))


def in_unit(material, millimetres):
    """The values that change with the unit of length, in one that is so many millimetres long."""
    return {key: float(f"{material[key] * millimetres ** -power:.6g}") for key, power in POWERS.items() if key in material}


def material_of(arguments):
    """The entry of the material's file, and warnings."""
    known = known_materials()
    asked = arguments.material or DEFAULT_MATERIAL
    name = {name.lower(): name for name in known}.get(asked.lower())
    if name is None:
        raise RunError(f"--material: found {asked}; allowed: {', '.join(known) or 'none is there'}")
    path = os.path.join(MATERIALS, name + ".json")
    material = read_config(path)
    value, remark, warnings = {"file": path}, f"{material.get('name', name)}", []
    remark += "" if arguments.material else "; --material names another"
    if arguments.millimetres is None:
        warnings.append(f"--unit: found {arguments.unit}, whose length is not known: {' and '.join(POWERS)} of the material are "
                        "per mm; put your own values beside its file")
    elif arguments.millimetres != 1.0:
        value |= in_unit(material, arguments.millimetres)
        remark += f", {' and '.join(key.replace('_', ' ') for key in POWERS)} with lengths in {arguments.unit}, stresses in MPa"
    return Entry("material", value, remark + ". The inherent strain is the same in all files: calibrate it."), warnings
