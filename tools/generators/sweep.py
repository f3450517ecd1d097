"""sweep MOTOR RPM,RPM,... [OPTION VALUE]...: the errors of each method over speed, by `iqfoc sweep`.

    <!-- figures: sweep data/motors/jarzebowicz2019.toml 0,5000,8000 --id-ratio -0.7 -->
"""

from .markdown import number, table

METHODS = ("standard", "quasi_discrete", "exact")
LEAST = 1e-3


def percent(value):
    """An error in percent; below LEAST only the bound is given."""
    return number(value) if value >= LEAST else f"< {LEAST}"


def generate(program, arguments):
    if len(arguments) < 2 or len(arguments) % 2:
        raise ValueError(f"expected a motor file, speeds and pairs of option and value, got {arguments}")
    motor, speeds, *options = arguments
    points = program.json("sweep", "--motor", motor, "--rpm", speeds, *options)["points"]
    heads = ["rpm", "SFFR"]
    for quantity in ("mean", "prediction"):
        heads += [f"{quantity}, {method.replace('_', '-')}" for method in METHODS]
    heads.append("prediction, exact, firmware (IQ24)")
    cells = []
    for point in points:
        line = [f"{point['rpm']:g}", "-" if point["sffr"] is None else f"{point['sffr']:.3g}"]
        line += [percent(point[quantity][method]) for quantity in ("mean", "prediction") for method in METHODS]
        cells.append(line + [percent(point["iq24"]["prediction"]["exact"])])
    return f"{table(heads, cells, right=heads)}\n"
