"""commission FILE: the table of the study of self-commissioning.

    <!-- figures: commission tests/commission/study.json -->

The file is written by tests/commission/study.py, which takes too long for a check.
"""

import json

from .markdown import table

WORDS = {"R": "R", "v_dead": "v_dead", "L_d": "L_d", "L_q": "L_q", "psi": "psi_f", "o_a": "offset of A", "o_b": "offset of B", "o_c": "offset of C"}


def share(good, of):
    """Percent with the standard error of a binomial share."""
    if of == 0:
        return "-"
    p = (good + 1) / (of + 2)  # Laplace: an error also where all are good
    return f"{100 * good / of:.1f} +- {100 * (p * (1 - p) / of) ** 0.5:.1f}"


def generate(program, arguments):
    if len(arguments) != 1:
        raise ValueError(f"expected a file, got {arguments}")
    found = json.loads((program.root / arguments[0]).read_text(encoding="utf-8"))
    heads = ["result", "interval holds the truth, %", "median half width, %", "worst, half widths", "stated by the diagnosis", "overlap, %",
             "diagnosis holds the truth, %"]
    rows = [[WORDS[name], share(v["held"], v["drives"]), f"{100 * v['median_half']:.2f}", f"{v['worst']:.1f}", v["diagnosed"],
             share(v["overlap"], v["diagnosed"]), share(v["diagnosis_right"], v["diagnosed"])] for name, v in found["values"].items()]
    machine = [found["values"][name] for name in ("R", "v_dead", "L_d", "L_q", "psi")]
    apart = sum(v["diagnosed"] - v["overlap"] for v in machine)
    held, right = (sum(v[name] for v in machine) for name in ("apart_held", "apart_diagnosis_right"))
    return (f"{found['drives']} drives, {found['done']} ended with all results; the median run has {found['cycles']:.0f} cycles. "
            f"The highest phase current was {found['highest']:.2f} times `i_align`. {found['compared']} of the runs were diagnosed, too. "
            "Simulated; errors are standard errors.\n\n" + table(heads, rows, right=heads[1:])
            + f"\n\nOf R, v_dead, L_d, L_q and psi_f, {apart} pairs do not overlap. The commissioning's interval holds the truth in {held} of them, "
            f"the diagnosis' in {right}.\n")
