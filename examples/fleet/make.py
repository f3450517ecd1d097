#!/usr/bin/env python3
"""A fleet to try the diagnosis on: drives of one type, each with tolerances of its own, and some with a fault.

    make.py FOLDER [--drives 1000] [--batch 1] [--jobs N]

Writes FOLDER/drive-0001.csv.gz ..., the one motor file that all of them were sold with, and truth.json. A drive's tolerances and fault
stay from batch to batch; some without a fault in the first batch have one in the second.
"""

import argparse
import gzip
import json
import os
import pathlib
import shutil
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import iqfoc

MOTOR = pathlib.Path(__file__).resolve().parents[2] / "data" / "motors" / "jarzebowicz2019.toml"
SCENARIO = {
    "sensors": {"current_bits": 12, "current_full_scale_A": 25.0, "current_noise_A": 0.025, "u_dc_noise_V": 0.2},
    "log": {"duties": True},
    "run": [{"cycles": 600, "speed_rpm": rpm, "i_d_A": {"value": d, "square": {"amplitude": 1.0, "period_s": 0.023}},
             "i_q_A": {"value": q, "square": {"amplitude": 1.0, "period_s": 0.037}}}
            for rpm, d, q in ((300.0, 0.0, 3.0), (1500.0, -1.0, 6.0), (-1500.0, 0.0, -5.0), (3000.0, -2.0, 4.0))],
}


def faults(rng):
    """One fault of a size that matters, as `iqfoc simulate --effect` has it, and the cause that it is."""
    return [("resistance", f"resistance:R={0.75 * rng.uniform(1.2, 1.5):.4f}"),
            ("flux_linkage", f"flux_linkage:psi_f={0.134 * rng.uniform(0.85, 0.93):.5f}"),
            ("dead_time", f"dead_time:t_dead={rng.uniform(1e-6, 2e-6):.3g}"),
            ("angle_offset", f"angle_offset:theta_0={rng.choice([-1, 1]) * rng.uniform(0.03, 0.06):.4f}"),
            ("current_gain", f"current_gain:g_a={1.0 + rng.choice([-1, 1]) * rng.uniform(0.03, 0.05):.4f}")]


def drive_of(number, batch):
    """(effects, hidden cause or None) of a drive: small tolerances always, a fault in one of three."""
    rng = np.random.default_rng(1000 + number)
    effects = [f"resistance:R={0.75 * rng.normal(1.0, 0.004):.5f}", f"flux_linkage:psi_f={0.134 * rng.normal(1.0, 0.001):.6f}"]
    all_faults = faults(rng)
    cause, effect = all_faults[rng.integers(len(all_faults))]
    faulty = rng.uniform() < 1.0 / 3.0 or (batch > 1 and number % 7 == 4)
    return (effects + [effect], cause) if faulty else (effects, None)


def make(number, batch, folder):
    effects, cause = drive_of(number, batch)
    name = f"drive-{number:04d}"
    drive = iqfoc.Drive(iqfoc.Motor(MOTOR), effects, seed=10 * number + batch)
    plain = folder / f"{name}.csv"
    drive.run(SCENARIO).write(plain)
    with plain.open("rb") as text, gzip.open(f"{plain}.gz", "wb", compresslevel=1) as packed:
        shutil.copyfileobj(text, packed)
    plain.unlink()
    return name, cause


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--drives", type=int, default=1000)
    parser.add_argument("--batch", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(MOTOR, args.folder / "motor.toml")
    numbers = range(1, args.drives + 1)
    with ProcessPoolExecutor(args.jobs) as pool:
        truth = dict(pool.map(make, numbers, [args.batch] * args.drives, [args.folder] * args.drives))
    (args.folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    print(f"{args.drives} recordings in {args.folder}, {sum(c is not None for c in truth.values())} of drives with a fault")


if __name__ == "__main__":
    main()
