# SPDX-License-Identifier: MIT
"""How fast the torch travels along the paths of a run, and how long it pauses after each layer."""

import dataclasses

import numpy as np

from fabseq_tools.geometry.placement import millimetres_of
from fabseq_tools.run.read_run import pauses_in_layer

USUAL_SPEED = 10.0  # mm/s, of a config without deposition rate and travel speed
LEAST_FEED = 0.2  # below it the torch goes no faster
SECONDS_PER_HOUR = 3600.0


@dataclasses.dataclass
class Pace:
    """`speed`: of the torch where a bead has its nominal section (feed 1), in lengths of the config per
    second; the wire feed is constant, so that elsewhere it is that over the feed. `origin`: where it comes
    from, in words. `pauses`: seconds after each layer, by number; `pauses_from`: in words."""

    speed: float
    origin: str
    pauses: dict
    pauses_from: str

    def speeds(self, feeds):
        return self.speed / np.maximum(feeds, LEAST_FEED)

    def known_pauses(self):
        """With the longest where none is long enough."""
        longest = max((pause for pause in self.pauses.values() if pause is not None), default=0.0)
        return {number: longest if pause is None else pause for number, pause in self.pauses.items()}


def pace_of(part, given, millimetres, section):
    """Of a run. `given`: speed at feed 1 in mm/s, or None: that of the config's deposition rate, or else
    travel_speed(). `millimetres`: of a length of the config (None: not known, speeds count in that length);
    `section`: of a bead at feed 1, in the config's lengths."""
    rate, density = (part.config.get(name, {}).get(key) for name, key in
                     (("process", "deposition_rate"), ("material", "mass_density")))
    numbers = all(isinstance(value, (int, float)) for value in (rate, density))
    if given is None and numbers:
        speed, origin = rate / SECONDS_PER_HOUR / density / section, f"deposition rate {rate:g} kg/h"
    else:
        speed = (travel_speed(part.config) if given is None else given) / (millimetres or 1.0)
        origin = "no deposition rate: the machine's or the usual one" if given is None else "--speed"
    return Pace(speed, origin, *pauses_of(part))


def travel_speed(config):
    """That of the config's machine, in mm/s, or the usual one."""
    speed, millimetres = config.get("tool", {}).get("travel_speed"), millimetres_of(config.get("domain", {}).get("unit"))
    return speed * millimetres if isinstance(speed, (int, float)) and millimetres else USUAL_SPEED


def pauses_of(part):
    """Seconds after each layer, by number, and in words where they come from: those that keep the interpass
    temperature where the run has them, or else process.dwell, for each real layer that a layer stands for.
    None where no pause is long enough. Real layers have the pause of the simulated one that they are cut
    from."""
    found = part.judged.block.get("interpass", {}).get("pauses")
    if found:
        cut = part.judged.block.get("real_layers", {}).get("passes", 1)
        pauses = {number: found[min((number - 1) // cut, len(found) - 1)] for number in part.layers}
        words = f"interpass limit {part.config['thermal']['interpass_limit']:g} degrees C"
    else:
        dwell = part.config.get("process", {}).get("dwell", 0.0)
        pauses, words = {number: dwell for number in part.layers}, "process.dwell" if dwell else "none"
    times = pauses_in_layer(part.config)
    return {number: None if pause is None else times * pause for number, pause in pauses.items()}, words
