"""A recording's CSV back as columns (rows, 1), for the oracle: made by either plant, read as the diagnosis reads it."""

import csv

import numpy as np


def read_table(path):
    """Column names and values of a recording; comment lines ahead of the header are skipped."""
    with open(path, encoding="utf-8", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    rows = list(csv.reader(lines))
    values = np.array(rows[1:], dtype=float)
    return {name: values[:, n] for n, name in enumerate(rows[0])}


def read_columns(path, pole_pairs):
    """One dictionary of columns for averaged.predict() per run; time gaps end a run as well."""
    table = read_table(path)
    if "theta_mech_rad" in table:
        # The electrical angle counted from the mechanical one, so that the revolution is known.
        turns = np.round((pole_pairs * table["theta_mech_rad"] - table["theta_e_rad"]) / (2.0 * np.pi))
        table["theta_e_rad"] = table["theta_e_rad"] + 2.0 * np.pi * turns
    if "i_c_A" not in table:
        table["i_c_A"] = -table["i_a_A"] - table["i_b_A"]
    if "u_a_V" not in table:
        mean = (table["d_a"] + table["d_b"] + table["d_c"]) / 3.0
        for phase in "abc":
            table[f"u_{phase}_V"] = (table[f"d_{phase}"] - mean) * table["u_dc_V"]
    step = np.diff(table["t_s"])
    breaks = step > 1.5 * np.median(step)
    if "run" in table:
        breaks |= np.diff(table["run"]) != 0
    edges = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(table["t_s"])]])
    runs = []
    for a, b in zip(edges[:-1], edges[1:]):
        if b - a < 4:
            continue
        runs.append({"i_A": np.stack([table[f"i_{p}_A"][a:b] for p in "abc"], axis=1)[:, :, None],
                     "u_V": np.stack([table[f"u_{p}_V"][a:b] for p in "abc"], axis=1)[:, :, None],
                     "theta_e_rad": table["theta_e_rad"][a:b, None],
                     "omega_e_rad_s": table["omega_e_rad_s"][a:b, None]})
    return runs
