"""induction: the table of `iqfoc sweep --induction`.

    <!-- figures: induction -->
"""

from .markdown import number, table

METHODS = ("standard", "quasi_discrete", "exact")
LEAST = 1e-3


def generate(program, arguments):
    if arguments:
        raise ValueError(f"expected no arguments, got {arguments}")
    points = program.json("sweep", "--induction")["points"]
    heads = ["stator, Hz", "SFFR", "rotor flux, Wb", "slip, Hz", "modulation index"]
    heads += [f"{quantity}, {method.replace('_', '-')}" for quantity in ("mean", "prediction") for method in METHODS]
    heads[8:8] = ["mean, with ripple (IQ24)"]
    heads.append("prediction, with ripple (IQ24)")
    rows = []
    for point in points:
        row = [f"{point['f_stator_Hz']:.3g}", f"{point['sffr']:.3g}", f"{point['psi_Wb']:.3g}", f"{point['slip_Hz']:.2g}",
               f"{point['modulation_index']:.2f}"]
        for quantity in ("mean", "prediction"):
            row += [number(point[quantity][method]) for method in METHODS]
            ripple = point["iq24"][f"{quantity}_with_ripple"]
            row.append(number(ripple) if ripple >= LEAST else f"< {LEAST}")
        rows.append(row)
    return table(heads, rows, right=heads)
