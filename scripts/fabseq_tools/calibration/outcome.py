# SPDX-License-Identifier: MIT
"""What a calibration has found, as its files and its last lines say it."""

import dataclasses
import os

import numpy as np

from fabseq_tools.calibration.fit_checks import rms
from fabseq_tools.calibration.picture import draw_calibration
from fabseq_tools.calibration.strain_factors import Fit
from fabseq_tools.run.command_line import write_json


@dataclasses.dataclass
class Outcome:
    """`fit`: what is left. `record`: of calibration.json, with `warnings`; `own_records`: more of each part.
    `found`: by part, {section: {key: value}} of its config. `lines`: what is printed first. `silent`: the
    factors that the points say nothing about, a text each."""

    fit: Fit
    record: dict
    own_records: list
    found: list
    lines: list
    silent: list

    def write(self, output, parts):
        """Into the directory and those of the parts; prints what was found."""
        for part, its in zip(parts, self.found):
            part.config.pop("run", None)
            for section, values in its.items():
                part.config[section] |= values
            write_json(os.path.join(part.output, "config.json"), part.config)
        records = [part_record(*of) | own for *of, own in zip(parts, self.fit.rests, self.fit.equations, self.own_records)]
        whole = records[0] if len(parts) == 1 else differences(self.fit.rest, self.fit.values)
        named = [{"config": part.path, "file": part.measured, **its} for part, its in zip(parts, records)]
        write_json(os.path.join(output, "calibration.json"),
                   self.record | whole | ({"parts": named} if len(parts) > 1 else {}))
        print("\n".join(self.lines))
        print(f"rms of {words_of(whole)}; {100 * self.fit.left():.3g} % of the measurement is left")
        for number, its in enumerate(records if len(parts) > 1 else [], start=1):
            print(f"part {number}: rms of {words_of(its)}")
        draw_calibration(parts, self.fit, os.path.join(output, "calibration.png"))
        configs = ", ".join(os.path.join(part.output, "config.json") for part in parts)
        print(f"config with {'this factor' if 'factor' in self.record else 'these factors'}: {configs}", flush=True)


def differences(rest, values):
    return {"measured_values": len(values), "rms_measured": rms(values), "rms_difference": rms(rest),
            "largest_difference": float(np.abs(rest).max())}


def part_record(part, rest, equations):
    return {"measured": part.measurement.name, "points": len(part.read.points), **differences(rest, equations.values)}


def words_of(record):
    return (f"{record['measured_values']} measured values {record['rms_measured']:.4g}, of the differences "
            f"{record['rms_difference']:.4g}, largest {record['largest_difference']:.4g}")
