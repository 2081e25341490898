# SPDX-License-Identifier: MIT
"""Fits the strain of a config, or one factor on a material that flows, to a measured part.

    fabseq-tools calibrate BUILT MEASURED [BUILT MEASURED]... --output DIR [--released] [--rigid]
                       [--isotropic] [--vanishing] [--factor elongation|yield]
                       [--tolerance LENGTH] [--unit UNIT]
                       [--program build/release/fabseq] [--ranks N] [-- OPTIONS OF THE PROGRAM]

BUILT is what was built: the folder of a run (-task optimize, simulate or evaluate), of which the binary
layers are simulated; or a config, of which its own sequence is, the start design where it has one.

MEASURED is in the config's coordinates and its unit of length, and one of two:

- Displacements: a table (CSV) whose first line names its columns: x, y, z, the points in the part as drawn or
  in the substrate, and ux, uy, uz, their displacements (2D without z and uz). Other usual names are known,
  too: dx, U1, disp_x, dev x; x_nominal beside x_actual. A displacement that was not measured is left empty,
  lines that begin with # do not count. Points outside of the elements are moved to the nearest place on their
  surface.
- A scan: such a table with x, y, z only (CSV, TXT, XYZ, ASC), a cloud of points (PLY) or a mesh (PLY, OBJ,
  STL). Each is a point of the surface of the finished part. What counts is how far it is from the surface as
  drawn, along its normal: from the mesh of part.mesh, in its place, or else from the
  boundary of the elements. Slanted and round surfaces of these are stairs, so that a scan wants a mesh.

Points that are no numbers, or all of whose numbers are 0, are left out, equal ones count once; their number
is printed. Points whose unit or axes seem to be others than the part's are refused; --unit names that of a
file without units.

A point farther from that surface than --tolerance (default: the longest edge of an element for displacements,
three of them for a scan) is a mistake: all such points are named before the process is simulated. --rigid is
for points in a frame of their own: a scan has to be aligned to the drawing to within the tolerance first, and
the rest of the motion is found together with the factors.

The model is made with a single layer first, to see where its elements are. Then the process is simulated
(-task simulate) with a few scales; displacements are linear in the strain, so any other scale follows from
these. Into DIR go the simulations, calibration.json (factors, what is left of the differences),
calibration.png (measured against simulated points) and config.json, the effective config, or the run's, with
the factors found.

Factors outside 0.05 to 5, or that leave more than a fifth of the measurement, are warned of; where they are 0
the command ends with status 2 and leaves nothing.

Several parts of one material, each with its config, get common factors; in DIR each has a folder, part_1,
part_2, ..., with its simulations and its config.json. --vanishing fits thermal.vanishing beside the factors,
for which the parts must have had different pauses (process.dwell). It is compared with a constant strain
(thermal.vanishing 1e30), which is kept unless the fit lowers the rms of the differences by a tenth and by two
standard deviations.

With plastic flow (process.model elastoplastic) the displacement is not linear, and one factor is fitted: with
--factor elongation, the default, on the config's material.elongations, or without the block thermal on its
strain_scale, all axes alike; with --factor yield on its yield_stress and hardening. Mostly three to eight
simulations, at most 12, find it between 0.05 and 5. calibration.json names the keys and all factors that were
simulated, and what was left before.

Factors that the points say nothing about stay 1, with a warning. The method: docs/formulation.md 4.5.
"""

import contextlib
import functools
import os
import shutil

import numpy as np

from fabseq_tools.calibration.column_names import AXES
from fabseq_tools.calibration.fit_checks import FitChecks, rms
from fabseq_tools.calibration.flow_checks import FlowChecks
from fabseq_tools.calibration.flow_factor import KINDS, FlowFactor, factored_keys, factored_material
from fabseq_tools.calibration.measured_part import MeasuredPart
from fabseq_tools.calibration.outcome import Outcome
from fabseq_tools.calibration.strain_factors import fit_factors
from fabseq_tools.calibration.vanishing import CONSTANT, VanishingSearch
from fabseq_tools.run.command_line import RunError, count, parse, parser_of, positive, warn
from fabseq_tools.run.places import PROGRAM

COMMAND = "calibrate"
WANTED_DIFFERENCE = 200.0  # degrees C, between the hottest layers of the parts; docs/heat.md


def read_parts(arguments):
    """Refuses what cannot be calibrated, before anything is written."""
    words = [arguments.built, arguments.measured, *arguments.more]
    pairs = list(zip(words[::2], words[1::2]))
    if len(words) % 2:
        raise RunError(f"{words[-1]}: found a config without a measurement; allowed: pairs of BUILT and MEASURED")
    if arguments.vanishing and len(pairs) == 1:
        raise RunError("--vanishing: found one part, which cannot tell a small strain from a hot part; allowed: two or more, "
                       "built with different pauses")
    folders = [arguments.output] if len(pairs) == 1 else [os.path.join(arguments.output, f"part_{number}")
                                                          for number in range(1, len(pairs) + 1)]
    parts = [MeasuredPart(arguments, *pair, folder, functools.partial(warn, COMMAND)) for pair, folder in zip(pairs, folders)]
    for part in parts:
        if part.dimension != parts[0].dimension:
            raise RunError(f"{part.path}: found {part.dimension}D beside {parts[0].dimension}D; allowed: parts of one dimension")
        refuse_other_process(arguments, part, parts[0])
        if arguments.vanishing and not part.is_heated:
            raise RunError(f"{part.path}: /thermal: found none; with --vanishing allowed: a block in every config")
    return parts


def refuse_other_process(arguments, part, first):
    """Raises a RunError where the process model is not the first part's, or has no use for an option."""
    model = "elastoplastic" if part.flows else "linear"
    if part.flows != first.flows or (part.flows and part.is_heated != first.is_heated):
        found = f"process.model {model} {'with' if part.is_heated else 'without'} thermal"
        raise RunError(f"{part.path}: found {found}; allowed: model and thermal as in the first part")
    of = f"found process.model {model} in {part.path}"
    if part.flows and arguments.vanishing:
        raise RunError(f"--vanishing: {of}; allowed: linear (with flow the strain follows material.elongations)")
    if not part.flows and arguments.factor:
        raise RunError(f"--factor: {of}; allowed: elastoplastic (else strain_scale is fitted)")


def refuse_other_materials(parts):
    """Raises a RunError if the parts have not one strain and stiffness, or one temperature that these hold
    at."""
    for section in ("material", "thermal"):
        blocks = [part.config.get(section, {}) for part in parts]
        keys = [key for key in blocks[0] if key not in ("file", "strain_scale")] if section == "material" else ["reference"]
        for part, block in zip(parts, blocks):
            for key in keys:
                if block.get(key) != blocks[0].get(key):
                    raise RunError(f"{part.path}: /{section}/{key}: found {block.get(key)}; allowed: as in the first part, "
                                   f"{blocks[0].get(key)}")


def calibrate(arguments):
    parts = read_parts(arguments)
    before = os.path.isdir(arguments.output)
    try:
        fit_parts(arguments, parts)
    except RunError:
        for folder in [path for part in parts for path in part.simulations]:
            shutil.rmtree(folder, ignore_errors=True)
        for folder in [*(part.output for part in parts), *([] if before else [arguments.output])]:
            remove_if_empty(folder)
        raise


def remove_if_empty(folder):
    with contextlib.suppress(OSError):
        os.rmdir(folder)


def fit_parts(arguments, parts):
    """Simulates the parts, and writes what is found."""
    for part in parts:
        os.makedirs(part.output, exist_ok=True)
        part.make_model()
    refuse_other_materials(parts)
    outcome = (fit_flow if parts[0].flows else fit_strain)(arguments, parts)
    outcome.write(arguments.output, parts)
    for text in [*(f"the points say nothing about the {name}, which stays 1" for name in outcome.silent),
                 *outcome.record["warnings"]]:
        warn(COMMAND, text)


def fit_strain(arguments, parts):
    """The Outcome of factors on a strain that displacements are linear in."""
    factors = np.ones((parts[0].dimension, 1)) if arguments.isotropic else np.eye(parts[0].dimension)
    search = VanishingSearch(parts, factors, arguments.rigid) if arguments.vanishing else None
    if search:
        found = search.find()
        fit = found.fit
    else:
        fit = fit_factors([part.measurement for part in parts], [part.simulate_all(factors) for part in parts], arguments.rigid)
    checks = FitChecks(parts, fit, factors @ fit.factors, (factors @ fit.determined).astype(bool), arguments)
    checks.refuse_nothing()
    scale = checks.scale.tolist()
    outcome = Outcome(fit=fit, record={"strain_scale": scale, "determined": checks.determined.tolist(), **judged(parts, checks)},
                      own_records=[{} for _ in parts], found=[{"material": {"strain_scale": scale}} for _ in parts],
                      lines=[f"strain_scale {rounded(scale)}"],
                      silent=[f"factor along {AXES[axis]}" for axis in np.flatnonzero(~checks.determined)])
    if search:
        outcome.record |= vanishing_record(found)
        outcome.own_records = [heat_record(part, search.own_factors(number), factors) for number, part in enumerate(parts)]
        for its in outcome.found:
            its["thermal"] = {"vanishing": found.temperature}
        outcome.lines += vanishing_lines(outcome.record, rms(fit.rest), outcome.own_records)
        warn_of_temperatures_alike(outcome.own_records)
    return outcome


def fit_flow(arguments, parts):
    """The Outcome of one factor on a material that flows."""
    search = FlowFactor(parts, arguments.factor or KINDS[0], arguments)
    FlowChecks(search, arguments, enlarged=True).refuse_nothing()
    search.find()
    checks, best, first = FlowChecks(search, arguments), search.best, search.simulated[0]
    tried = [{"factor": one.factor, "rms_difference": rms(one.fit.rest)} for one in search.simulated]
    return Outcome(fit=best.fit,
                   record={"factor": best.factor, "factored": [f"material.{key}" for key in factored_keys(parts[0], search.kind)],
                           "determined": search.determined, **judged(parts, checks), "left_before": first.fit.left(),
                           "rms_difference_before": rms(first.fit.rest), "simulated": tried},
                   own_records=[{} for _ in parts],
                   found=[{"material": factored_material(part, search.kind, best.factor)} for part in parts],
                   lines=[f"{checks.name} {best.factor:.5g}, of {len(tried)} that were simulated",
                          f"rms of the differences before: {rms(first.fit.rest):.4g}, {100 * first.fit.left():.3g} % of the "
                          "measurement"],
                   silent=[] if search.determined else [checks.name])


def judged(parts, checks):
    """What is left, and what the user should know."""
    return {"left_of_measurement": checks.fit.left(),
            "warnings": [text for part in parts if (text := part.warning())] + checks.warnings()}


def vanishing_record(found):
    """What was found, in degrees C, and what the constant strain leaves of the differences."""
    return {"vanishing": found.temperature, "verdict": found.verdict, "rms_difference_constant": rms(found.constant.rest)}


def heat_record(part, own, factors):
    """The hottest layer of a part, and its own factors with the constant strain, None if it tells none."""
    return {"highest_interpass": max(part.interpass), "own_strain_scale": None if own is None else (factors @ own).tolist()}


def rounded(scale):
    return [round(float(factor), 6) for factor in scale]


def vanishing_lines(record, difference, records):
    """Also how hot the parts are, and each one's own factors."""
    is_constant = record["vanishing"] == CONSTANT
    yield f"vanishing {'none: ' if is_constant else format(record['vanishing'], '.5g') + ' degrees C: '}{record['verdict']}"
    if not is_constant:
        yield f"rms of the differences {difference:.4g}, with the constant strain {record['rms_difference_constant']:.4g}"
    for number, its in enumerate(records, start=1):
        own = "not determined" if its["own_strain_scale"] is None else f"strain_scale {rounded(its['own_strain_scale'])}"
        yield (f"part {number}: highest interpass {its['highest_interpass']:.4g} degrees C; "
               f"for itself, with a constant strain: {own}")


def warn_of_temperatures_alike(records):
    """Where the parts are about as hot, so that they hardly tell the strain from the heat."""
    spread = np.ptp([its["highest_interpass"] for its in records])
    if spread < WANTED_DIFFERENCE:
        warn(COMMAND, f"the highest interpass temperatures of the parts differ by {spread:.4g} degrees C only; parts that differ "
                      f"by {WANTED_DIFFERENCE:g} or more tell the strain from the heat better")


def main(words):
    parser = parser_of(__doc__, COMMAND)
    parser.add_argument("built", help="the folder of a run, or a config")
    parser.add_argument("measured", help="displacements of points (CSV), or points of a scan (CSV, TXT, XYZ, ASC, PLY, OBJ, STL)")
    parser.add_argument("more", nargs="*", metavar="BUILT MEASURED", help="further parts of the same material")
    parser.add_argument("--output", required=True)
    parser.add_argument("--released", action="store_true",
                        help="what was measured is the part after its release from plate or clamps")
    parser.add_argument("--rigid", action="store_true",
                        help="the points were measured in a frame of their own: rigid motions do not count")
    parser.add_argument("--isotropic", action="store_true", help="one factor for all axes")
    parser.add_argument("--factor", choices=KINDS,
                        help="with plastic flow: what the one factor is on (default: elongation)")
    parser.add_argument("--vanishing", action="store_true",
                        help="also fit thermal.vanishing, to two or more parts built with different pauses")
    parser.add_argument("--tolerance", type=positive, metavar="LENGTH",
                        help="how far from part or drawing a point may lie (default: one element, of a scan three)")
    parser.add_argument("--unit", help="of lengths in MEASURED that name none (default: the config's)")
    parser.add_argument("--program", default=PROGRAM)
    parser.add_argument("--ranks", type=count, default=1)
    calibrate(parse(parser, words))
