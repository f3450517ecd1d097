"""mean_map MOTOR: from which frequency ratio on which mean of the dq current is enough, by `iqfoc sweep --map`.

    <!-- figures: mean_map data/motors/jarzebowicz2019.toml -->
"""

from .markdown import table

METHODS = {"mid_point": "mid-point sample", "linear": "linear correction", "quasi_discrete": "quasi-discrete mean",
           "modulated": "mean under modulation"}
LIMITS_PERCENT = (1, 0.3, 0.1, 0.05)


def first_ratio(points, method, limit):
    """The least ratio from which on the error is within the limit at every modulation index; None if there is none."""
    ratios = sorted({point["sffr"] for point in points}, reverse=True)
    first = None
    for ratio in ratios:
        if any(point[method] > limit for point in points if point["sffr"] == ratio):
            break
        first = ratio
    return first


def generate(program, arguments):
    if len(arguments) != 1:
        raise ValueError(f"expected a motor file, got {arguments}")
    points = program.json("sweep", "--map", "--motor", arguments[0])["points"]
    heads = ["error within, % of rated", "load, %", *METHODS.values()]
    rows = []
    for limit in LIMITS_PERCENT:
        for load in sorted({point["load"] for point in points}):
            loaded = [point for point in points if point["load"] == load]
            first = [first_ratio(loaded, method, limit) for method in METHODS]
            rows.append([f"{limit:g}", f"{100 * load:g}", *("-" if ratio is None else f"{ratio:.3g}" for ratio in first)])
    return table(heads, rows, right=heads)
