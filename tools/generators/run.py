"""run LINES COMMAND...: commands that a reader types in the clone's root, and the first lines of what the last one prints (0: all).

    <!-- figures: run 2 "build/host/iqfoc diagnose data/recordings/clean.csv.gz --motor data/recordings/clean.toml" -->
"""

import pathlib

PROGRAM = "build/host/iqfoc"
EXAMPLES = "build/host/examples/"


def generate(program, arguments):
    if len(arguments) < 2 or not arguments[0].isdigit():
        raise ValueError(f"expected a number of lines and commands, got {arguments}")
    built = pathlib.Path(program.path)
    (program.root / "build").mkdir(exist_ok=True)
    printed = ""
    for command in arguments[1:]:
        there = command.replace(PROGRAM, str(built)).replace(EXAMPLES, f"{built.parent}/examples/")
        printed = program.output("bash", "-c", f"{{ {there}; }} 2>&1")
    lines = [line.rstrip() for line in printed.strip("\n").split("\n")][:int(arguments[0]) or None]
    while lines and not lines[-1]:
        lines.pop()
    return "\n".join(["```console", *(f"$ {command}" for command in arguments[1:]), *lines, "```"])
