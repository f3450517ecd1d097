"""Compares diagnoses with the truth: rates, interval coverage, gain against the oracle, and the thresholds."""

import math
from fractions import Fraction

import numpy as np

import effects

# What the blind tests must reach; rates over recordings, gain as a share of the oracle's.
THRESHOLDS = {"single_exact": 0.95, "pair_exact": 0.85, "clean_without_cause": 0.99, "unknown_without_cause": 0.98,
              "coverage_low": 0.90, "coverage_high": 0.99, "gain_share": 0.80}
# What a release set must reach.
RELEASE_THRESHOLDS = {"single_exact": 0.97, "pair_exact": 0.90, "triple_exact": 0.75, "clean_without_cause": 0.99,
                      "unknown_without_cause": 0.99, "coverage_low": 0.93, "coverage_high": 0.98, "gain_share": 0.80}
# The rates over recordings, and the recordings that each is over.
RATES = {"single_exact": "single", "pair_exact": "pair", "triple_exact": "triple", "clean_without_cause": "clean",
         "unknown_without_cause": "unknown"}
GROUPS = ("clean", "single", "pair", "triple", "unknown")


def judge(truth, diagnosis):
    """One recording: what was hidden, what was named, which parameters lie in their intervals."""
    hidden = [e["id"] for e in truth["effects"] if e["known"]]
    unknown = [e["id"] for e in truth["effects"] if not e["known"]]
    named = [c["id"] for c in diagnosis["causes"]]
    result = {"seed": truth["seed"], "kind": truth["kind"], "plant": truth["plant"], "hidden": hidden,
              "unknown": unknown, "named": named, "verdict": diagnosis["verdict"],
              "exact": sorted(hidden) == sorted(named),
              "share": {e["id"]: e["share_of_floor"] for e in truth["effects"]}, "parameters": [],
              "confused_with": {c["id"]: c.get("confused_with", []) for c in diagnosis["causes"]}}
    found = {c["id"]: {p["name"]: p for p in c["parameters"]} for c in diagnosis["causes"]}
    for effect in truth["effects"]:
        for parameter in effect["parameters"]:
            if not parameter["compare"] or effect["id"] not in found or not result["exact"]:
                continue
            fit = found[effect["id"]].get(parameter["name"])
            inside = fit is not None and fit["ci95"][0] <= parameter["value"] <= fit["ci95"][1]
            # Whole orders and cycles are found or not, without an interval to cover.
            whole = parameter["name"] in ("order", "cycles") or effect["id"] == "sensor_fault"
            counted = not whole or parameter["value"] % 1.0 != 0.0
            result["parameters"].append({
                "id": effect["id"], "name": parameter["name"], "true": parameter["value"], "inside": inside,
                "counted": counted, "fit": None if fit is None else fit["value"],
                "ci95": None if fit is None else fit["ci95"]})
    if hidden and not unknown and "gain" in truth["oracle"]:
        result["gain"] = diagnosis["error"]["gain"]
        result["oracle_gain"] = truth["oracle"]["gain"]
    result["estimates"] = judge_estimates(truth, diagnosis) if result["exact"] and not unknown else []
    result["floor_ratio"] = diagnosis["error"]["noise_floor"] / truth["oracle"]["floor_percent"]
    return result


# What an effect makes of a value of [motor]: no longer one number, or one that is shared with the effect's own.
NO_ONE_VALUE = {"saturation": ("L_d", "L_q"), "saturation_dq": ("L_d", "L_q"), "phase_inductance": ("L_d", "L_q"),
                "phase_asymmetry": ("R",), "emf_harmonics": (), "temperature": ("R", "psi_f")}


def judge_estimates(truth, diagnosis):
    """The values that a diagnosis gives whether or not it names them, against the true motor."""
    true = {"R": "R_ohm", "L_d": "L_d_H", "L_q": "L_q_H", "psi_f": "psi_f_Wb"}
    for effect in truth["effects"]:
        for name in NO_ONE_VALUE.get(effect["id"], ()):
            true.pop(name, None)
    out = []
    for given in diagnosis.get("estimates") or []:
        if given["name"] in true and given.get("excited", True) and given.get("ci95"):
            value = truth["motor_file_should_say"][true[given["name"]]]
            out.append({"name": given["name"], "true": value, "ci95": given["ci95"],
                        "inside": given["ci95"][0] <= value <= given["ci95"][1]})
    return out


def group_of(result):
    if result["unknown"]:
        return "unknown"
    return ("clean", "single", "pair", "triple")[min(len(result["hidden"]), 3)]


def rate(hits):
    return float(np.mean(hits)) if len(hits) else None


def summary(results):
    """All rates over a list of judged recordings; None where there is nothing to count."""
    groups = {g: [r for r in results if group_of(r) == g] for g in GROUPS}
    parameters = [p for r in results for p in r["parameters"] if p["counted"]]
    shares = [min(1.0, r["gain"] / r["oracle_gain"]) for r in results if "gain" in r]
    estimates = [e["inside"] for r in results for e in r["estimates"]]
    per_parameter = {}
    for p in parameters:
        per_parameter.setdefault(f"{p['id']}.{p['name']}", []).append(p["inside"])
    return {
        "recordings": {g: len(rows) for g, rows in groups.items()},
        "by_plant": {p: sum(r["plant"] == p for r in results) for p in ("main", "second")},
        "single_exact": rate([r["exact"] for r in groups["single"]]),
        "pair_exact": rate([r["exact"] for r in groups["pair"]]),
        "triple_exact": rate([r["exact"] for r in groups["triple"]]),
        "clean_without_cause": rate([not r["named"] for r in groups["clean"]]),
        "clean_verdict_clean": rate([r["verdict"] == "clean" for r in groups["clean"]]),
        "unknown_without_cause": rate([not r["named"] for r in groups["unknown"]]),
        "coverage": rate([p["inside"] for p in parameters]), "parameters_counted": len(parameters),
        "estimates_coverage": rate(estimates), "estimates_counted": len(estimates),
        "coverage_of": {name: [int(sum(x)), len(x)] for name, x in sorted(per_parameter.items())},
        "gain_share": rate(shares),
        "gain_share_lowest_tenth": float(np.quantile(shares, 0.1)) if shares else None,
        "floor_ratio_median": float(np.median([r["floor_ratio"] for r in results])) if results else None,
        "seconds": {name: times([r[name] for r in results if name in r]) for name in ("clock_s", "cpu_s")}}


def times(seconds):
    """How long a diagnosis takes: median, all but one in twenty, slowest."""
    return [round(float(np.quantile(seconds, q)), 2) for q in (0.5, 0.95, 1.0)] if seconds else None


def confidence(hits, count):
    """The exact (Clopper and Pearson) 95 % interval of a rate: `hits` of `count` recordings."""
    from scipy.stats import beta  # not needed by the quick set

    low = 0.0 if hits == 0 else float(beta.ppf(0.025, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(0.975, hits + 1, count - hits))
    return low, high


def misses_allowed(count, threshold):
    """The most misses among `count` at which the rate still reaches the threshold as it is written, in decimals.

    Exact: at least 99 % of 50 is all 50. A set too small to show a rate below one allows no miss.
    """
    return math.floor((1 - Fraction(repr(threshold))) * count)


def below_threshold(s, full, thresholds=None):
    """Sentences about what is missed; empty when all is reached. Coverage's upper bound counts in the full set only."""
    problems, asked = [], thresholds or THRESHOLDS
    for name, group in RATES.items():
        count = s["recordings"][group]
        if not count or name not in asked:
            continue
        missed = round((1.0 - s[name]) * count)
        if missed > misses_allowed(count, asked[name]):
            problems.append(f"{name}: {missed} of {count} missed, {misses_allowed(count, asked[name])} allowed")
    if s["coverage"] is not None:
        n = s["parameters_counted"]
        # The bounds are for the long run: a finite count scatters about its rate by two standard deviations.
        slack = 2.0 * np.sqrt(0.9 * 0.1 / n)
        if s["coverage"] < asked["coverage_low"] - (0.0 if full else slack):
            problems.append(f"coverage: {s['coverage']:.3f} of {n} intervals hold the truth, below {asked['coverage_low']}")
        if full and s["coverage"] > asked["coverage_high"]:
            problems.append(f"coverage: {s['coverage']:.3f} of {n} intervals hold the truth, above {asked['coverage_high']}: "
                            "too wide")
    if s["gain_share"] is not None and s["gain_share"] < asked["gain_share"]:
        problems.append(f"gain: {s['gain_share']:.2f} of the oracle's, below {asked['gain_share']}")
    return problems


def causes_met(results):
    """The columns of the tables: all causes that are drawn, and of the later ones those that occur."""
    met = {c for r in results for c in r["hidden"] + r["named"]}
    return effects.CAUSES + [c for c in effects.LATER if c in met]


def confusion(results):
    """rows: what was hidden (one effect, nothing, or an unknown one); per row the share naming each cause, or none."""
    rows = {}
    for r in results:
        if group_of(r) in ("pair", "triple"):
            continue
        label = r["hidden"][0] if r["hidden"] else (r["unknown"][0] if r["unknown"] else "clean")
        rows.setdefault(label, []).append(r["named"])
    names = causes_met(results) + ["none"]
    order = [x for x in dict.fromkeys(effects.KNOWN + ["clean"] + effects.UNKNOWN + effects.UNNAMED + effects.STRANGERS) if x in rows]
    matrix = [[float(np.mean([(c in named) if c != "none" else not named for named in rows[row]])) for c in names]
              for row in order]
    return order, names, matrix, [len(rows[row]) for row in order]


def pair_table(results):
    """Per cause over the pairs: how often it was hidden, found, and named though not hidden."""
    table = {c: [0, 0, 0] for c in causes_met(results)}
    for r in results:
        if group_of(r) != "pair":
            continue
        for c in r["hidden"]:
            table[c][0] += 1
            table[c][1] += c in r["named"]
        for c in r["named"]:
            table[c][2] += c not in r["hidden"]
    return table
