"""sensorless: the drive on the observed angle, in closed loop, at all ratios. It is the table of tests/cli/sensorless.py.
identified, reversals: the observer with adapted R, psi_f and L_q. They are the tables of test_sensorless.

    <!-- figures: sensorless -->
    <!-- figures: identified -->
    <!-- figures: reversals -->
"""

import sys


def generate(program, arguments):
    if arguments:
        raise ValueError(f"takes no arguments, got {arguments}")
    return program.output(sys.executable, "-B", "tests/cli/sensorless.py", str(program.path), "--table")


def table_of_test(program, arguments, name):
    if arguments:
        raise ValueError(f"takes no arguments, got {arguments}")
    return program.output(str(program.path.parent / "tests/test_sensorless"), name)


def identified(program, arguments):
    return table_of_test(program, arguments, "--identified")


def reversals(program, arguments):
    return table_of_test(program, arguments, "--reversals")
