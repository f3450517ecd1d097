"""Detection limits: for each cause, the size that is found, and found alone, in 95 % of cases.

For each seed the size is bisected (on a logarithmic scale) between "largest plausible" and 1/300 of it; the limit of
the cause is the 95th percentile over the seeds of the smallest size found. With --any-size the reporting threshold
(`least` of sim_host/data/causes.def) is zero: what the recordings allow.
"""

import json
import os
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import draw
import effects
import figure
import generate
import main_plant
import run as blind

STEPS = 5  # of bisection: the limit is known to a factor of 300^(1/32) = 1.2
SPAN = 300.0


def found(seed, cause, size, plant, iqfoc, more):
    """Whether exactly this cause is named, and the effect's share of the noise floor."""
    with tempfile.TemporaryDirectory(prefix="limit-") as folder:
        if plant == "second":
            generate.write(draw.draw(seed, cause, [size]), folder)
        else:
            main_plant.make(seed, cause, folder, iqfoc, [size])
        diagnosis = blind.diagnose(folder, iqfoc, more=more)
        with open(os.path.join(folder, "truth.json"), encoding="utf-8") as file:
            effect = json.load(file)["effects"][0]
    return [c["id"] for c in diagnosis["causes"]] == [effects.cause_of(cause)], effect["share_of_floor"]


def limit_of(work):
    """Smallest size found for one seed, with its share; None when not even the largest is."""
    seed, cause, plant, iqfoc, more = work
    high = effects.RANGE[cause][1]
    hit, share = found(seed, cause, high, plant, iqfoc, more)
    if not hit:
        return None
    low, best = high / SPAN, (high, share)
    for _ in range(STEPS):
        middle = float(np.sqrt(low * best[0]))
        hit, share = found(seed, cause, middle, plant, iqfoc, more)
        if hit:
            best = (middle, share)
        else:
            low = middle
    return best


UNIT = {"resistance": "of R", "inductance": "of L", "flux_linkage": "of psi_f", "saliency": "of L",
        "saturation": "(rated peak / I_sat)^2", "dead_time": "of a cycle", "voltage_gain": "of 1",
        "current_offset": "of rated peak", "current_gain": "of 1", "angle_offset": "rad", "angle_harmonic": "rad",
        "angle_delay": "of a cycle", "emf_harmonics": "of psi_f", "phase_asymmetry": "of R",
        "phase_inductance": "of L", "resistance_drift": "of R", "flux_linkage_drift": "of psi_f",
        "current_offset_drift": "of rated peak", "current_gain_drift": "of 1", "emf_harmonics_high": "of psi_f", "angle_harmonic_electrical": "rad", "temperature": "K",
        "sensor_lag": "of a cycle", "speed_lag": "of a cycle", "dc_link_ripple": "of the link", "sensor_fault": "of the samples",
        "glitch": "of the cycles"}


def run(args):
    # A voltage is late by a whole cycle or not at all: there is no size to bisect.
    causes = [c for c in args.causes.split(",") if c not in effects.WITHOUT_SIZE]
    # The project's own plant makes a recording several times faster; the second one can be asked for by --plant.
    plant = "main" if args.plant == "both" else args.plant
    more = ("--any-size",) if args.any_size else ()
    work = [(20000 + n, c, plant, args.iqfoc, more) for c in causes for n in range(args.seeds)]
    table = {}
    with ProcessPoolExecutor(args.jobs) as pool:
        for (seed, cause, *_), limit in zip(work, pool.map(limit_of, work)):
            table.setdefault(cause, []).append(limit)
            if sys.stderr.isatty():
                print(f"\r{cause} seed {seed}          ", end="", file=sys.stderr)
    lines = ["| cause | median size found | found in 95 % of cases | unit | share of the noise floor there | n |",
             "|---|---|---|---|---|---|"]
    out = {}
    for cause, limits in table.items():
        sizes = sorted(x[0] if x else np.inf for x in limits)
        shares = sorted(x[1] if x else np.inf for x in limits)
        # The smallest size that at least 95 % of the seeds reach: an order statistic, no interpolation into inf.
        k = int(np.ceil(0.95 * len(sizes))) - 1
        out[cause] = {"median": float(np.median(sizes)), "size_95": float(sizes[k]), "share_95": float(shares[k]),
                      "unit": UNIT[cause], "seeds": len(sizes), "never_found": int(sum(x is None for x in limits))}
        shown = f"{sizes[k]:.3g}" if np.isfinite(sizes[k]) else f"above {effects.RANGE[cause][1]:.3g}"
        share = f"{shares[k]:.2g}" if np.isfinite(shares[k]) else "-"
        name = cause.replace("_", " ")
        lines.append(f"| {name} | {np.median(sizes):.3g} | {shown} | {UNIT[cause]} | {share} | {len(sizes)} |")
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if args.docs:
        figure.fill_page("limits of any size" if args.any_size else "limits", text)
    if args.table:
        with open(args.table, "w", encoding="utf-8") as file:
            file.write(text)
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(out, file, indent=1)
    return 0
