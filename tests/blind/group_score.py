"""Judges diagnoses of the groups (groups.py): right, partly, missed or false, and how far probabilities and intervals are to be trusted.

    right    every cause that dominates is named, each value lies in its interval, and no name is false
    partly   some of them are named, or all with a value outside its interval
    missed   none is named
    false    a cause is named that the drive does not have

A small effect that is named is no false name: the drive has it. Where several values are asked for at once, their intervals are as
much wider as keeps 95 % for all together (Bonferroni).
"""

from statistics import NormalDist

import numpy as np

import score

# Ids that contain one another: if a drive has one of them, none of these is a false name.
FAMILIES = [{"inductance", "saliency", "saturation", "saturation_dq"}, {"resistance", "temperature"}]
# Other names that hold a cause whole, without values that could be compared.
ALSO = {"saturation": {"saturation_dq"}}
# A cause that is this far from all other explanations (groups.separation) can be distinguished from them.
SEPARABLE = 6.0
# An effect outside the catalogue shows from an error of so many noise floors on, and these in the sum of the currents.
VISIBLE = 1.25
IN_THE_SUM = ("common_hum", "crosstalk")
BINS = [0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999, 1.0]
# What is asked of a group of at least LEAST recordings: the least share that is right, the largest that has a false cause.
LEAST = 100
ASKED = {"bench": (0.8, 1.0), "bench_half": (0.9, 1.0), "steady": (0.0, 0.01), "ramp": (0.0, 0.01), "outside": (0.0, 0.01)}
OPEN_LOOP = 0.8  # of the oracle's reduction, in the mean over a group of benches
OUTCOMES = ["right", "partly", "held back", "missed", "false"]


def is_real(name, real):
    """Whether a drive with the effects `real` has what is named."""
    return name in real or any(name in family and family & set(real) for family in FAMILIES)


def compared(effect, named):
    """The values of one hidden effect that can be compared, with the fitted ones."""
    out = []
    for p in effect["parameters"]:
        if not p["compare"] or p["name"] in ("order", "cycles", "phase"):
            continue
        fit = named.get(p["name"])
        low = min(p.get("low", p["value"]), p["value"])
        high = max(p.get("low", p["value"]), p["value"])
        if fit is None or fit.get("ci95") is None:
            out.append({"id": effect["id"], "name": p["name"], "true": p["value"], "fit": None, "ci95": None, "off": np.inf})
            continue
        value, (a, b) = fit["value"], fit["ci95"]
        # How far the truth is, in half-widths of the interval on its side.
        if value < low:
            off = (low - value) / max(b - value, 1e-300)
        elif value > high:
            off = (value - high) / max(value - a, 1e-300)
        else:
            off = 0.0
        out.append({"id": effect["id"], "name": p["name"], "true": p["value"], "fit": value, "ci95": [a, b], "off": float(off)})
    return out


def share(found, best):
    """A reduction of the error as a share of the oracle's, one at most."""
    return None if found is None or best is None else float(min(1.0, found / best))


def reduction(before, after):
    return None if not before or not after else before / after


def probabilities(truth, diagnosis):
    """(probability, whether the drive has it) of each named cause."""
    real = [e["id"] for e in truth["effects"] if e["known"]]
    return [(c["probability"], is_real(c["id"], real)) for c in diagnosis["causes"] if c.get("probability") is not None]


def judge(truth, diagnosis):
    """One recording of a group."""
    real = [e["id"] for e in truth["effects"] if e["known"]]
    large = [e["id"] for e in truth["effects"] if e["known"] and e.get("dominates", True)]
    outside = [e["id"] for e in truth["effects"] if not e["known"]]
    causes = diagnosis["causes"]
    named = [c["id"] for c in causes]
    values = {c["id"]: {p["name"]: p for p in c["parameters"]} for c in (diagnosis.get("minor") or []) + causes}
    wrong = sorted({n for n in named if not is_real(n, real)})
    held = [x for x in large if x in named or ALSO.get(x, set()) & set(named)]
    parameters = [p for e in truth["effects"] if e["known"] and e["id"] in values for p in compared(e, values[e["id"]])]
    asked = [p for p in parameters if p["id"] in large]
    stretch = NormalDist().inv_cdf(1.0 - 0.025 / max(len(asked), 1)) / NormalDist().inv_cdf(0.975)
    candidates = [sorted(c if isinstance(c, str) else c["id"] for c in one["causes"]) for one in diagnosis.get("candidates") or []]
    could_not = truth.get("separation") is not None and truth["separation"] < SEPARABLE
    invisible = bool(diagnosis.get("not_visible"))
    if wrong:
        outcome = "false"
    elif outside:
        outcome = "right" if diagnosis["verdict"] in ("unexplained", "partly") or not shows(truth, diagnosis) else "missed"
    elif len(held) == len(large) and all(p["off"] <= stretch for p in asked):
        outcome = "right"
    elif held:
        outcome = "partly"
    elif any(set(c) >= set(large) for c in candidates) or (could_not and (invisible or diagnosis["verdict"] != "clean")):
        outcome = "right" if could_not else "held back"
    else:
        outcome = "missed"
    o, e = truth["oracle"], diagnosis["error"]
    return {"seed": truth["seed"], "kind": truth["kind"], "group": truth["group"], "plant": truth["plant"], "hidden": large,
            "small": [x for x in real if x not in large], "outside": outside, "named": named, "false": wrong,
            "named_small": [n for n in named if n not in large and n not in wrong], "verdict": diagnosis["verdict"], "outcome": outcome,
            "by_names": not wrong and len(held) == len(large), "candidates": candidates, "not_visible": invisible,
            "separable": None if truth.get("separation") is None else not could_not, "parameters": parameters,
            "probability": probabilities(truth, diagnosis),
            "one_cycle": share(reduction(e["nominal"], e["extended"]), reduction(o.get("nominal_percent"), o.get("true_percent"))),
            "open_loop": share(reduction(e.get("free_run_nominal"), e.get("free_run_extended")),
                               reduction(o.get("open_loop_nominal_percent"), o.get("open_loop_true_percent"))),
            "estimates": score.judge_estimates(truth, diagnosis)}


def shows(truth, diagnosis):
    """Whether an effect outside the catalogue shows: in the one-cycle error, or in the sum of the currents."""
    o = truth["oracle"]
    return o.get("nominal_percent", diagnosis["error"]["nominal"]) > VISIBLE * o["floor_percent"] or any(e["id"] in IN_THE_SUM for e in truth["effects"])


def reliability(results):
    """Rows of (from, to, how many, mean probability, share that is real) over all named causes."""
    said = [pair for r in results for pair in r["probability"]]
    out = []
    for low, high in zip(BINS[:-1], BINS[1:]):
        inside = [(p, real) for p, real in said if low <= p < high or (high == 1.0 and p == 1.0)]
        if inside:
            out.append((low, high, len(inside), float(np.mean([p for p, _ in inside])), float(np.mean([real for _, real in inside]))))
    return out


def middle(values):
    return None if not values else round(float(np.median(values)), 3)


def summary(results):
    """Counts and rates over the judged recordings of one group."""
    def covered(of):
        rows = [p for r in results if r["verdict"] in of for p in r["parameters"] if p["fit"] is not None]
        return [sum(p["off"] <= 1.0 for p in rows), len(rows)]

    def estimates(of):
        rows = [e["inside"] for r in results if r["verdict"] in of for e in r["estimates"]]
        return [sum(rows), len(rows)]
    open_loop = [r["open_loop"] for r in results if r["open_loop"] is not None and (r["hidden"] or r["small"])]
    one_cycle = [r["one_cycle"] for r in results if r["one_cycle"] is not None and (r["hidden"] or r["small"])]
    return {
        "recordings": len(results), "outcomes": {o: sum(r["outcome"] == o for r in results) for o in OUTCOMES},
        "right_by_names": sum(r["by_names"] for r in results), "small_named_as_causes": sum(len(r["named_small"]) for r in results),
        "without_a_cause": [sum(not r["named"] for r in results if not r["hidden"]), sum(not r["hidden"] for r in results)],
        "intervals": {"clean or explained": covered(("clean", "explained")), "partly or unexplained": covered(("partly", "unexplained"))},
        "estimates": {"clean or explained": estimates(("clean", "explained")),
                      "partly or unexplained": estimates(("partly", "unexplained"))},
        "open_loop_share": {"median": middle(open_loop), "mean": round(float(np.mean(open_loop)), 3) if open_loop else None,
                            "0.8 or more": [sum(x >= 0.8 for x in open_loop), len(open_loop)]},
        "one_cycle_share": {"median": middle(one_cycle), "0.8 or more": [sum(x >= 0.8 for x in one_cycle), len(one_cycle)]},
        "reliability": reliability(results)}


def below_asked(results):
    """Sentences about what a group misses; empty when all is reached."""
    group, n, problems = results[0]["group"], len(results), []
    right, false = (sum(r["outcome"] == o for r in results) for o in ("right", "false"))
    least, most = ASKED[group]
    if right < least * n:
        problems.append(f"{group}: {right} of {n} right, below {100.0 * least:.0f} %")
    if false > most * n:
        problems.append(f"{group}: {false} of {n} with a false cause, above {100.0 * most:.0f} %")
    mean = summary(results)["open_loop_share"]["mean"]
    if group.startswith("bench") and mean is not None and mean < OPEN_LOOP:
        problems.append(f"{group}: {mean:.2f} of the oracle's open-loop reduction, below {OPEN_LOOP}")
    return problems


def report(results, failures):
    """Lines to print: what is not right, then counts."""
    lines = []
    for r in results:
        if r["outcome"] != "right":
            values = ", ".join(f"{p['id']}.{p['name']} true {p['true']:.4g} fit {p['fit'] if p['fit'] is None else format(p['fit'], '.4g')} "
                               f"off {p['off']:.2g}" for p in r["parameters"] if p["id"] in r["hidden"] and p["off"] > 1.0)
            lines.append(f"{r['outcome']}: seed {r['seed']} {r['plant']}: hidden {'+'.join(r['hidden'] + r['outside']) or 'nothing'}, named "
                         f"{'+'.join(r['named']) or 'nothing'} ({r['verdict']}), open loop "
                         f"{'-' if r['open_loop'] is None else format(r['open_loop'], '.2f')}" + (f"; {values}" if values else ""))
    lines += [f"failed: seed {case.seed} {case.kind} {case.plant}: {words}" for case, words in failures]
    for name, value in summary(results).items():
        if name == "reliability":
            lines += [f"probability {low} to {high}: {n} named, mean {said:.4f}, real {real:.4f}" for low, high, n, said, real in value]
        else:
            lines.append(f"{name}: {value}")
    return lines
