"""thresholds: the reporting threshold of each cause, from sim_host/data/causes.def.

    <!-- figures: thresholds -->

A cause with several hypotheses has the smallest of their thresholds; a drift of its values has one of its own.
"""

import re

from .markdown import number, table

CATALOGUE = "sim_host/data/causes.def"
COMMENT = re.compile(r"/\*.*?\*/", re.S)
HYPOTHESIS = re.compile(r"^HYPOTHESIS\(\w+, (\w+),(.*?)\)\n(?=[A-Z\n]|$)", re.M | re.S)
CAUSE = re.compile(r'^CAUSE(?:_MORE)?\((\w+),(?: \w+,)? "(\w+)"', re.M)

# What a threshold of 1 is in the catalogue, in the unit that the page shows.
UNITS = {
    "resistance": (100, "% of R"),
    "inductance": (100, "% of L"),
    "flux_linkage": (100, "% of psi_f"),
    "saliency": (100, "% between L_d and L_q"),
    "saturation": (100, "% fall of L at the rated peak current"),
    "saturation_dq": (100, "% of the flux at the rated peak current, root of the sum of squares of all terms"),
    "dead_time": (1, "% of the DC link"),
    "voltage_gain": (100, "% of the voltage"),
    "current_offset": (100, "% of the rated peak current"),
    "current_gain": (100, "% between the sensors"),
    "angle_offset": (1000, "mrad"),
    "angle_harmonic": (1000, "mrad"),
    "angle_delay": (1, "cycles"),
    "voltage_delay": (1, "cycles beyond a whole number"),
    "sensor_lag": (1, "cycles"),
    "emf_harmonics": (100, "% of psi_f"),
    "phase_asymmetry": (100, "% of R"),
    "phase_inductance": (100, "% of L"),
    "temperature": (1, "% per kelvin"),
    "iron_loss": (1, "% of the rated peak current at the recorded voltages"),
}


def read(text):
    """{cause's id: (least of its values, least of its drift or None)} of the catalogue's text."""
    text = COMMENT.sub("", text)
    ids = dict(CAUSE.findall(text))
    found = {}
    for cause, row in HYPOTHESIS.findall(text):
        least = re.search(r"\.least = ([\d.]+)", row)
        if cause in ids and least:
            drifts = "SIZE_RATES" in row
            before = found.setdefault(ids[cause], [None, None])
            value = float(least[1])
            before[drifts] = value if before[drifts] is None else min(before[drifts], value)
    return found


def generate(program, arguments):
    if arguments:
        raise ValueError(f"expected no arguments, got {arguments}")
    rows = []
    for cause, (value, drift) in read((program.root / CATALOGUE).read_text(encoding="utf-8")).items():
        scale, unit = UNITS[cause]
        rows.append([f"`{cause}`", number(scale * value), "-" if drift is None else number(scale * drift), unit])
    return table(["cause", "threshold", "of a drift", "unit"], rows, right=["threshold", "of a drift"])
