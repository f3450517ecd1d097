"""diagnosis RECORDING MOTOR: what `iqfoc diagnose` says of a recording in the tree, as on the terminal, down to the error.

    <!-- figures: diagnosis recordings/dead_time.csv.gz recordings/dead_time.toml -->
"""


def generate(program, arguments):
    if len(arguments) != 2:
        raise ValueError(f"expected a recording and a motor file, got {arguments}")
    recording, motor = arguments
    said = program.output(str(program.path), "diagnose", recording, "--motor", motor)
    lines = []
    for line in said.split("\n"):
        if line.lstrip().startswith("run "):
            break
        lines.append(line.rstrip())
    body = "\n".join(lines).strip("\n")
    return f"```console\n$ iqfoc diagnose {recording} --motor {motor}\n{body}\n```"
