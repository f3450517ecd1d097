"""diagnosis RECORDING MOTOR [short]: what `iqfoc diagnose` prints on a recording in the tree, down to the error, or the first seven lines.

    <!-- figures: diagnosis data/recordings/dead_time.csv.gz data/recordings/dead_time.toml short -->
"""

SHORT = 7


def generate(program, arguments):
    if len(arguments) not in (2, 3) or arguments[2:] not in ([], ["short"]):
        raise ValueError(f"expected a recording, a motor file and perhaps `short`, got {arguments}")
    recording, motor = arguments[:2]
    said = program.output(str(program.path), "diagnose", recording, "--motor", motor)
    lines = []
    for line in said.split("\n"):
        if line.lstrip().startswith("run "):
            break
        lines.append(line.rstrip())
    body = "\n".join(lines[:SHORT] if arguments[2:] else lines).strip("\n")
    return f"```console\n$ iqfoc diagnose {recording} --motor {motor}\n{body}\n```"
