"""Foreign logs made from a recording, by arithmetic of their own: nothing here is the program's."""

import csv
import gzip
import io
import math

ROOT3 = math.sqrt(3.0)


def read_recording(path, rows=None):
    """{column: [numbers]} of a recording, gzip or not."""
    raw = path.read_bytes()
    text = (gzip.decompress(raw) if raw[:2] == b"\x1f\x8b" else raw).decode()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    table = list(csv.reader(lines))
    body = table[1:] if rows is None else table[1:rows + 1]
    return {name: [float(row[n]) for row in body] for n, name in enumerate(table[0])}


def whole(rec):
    """With the third current where the recording leaves it out."""
    if "i_c_A" not in rec:
        rec["i_c_A"] = [-a - b for a, b in zip(rec["i_a_A"], rec["i_b_A"])]
    return rec


def without_common(rec, names):
    """Columns free of what the three have in common, so that what is turned comes back but for rounding."""
    for row, values in enumerate(zip(*(rec[n] for n in names))):
        for n, value in zip(names, values):
            rec[n][row] = value - sum(values) / 3
    return rec


def clarke(a, b, c):
    return (2 * a - b - c) / 3, (b - c) / ROOT3


def park(x, y, theta):
    return x * math.cos(theta) + y * math.sin(theta), y * math.cos(theta) - x * math.sin(theta)


def vectors(rec, names):
    return [clarke(a, b, c) for a, b, c in zip(*(rec[n] for n in names))]


def dq(rec, names):
    return [park(x, y, theta) for (x, y), theta in zip(vectors(rec, names), rec["theta_e_rad"])]


I_ABC = ("i_a_A", "i_b_A", "i_c_A")
U_ABC = ("u_a_V", "u_b_V", "u_c_V")


def number(value, decimal="."):
    return repr(value).replace(".", decimal)


def table(columns, delimiter=",", decimal=".", ahead="", units=None, end="\n"):
    """A table's text: {name: [numbers]}, with lines ahead of the header and a row of units below it."""
    out = io.StringIO()
    out.write(ahead)
    out.write(delimiter.join(columns) + end)
    if units is not None:
        out.write(delimiter.join(units) + end)
    for row in zip(*columns.values()):
        out.write(delimiter.join(number(x, decimal) for x in row) + end)
    return out.getvalue()


def run_of(rec):
    return rec.get("run", [1.0] * len(rec["t_s"]))
