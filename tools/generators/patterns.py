"""patterns: the distortion of `iqfoc patterns` and of space vectors, a row for each number of pulses, a column for each index.

    <!-- figures: patterns MOTOR.toml PULSES,... INDEX,... -->

pattern_control: the control of a pattern on a switching machine. It is the table that test_pattern_control_drive prints.

    <!-- figures: pattern_control -->

pulse_mode: the torque of a drive through all pulse modes, and pulse_shares: what its hand-overs add. test_pulse_mode_drive prints both
tables, in this order.

    <!-- figures: pulse_mode -->
    <!-- figures: pulse_shares -->
"""

import re

from .markdown import table


def percent(value):
    return "-" if value is None else f"{100 * value:.1f}"


def generate(program, arguments):
    motor, pulses, indices = arguments
    heads = ["pulses", *(f"{index}: {of}" for index in indices.split(",") for of in ("pattern", "space vectors"))]
    rows = []
    for pattern in program.json("patterns", "--motor", motor, "--pulses", pulses)["patterns"]:
        found = {f"{row['index']:.2f}": row for row in pattern["rows"]}
        rows.append([pattern["pulses"], *(percent(found[index][of]) for index in indices.split(",") for of in ("distortion", "space_vectors"))])
    return table(heads, rows, right=heads)


def printed(program, test, arguments, which=0):
    """A table that a test prints."""
    if arguments:
        raise ValueError(f"takes no arguments, got {arguments}")
    output = program.output(str(program.path.parent / "tests" / test))
    return re.findall(r"(?:^\|.*\n)+", output, re.MULTILINE)[which].rstrip("\n")


def control(program, arguments):
    return printed(program, "test_pattern_control_drive", arguments)


def modes(program, arguments):
    return printed(program, "test_pulse_mode_drive", arguments)


def shares(program, arguments):
    return printed(program, "test_pulse_mode_drive", arguments, 1)
