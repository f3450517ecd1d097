"""Last-digit errors of a motor file: no file is exact in what a recording does not hide.

A value of a data sheet or of another bench is off by a little. Each value of [motor] that no hidden effect moves is off by a normal
error of a fifth of the least size that its cause is named at (`least` in sim_host/data/causes.def), and by half of that at most: a file
that is right for all practical purposes. A diagnosis that lets such errors add up to a cause, or that takes a cause of its own for a sum
of them, is seen here and not on files that are exact to the last digit.
"""

import copy

import numpy as np

import effects

# The least size at which the value's cause is named, relative to the value.
LEAST = {"R_ohm": 0.02, "L_d_H": 0.008, "L_q_H": 0.008, "psi_f_Wb": 0.004}
SPREAD, MOST = 0.2, 0.5  # of LEAST: standard deviation, and the largest error

# What a hidden effect moves of it, and the file is therefore wrong about anyway.
BOTH = ("L_d_H", "L_q_H")
MOVES = {"resistance": ("R_ohm",), "inductance": BOTH, "saliency": BOTH, "saturation": BOTH, "saturation_dq": BOTH,
         "flux_linkage": ("psi_f_Wb",)}


def relative_errors(seed, motor, ids):
    """File over truth, less one, of each value that no effect of `ids` moves; a machine without saliency stays one."""
    rng = np.random.default_rng([seed, 5])
    drawn = {}
    for key, least in LEAST.items():
        while True:
            error = SPREAD * least * rng.standard_normal()
            if abs(error) <= MOST * least:
                break
        drawn[key] = float(error)
    if motor.L_d_H == motor.L_q_H:
        drawn["L_q_H"] = drawn["L_d_H"]
    hidden = {key for name in ids for key in MOVES.get(effects.cause_of(name), ())}
    return {key: error for key, error in drawn.items() if key not in hidden}


def file_of(motor, errors):
    """The motor as its file has it, in five digits."""
    file = copy.copy(motor)
    for key, error in errors.items():
        setattr(file, key, float(f"{getattr(motor, key) * (1.0 + error):.5g}"))
    return file
