# SPDX-License-Identifier: MIT
"""Results in 3D whose layers have a closed form, as the scripts that export layers and paths read them."""

import json
from pathlib import Path

import h5py


def write_layers(directory, size, built, count, temperature=None, time=None, config=None, summary=None, **datasets):
    """The output directory of a simulation with `count` layers of the pseudo-time 1 - `temperature` of the
    nodes, or of `time` of the elements. `built`: [z][y][x]. `summary`: more of summary.json, `datasets`: of
    result.h5."""
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    with h5py.File(directory / "result.h5", "w") as file:
        file["density"] = 1.0 * built
        for name, values in {"temperature": temperature, "time": time, **datasets}.items():
            if values is not None:
                file[name] = values
    content = {"name": "made_up", "domain": {"size": list(size), "elements": list(built.shape[::-1])}, "part": {},
               "sequence": {"type": "heat"}, "layers": {"type": "curved", "count": count}, **(config or {})}
    table = [{"volume": 1.0}] * count if isinstance(count, int) else count
    for name, values in (("config.json", content), ("summary.json", {"responses": [], "layers": table, **(summary or {})})):
        (directory / name).write_text(json.dumps(values), encoding="utf-8")
    return str(directory)
