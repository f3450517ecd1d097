"""plan WHAT MOTOR SCENARIO: tables of `iqfoc plan --against`.

    <!-- figures: plan comparison data/motors/compressor_salient.toml data/scenarios/identification.toml -->
    <!-- figures: plan limits data/motors/compressor_salient.toml data/scenarios/identification.toml -->
    <!-- figures: plan runs data/motors/compressor_salient.toml data/scenarios/identification.toml -->
"""

from .markdown import table


def short(value):
    """Two digits: another machine may choose another of equal segments."""
    return "unknown" if value is None else f"{value:.2g}"


def comparison(result):
    plan, against = result["plan"], result["against"]
    heads = ["", "planned", "scenario"]
    rows = [["duration with settling, s", f"{plan['seconds']:.3g}", f"{against['seconds']:.3g}"],
            ["worst correlation", f"{plan['worst_correlation']:.2f}", f"{against['worst_correlation']:.2f}"],
            ["between", " and ".join(plan["worst_pair"]), " and ".join(against["worst_pair"])],
            ["median interval", short(plan["median_over_least"]), short(against["median_over_least"])]]
    for ours, theirs in zip(plan["parameters"], against["parameters"]):
        rows.append([ours["name"], short(ours["over_least"]), short(theirs["over_least"])])
    return table(heads, rows, right=heads[1:])


def limits(result):
    heads = ["cause", "planned", "closest alternative", "scenario", "closest alternative there"]
    theirs = {cause["cause"]: cause for cause in result["against"]["causes"]}
    rows = []
    for ours in result["plan"]["causes"]:
        other = theirs.get(ours["cause"], {"over_least": None, "rival": ""})
        rows.append([f"`{ours['cause']}`"]
                    + [text for cause in (ours, other)
                       for text in ("never" if cause["over_least"] is None else f"{cause['over_least']:.1f}",
                                    f"`{cause['rival']}`" if cause["rival"] else "-")])
    return table(heads, rows, right=["planned", "scenario"])


def runs(result):
    heads = ["cycles", "what", "rpm", "i_d, A", "i_q, A"]

    def course(pair, places):
        ends = [f"{value:.{places}f}" for value in pair]
        return ends[0] if ends[0] == ends[1] else " to ".join(ends)

    rows = [[run["cycles"], run["what"], course(run["rpm"], 0), course(run["i_d_A"], 2), course(run["i_q_A"], 2)] for run in result["runs"]]
    return table(heads, rows, right=["cycles", "rpm", "i_d, A", "i_q, A"])


PARTS = {"comparison": comparison, "limits": limits, "runs": runs}


def generate(program, arguments):
    if len(arguments) != 3 or arguments[0] not in PARTS:
        raise ValueError(f"expected one of {', '.join(sorted(PARTS))}, a motor file and a scenario, got {arguments}")
    what, motor, scenario = arguments
    return f"{PARTS[what](program.json('plan', '--motor', motor, '--against', scenario))}\n"
