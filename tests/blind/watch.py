"""The watch from end to end: a drive changes, its alarm lets it be recorded, and `iqfoc diagnose` names what changed.

    tests/blind/watch.py [--trials N] [--first SEED] [--target cortex-m4] [--iqfoc PROGRAM]

Each trial is a drive of its own duty; CI runs one of each change. Exit status 1 if fewer than 95 % are noted within a second,
taken for the right group by the watch, and named by the diagnosis with the right value in a tenth of the change. With --target
the firmware runs in QEMU, and what is diagnosed is what its recorder sent; tests/target/run.sh builds the images.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MOTOR = "data/motors/compressor_salient.toml"
# What the watch calls it, what the diagnosis does, the parameter, and what the drive really has.
CHANGES = {
    "magnet": ("flux", "flux_linkage", "psi_f", 0.95 * 0.2, 0.05 * 0.2),
    "winding": ("resistance", "resistance", "R", 0.9 * (1 + 60 * 0.00393), 0.9 * 60 * 0.00393),
    "sensor": ("sensor gain", "current_gain", None, 0.02, 0.02),
    "dead_time": ("dead time", "dead_time", "v_dead", 2 * 565 * 0.5e-6 * 8000, 565 * 0.5e-6 * 8000),
}


def value_of(cause, name):
    """A parameter; of a sensor's gains the first less the mean of the two others."""
    values = {parameter["name"]: parameter["value"] for parameter in cause["parameters"]}
    return values[name] if name else values["g_a"] - 0.5 * (values["g_b"] + values["g_c"])


def noted(program, change, seed, folder, target=None):
    """What the watch takes the change for, or an error in words; folder/rec.csv is then there."""
    command = [program, "watch", "--motor", MOTOR, "--change", change, "--seed", str(seed), "-o", folder]
    done = subprocess.run(command + (["--target", target] if target else []), cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return done.stderr.strip()
    if target:
        subprocess.run([program, "record", "--port", folder / "rec.uart", "-o", folder / "rec.csv"], cwd=ROOT, capture_output=True,
                       check=True)
    return done.stdout.splitlines()[0].partition(": named ")[2].partition(",")[0]


def trial(program, change, seed, folder, target=None):
    """In words: "named", or what went wrong."""
    group, cause, name, truth, size = CHANGES[change]
    taken = noted(program, change, seed, folder, target)
    if taken != group:
        return f"named {taken}"
    result = folder / "diagnosis.json"
    subprocess.run([program, "diagnose", folder / "rec.csv", "--motor", folder / "motor.toml", "--json", result], cwd=ROOT,
                   capture_output=True, check=True)
    causes = json.loads(result.read_text())["causes"]
    if [found["id"] for found in causes] != [cause]:
        return f"named {[found['id'] for found in causes]}"
    value = value_of(causes[0], name)
    return "named" if abs(value - truth) <= 0.1 * size else f"{cause} {value:.4g}, not {truth:.4g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=1)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--target", choices=["cortex-m4", "rv32"])
    parser.add_argument("--iqfoc", type=pathlib.Path, default=ROOT / "build" / "host" / "iqfoc")
    options = parser.parse_args()
    status = 0
    for change in CHANGES:
        named = 0
        for seed in range(options.first, options.first + options.trials):
            with tempfile.TemporaryDirectory() as folder:
                outcome = trial(options.iqfoc.resolve(), change, seed, pathlib.Path(folder), options.target)
            named += outcome == "named"
            if outcome != "named":
                print(f"  {change}, seed {seed}: {outcome}")
        print(f"{change}: {named} of {options.trials} noted, taken for what it is, and named", flush=True)
        status |= named < 0.95 * options.trials
    return status


if __name__ == "__main__":
    sys.exit(main())
