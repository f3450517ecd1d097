#!/usr/bin/env python3
"""
bench_log.py: writes data/logs/bench.csv, the log of docs/own-log.md. `--check` compares it with the file in the tree.

It is the recording of the drive with a dead time as a bench of another make logs it: semicolons, decimal commas, Latin-1, currents
in d and q in mA, compare counts, an encoder's counts, no speed. Two mistakes are in it: the currents have the wrong sign, and a row
holds the command that acts in the next cycle.
"""

import math
import pathlib
import sys

import foreign

ROOT = pathlib.Path(__file__).resolve().parents[2]
LOG = ROOT / "data/logs/bench.csv"
RECORDINGS = ROOT / "data/recordings"
ROWS = 900  # of each run
COUNTS, LINES, ZERO, PAIRS = 5000, 16384, 100, 3


def mechanical(theta_e):
    """The mechanical angle: the electrical one of row after row without its jumps, over the pole pairs."""
    whole, last = 0.0, theta_e[0]
    for theta in theta_e:
        whole += math.remainder(theta - last, 2 * math.pi)
        last = theta
        yield (theta_e[0] + whole) / PAIRS


def of_run(rec, rows):
    """The columns of one run; its last row has no command after it."""
    part = {name: [values[row] for row in rows] for name, values in rec.items()}
    i_dq = foreign.dq(part, foreign.I_ABC)
    counts = {f"CCR{n}": [str(round(COUNTS * d)) for d in part[x][1:]] for n, x in enumerate(("d_a", "d_b", "d_c"), 1)}
    columns = {
        "Segment": [f"{run:.0f}" for run in part["run"]],
        "Zeit": [f"{1000.0 * t:.4f}" for t in part["t_s"]],
        "Id": [f"{-1000.0 * d:.1f}" for d, _ in i_dq],
        "Iq": [f"{-1000.0 * q:.1f}" for _, q in i_dq],
        **counts,
        "Udc": [f"{u:.2f}" for u in part["u_dc_V"]],
        "Enc": [str(round(angle / (2 * math.pi) * LINES + ZERO) % LINES) for angle in mechanical(part["theta_e_rad"])],
    }
    return columns, zip(*columns.values())


def log():
    rec = foreign.whole(foreign.read_recording(RECORDINGS / "dead_time.csv.gz"))
    lines = ["Pr\u00fcfstand 3", "Motor;2,2 kW", ""]
    for run in sorted(set(rec["run"])):
        columns, rows = of_run(rec, [row for row, of in enumerate(rec["run"]) if of == run][:ROWS])
        if len(lines) == 3:
            lines += [";".join(columns), ";ms;mA;mA;;;;V;count"]
        lines += [";".join(row).replace(".", ",") for row in rows]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1")


def main(arguments):
    if arguments == ["--check"]:
        if LOG.read_bytes() != log():
            sys.exit(f"{LOG} is not what {sys.argv[0]} writes")
    else:
        LOG.write_bytes(log())


if __name__ == "__main__":
    main(sys.argv[1:])
