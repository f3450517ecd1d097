#!/usr/bin/env python3
"""Derive the tables of src/iq24_trig_tables.h and the coefficients in include/iqfoc/iq24_sincos.h.

    python3 tools/derive_iq24_trig.py > src/iq24_trig_tables.h      write the tables
    python3 tools/derive_iq24_trig.py --coefficients                print the coefficients
    python3 tools/derive_iq24_trig.py --check                       exit 1 if either file differs

Standard library only and no fitting by iteration, so that the output is the same on every machine: polynomials are
interpolated at Chebyshev nodes, which is within a few per cent of the best possible error at these degrees.
"""
import math
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLES = ROOT / "src" / "iq24_trig_tables.h"
SINCOS = ROOT / "include" / "iqfoc" / "iq24_sincos.h"
TAU = 2 * math.pi


def chebyshev_nodes(low, high, count):
    return [(low + high) / 2 + (high - low) / 2 * math.cos(math.pi * (2 * i + 1) / (2 * count)) for i in range(count)]


def interpolate(function, nodes):
    """Coefficients, lowest power first, of the polynomial through (node, function(node)): Newton's divided differences."""
    divided = [function(x) for x in nodes]
    for order in range(1, len(nodes)):
        for i in range(len(nodes) - 1, order - 1, -1):
            divided[i] = (divided[i] - divided[i - 1]) / (nodes[i] - nodes[i - order])
    coefficients = [0.0] * len(nodes)
    for i in range(len(nodes) - 1, -1, -1):
        shifted = [0.0] + coefficients[:-1]
        coefficients = [s - nodes[i] * c for s, c in zip(shifted, coefficients)]
        coefficients[0] += divided[i]
    return coefficients


def wrap(values, per_line):
    lines = [", ".join(values[i:i + per_line]) for i in range(0, len(values), per_line)]
    return ",\n".join("    " + line for line in lines)


SINE_CELLS = 64  # per turn; smallest power of two at which two terms each suffice for the rest


def sine_table():
    return [round(math.sin(TAU * i / SINE_CELLS) * 2**30) for i in range(SINE_CELLS + SINE_CELLS // 4)]


def rotation_coefficients():
    """The rest of the angle is u / 2 cells, u = e / 2^31 in [-1, 1), z = floor(e^2 / 2^32) = u^2 2^30.

    sin = e (S1 - z S3 / 2^32) / 2^32 in Q34;   1 - cos = z (C2 - z C4 / 2^32) / 2^32 in Q34.
    """
    half_cell = TAU / SINE_CELLS / 2
    squares = chebyshev_nodes(0.0, 1.0, 2)  # of u^2
    s1, s3 = interpolate(lambda v: math.sin(half_cell * math.sqrt(v)) / math.sqrt(v), squares)
    c2, c4 = interpolate(lambda v: (1 - math.cos(half_cell * math.sqrt(v))) / v, squares)
    # e = u 2^31 and z = v 2^30: undo those scales, and the 2^32 of each high word.
    return [
        ("IQ24_ROTATE_S1", s1 * 2.0**(34 + 32 - 31)),
        ("IQ24_ROTATE_S3", -s3 * 2.0**(34 + 32 - 31 + 32 - 30)),
        ("IQ24_ROTATE_C2", c2 * 2.0**(34 + 32 - 30)),
        ("IQ24_ROTATE_C4", -c4 * 2.0**(34 + 32 - 30 + 32 - 30)),
    ]


ARCTAN_CELLS = 16  # over ratios 0 ... 1; smallest power of two at which cubics suffice


def arctan_table():
    """Cubics in u, ratio = (node + u / 2) / ARCTAN_CELLS, -1 <= u < 1, giving turns in Q32.

    The ratio that comes in is a floor in Q24; the table is for half an LSB more, its mean.
    Each multiplication by u is one by u 2^31 that keeps the high word, which halves: coefficient k is stored times 2^k.
    """
    rows = []
    for node in range(ARCTAN_CELLS + 1):
        def turns(u, node=node):
            return math.atan((node + u / 2) / ARCTAN_CELLS + 2.0**-25) / TAU
        coefficients = interpolate(turns, chebyshev_nodes(-1.0, 1.0, 4))
        rows.append([round(c * 2.0**(32 + k)) for k, c in enumerate(coefficients)])
    return rows


def coefficient_lines():
    return [f"#define {name} INT32_C({round(value)})" for name, value in rotation_coefficients()]


def render_tables():
    sine = [str(value) for value in sine_table()]
    arctan = ",\n".join("    {%d, %d, %d, %d}" % tuple(row) for row in arctan_table())
    return f"""/*
 * Written by tools/derive_iq24_trig.py, which says how; do not edit. Private to src/iq24_trig.c.
 * python3 tools/derive_iq24_trig.py > src/iq24_trig_tables.h
 */
#ifndef IQ24_TRIG_TABLES_H
#define IQ24_TRIG_TABLES_H

#include "iqfoc/iq24_sincos.h"

/* clang-format off */

/* sin(2 pi i / {SINE_CELLS}) in Q30, and the polynomials. */
const int32_t iq24_sine_q30[IQ24_SINE_TERMS + 4] = {{
{wrap(sine, 8)},
    IQ24_ROTATE_S1 + 1, -IQ24_ROTATE_S3, -IQ24_ROTATE_C2, IQ24_ROTATE_C4,
}};

/* atan in Q32 turns around the ratios i / {ARCTAN_CELLS}: coefficients of a cubic, constant first; the k-th times 2^k. */
static const int32_t arctan_q32[{ARCTAN_CELLS + 1}][4] = {{
{arctan},
}};

/* clang-format on */

#endif
"""


def main():
    if sys.argv[1:] == ["--check"]:
        if TABLES.read_text() != render_tables():
            sys.exit(f"{TABLES}: differs from what {pathlib.Path(__file__).name} derives")
        header = SINCOS.read_text().splitlines()
        for line in [f"#define IQ24_SINE_CELLS {SINE_CELLS}"] + coefficient_lines():
            if line not in header:
                sys.exit(f"{SINCOS}: lacks '{line}', which {pathlib.Path(__file__).name} derives")
    elif sys.argv[1:] == ["--coefficients"]:
        print("\n".join(coefficient_lines()))
    elif sys.argv[1:]:
        sys.exit(__doc__)
    else:
        sys.stdout.write(render_tables())


main()
