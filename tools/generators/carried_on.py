"""carried_on RECORDING MOTOR PART: what follows a diagnosis of a recording in the tree.

    <!-- figures: carried_on data/recordings/dead_time.csv.gz data/recordings/dead_time.toml again -->

PART is `again` (the same recording with the extended motor file, as on the terminal), `header` (the diagnosed lines of the firmware's
header), `firmware` (the gain in IQ24 code) or `plant` (the plant with the effect, compared with the machine).
"""

import re

LONG = re.compile(r"-?\d+\.\d{6,}")


def again(program, recording, folder):
    said = program.output(str(program.path), "diagnose", recording, "--motor", str(folder / "motor_extended.toml"))
    verdict = said.split("\n")[1].strip()
    return f"```console\n$ iqfoc diagnose {recording} --motor diagnosis/motor_extended.toml\n  {verdict}\n```"


def header(folder):
    lines = (folder / "iqfoc_extension.h").read_text(encoding="utf-8").split("\n")
    # The header holds all digits of a double; the last differ between machines.
    kept = [LONG.sub(lambda match: f"{float(match.group(0)):.5g}", line) for line in lines if "; diagnosed" in line]
    return "```c\n" + "\n".join(kept) + "\n```"


def firmware(result):
    rows = [("exact model, double", result["error"]), ("flux predictor, IQ24", result["firmware"])]
    table = ["| one-cycle error, held-out rows | nominal | extended | error reduction |", "| --- | --- | --- | --- |"]
    table += [f"| {name} | {e['nominal']:.2f} % | {e['extended']:.2f} % | {e['gain']:.1f} |" for name, e in rows]
    return "\n".join(table)


def plant(result):
    table = [f"The plant was given {result['plant']['effect']}. Diagnosed with the same motor file, its recording shows: "
             f"{', '.join(result['plant']['causes'])}.", "", "| run | error on the machine | on the plant |", "| --- | --- | --- |"]
    table += [f"| {r['run']} | {r['nominal_on_machine']:.2f} % | {r['nominal_on_plant']:.2f} % |" for r in result["plant"]["runs"]]
    return "\n".join(table)


def generate(program, arguments):
    if len(arguments) != 3 or arguments[2] not in ("again", "header", "firmware", "plant"):
        raise ValueError(f"expected a recording, a motor file and one of again, header, firmware, plant; got {arguments}")
    recording, motor, part = arguments
    diagnosis = ("diagnose", recording, "--motor", motor)
    if part == "again":
        return again(program, recording, program.written(*diagnosis))
    if part == "header":
        return header(program.written(*diagnosis))
    result = program.json(*diagnosis)
    return firmware(result) if part == "firmware" else plant(result)
