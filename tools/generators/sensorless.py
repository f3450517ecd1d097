"""sensorless: the drive on the observed angle, in closed loop, at all ratios. It is the table of tests/cli/sensorless.py.

    <!-- figures: sensorless -->
"""

import sys


def generate(program, arguments):
    if arguments:
        raise ValueError(f"takes no arguments, got {arguments}")
    return program.output(sys.executable, "-B", "tests/cli/sensorless.py", str(program.path), "--table")
