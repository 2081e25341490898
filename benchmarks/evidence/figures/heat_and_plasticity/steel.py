# SPDX-License-Identifier: MIT
"""Carbon steel as it gets hot: curves of EN 1993-1-2, with floors where the standard goes to zero.

Units: mm, s, W, J, kg, MPa, degrees C. Curves are those of the standard for 20 to 1200 degrees C; above, and
where a comment says so, values are approximate.
"""

import numpy as np

SOLIDUS = 1450.0   # approximate: configs/materials/ER70S-6.json
DENSITY = 7.85e-6
POISSON = 0.3
YOUNG, YIELD = 210e3, 400.0       # at 20 degrees C; yield: least of the weld metal, AWS A5.18
FLOOR = 0.01                      # of modulus and yield stress: the standard says 0 at 1200 degrees C
PEAK = 1000.0                     # J/(kg K), approximate: the standard's peak of 5000 is 10 K wide
HARDENING = 100.0                 # MPa at a plastic strain of 1 when cold: small, so that melting has little to undo
CUT_OFF = 1150.0                  # of fabseq's thermal strain; chosen on arm and wall

HEAT_POINTS = [20, 100, 200, 300, 400, 500, 600, 700, 760, 800, 900, 1200, 1600]   # of both programs

# EN 1993-1-2, table 3.1: temperature, factor of the effective yield strength, factor of the modulus.
REDUCTION = np.array([[20, 1, 1], [100, 1, 1], [200, 1, 0.9], [300, 1, 0.8], [400, 1, 0.7], [500, 0.78, 0.6],
                      [600, 0.47, 0.31], [700, 0.23, 0.13], [800, 0.11, 0.09], [900, 0.06, 0.0675],
                      [1000, 0.04, 0.045], [1100, 0.02, 0.0225], [1200, 0, 0]], dtype=float)


def elongation(temperature):
    """Thermal elongation from 20 degrees C, EN 1993-1-2, 3.4.1.1; the last branch goes on above 1200."""
    if temperature < 750:
        return 1.2e-5 * temperature + 0.4e-8 * temperature**2 - 2.416e-4
    return 1.1e-2 if temperature <= 860 else 2e-5 * temperature - 6.2e-3


def conductivity(temperature):
    """W/(mm K), EN 1993-1-2, 3.4.1.3."""
    return 1e-3 * (54.0 - 3.33e-2 * temperature if temperature < 800 else 27.3)


def heat_capacity(temperature):
    """J/(kg K), EN 1993-1-2, 3.4.1.2, its peak at 735 degrees C cut off at PEAK."""
    t = temperature
    if t < 600:
        return 425 + 0.773 * t - 1.69e-3 * t**2 + 2.22e-6 * t**3
    if t < 735:
        return min(666 + 13002 / (738 - t), PEAK)
    return min(545 + 17820 / (t - 731), PEAK) if t < 900 else 650.0


def thermal_lines():
    """*CONDUCTIVITY, *SPECIFIC HEAT and *DENSITY of a material for a deck."""
    yield "*CONDUCTIVITY"
    yield from (f"{conductivity(t):.6g}, {t}." for t in HEAT_POINTS)
    yield "*SPECIFIC HEAT"
    yield from (f"{heat_capacity(t):.6g}, {t}." for t in HEAT_POINTS)
    yield f"*DENSITY\n{DENSITY:g}"


def reduction_rows():
    """Temperature, factor of the yield stress and factor of the modulus, not below the floor."""
    rows = [(t, max(strength, FLOOR), max(stiffness, FLOOR)) for t, strength, stiffness in REDUCTION]
    return [*rows, (SOLIDUS + 200, FLOOR, FLOOR)]


def flow_material(cut_off=CUT_OFF):
    """The keys of fabseq's `material` for the same steel with plastic flow."""
    bends = (750, 860)  # of the elongation
    temperatures = sorted({*bends, *(float(t) for t, _, _ in reduction_rows()), *map(float, HEAT_POINTS)})
    strengths, stiffnesses = (np.interp(temperatures, *zip(*((row[0], row[column]) for row in reduction_rows())))
                              for column in (1, 2))
    conduction, storage = (np.interp(temperatures, HEAT_POINTS, [of(t) / of(20) for t in HEAT_POINTS])
                           for of in (conductivity, heat_capacity))
    return {"young": YOUNG, "poisson": POISSON, "yield_stress": YIELD, "hardening": HARDENING, "cut_off": cut_off,
            "temperatures": temperatures, "yield_factors": strengths.tolist(), "young_factors": stiffnesses.tolist(),
            "elongations": [elongation(t) for t in temperatures], "conductivity": conductivity(20),
            "heat_capacity": heat_capacity(20), "conductivity_factors": conduction.tolist(),
            "heat_capacity_factors": storage.tolist()}


def mechanical_lines():
    """*ELASTIC, *PLASTIC and *EXPANSION of a material for a deck."""
    rows = reduction_rows()
    yield "*ELASTIC"
    yield from (f"{YOUNG * stiffness:.6g}, {POISSON}, {t:g}." for t, _, stiffness in rows)
    yield "*PLASTIC"
    for t, strength, _ in rows:
        yield f"{YIELD * strength:.6g}, 0., {t:g}."
        yield f"{YIELD * strength + HARDENING * strength:.6g}, 1., {t:g}."
    yield "*EXPANSION, ZERO=20."
    temperatures = [21, 100, 200, 400, 600, 749, 800, 860, 900, 1000, 1200, 1400, 1600]
    yield from (f"{elongation(t) / (t - 20):.6g}, {t:g}." for t in temperatures)
