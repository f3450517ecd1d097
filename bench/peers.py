#!/usr/bin/env python3
"""
The same job in other libraries' own functions (bench/peers/peer.h), counted on the emulated Cortex-M4 with its FPU: for who has their sources.

    ./dev bench --peers --cmsis DIR --moteus DIR --write

DIR is the folder of CMSIS-DSP (a checkout, or the unpacked sources of PyPI's cmsisdsp) or of moteus (a checkout). --write
writes bench/peers.md. moteus needs Debian's libstdc++-arm-none-eabi-newlib.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import core
import estimate
import flash

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
PORT = ROOT / "port/cortex-m4"
FLAGS = ["-O2", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-ffunction-sections", "-fdata-sections"]
CXX = ["-std=c++17", "-fno-exceptions", "-fno-rtti", "-DTARGET_STM32G4"]
TRACED = 32  # inputs for the cycles


def refuse(text):
    raise SystemExit(f"./dev bench --peers: {text}")


def holder(folder, name):
    """The folder that holds the file of this name (a path from there), somewhere below `folder`."""
    found = min(folder.rglob(name), key=lambda path: len(path.parts), default=None)
    if found is None:
        refuse(f"{folder} has no {name}")
    return found.parents[len(pathlib.PurePath(name).parts) - 1]


def version(folder):
    if (folder / "PKG-INFO").is_file():
        return re.search(r"^Version: (\S+)", (folder / "PKG-INFO").read_text(), re.M).group(1)
    done = subprocess.run(["git", "-C", folder, "log", "-1", "--format=%h of %cs"], capture_output=True, text=True, check=False)
    return done.stdout.strip() or folder.name


def cmsis(folder, kind):
    top = holder(folder, "Include/arm_math_types.h")
    controller = top / "Source/ControllerFunctions"
    sources = [controller / f"arm_{name}_{kind}.c" for name in ("sin_cos", "pid_init")] + [top / "Source/CommonTables/arm_common_tables.c"]
    include = [top / "Include", top / "PrivateInclude"] + [path.parent for path in list(folder.rglob("cmsis_compiler.h"))[:1]]
    return {"name": f"CMSIS-DSP {version(top)}, {kind}" + (" (FPU)" if kind == "f32" else ""),
            "sources": [HERE / f"peers/cmsis_{kind}.c"] + sources, "include": include, "define": []}


def moteus(folder, limits):
    top = holder(folder, "fw/foc.h")
    return {"name": f"moteus {version(top)} (FPU, CORDIC), " + ("with voltage limit and anti-windup" if limits else "without voltage limit"),
            "sources": [HERE / "peers/moteus.cpp"], "include": [top], "define": [f"-DPEER_LIMITS={limits:d}"]}


def peers(options):
    library = sorted((ROOT / "src").glob("*.c"))
    yield {"name": "iqfoc, with voltage limit and anti-windup", "sources": [HERE / "peers/iqfoc.c"] + library, "include": [ROOT / "include"], "define": []}
    if options.moteus:
        yield moteus(options.moteus, False)
        yield moteus(options.moteus, True)
    if options.cmsis:
        yield cmsis(options.cmsis, "f32")
        yield cmsis(options.cmsis, "q31")


def build(peer, folder, inputs):
    image = folder / f"{inputs}.elf"
    harness = [HERE / "peers/main.c"] + [PORT / name for name in ("startup.c", "console.c", "semihost_call.c")] + [
        ROOT / "port/emulated/console.c", ROOT / "port/emulated/semihost.c"]
    include = [f"-I{path}" for path in [HERE / "peers", *peer["include"], PORT, ROOT / "port/emulated"]] + ["-idirafter", HERE / "peers/missing"]
    objects = []
    for number, source in enumerate(harness + peer["sources"]):
        objects.append(folder / f"{inputs}_{number}.o")
        cxx = source.suffix == ".cpp"
        command = ["arm-none-eabi-g++" if cxx else "arm-none-eabi-gcc", *FLAGS, *(CXX if cxx else []), f"-DPEER_INPUTS={inputs}",
                   *peer["define"], *include, "-c", source, "-o", objects[-1]]
        if subprocess.run(command, check=False).returncode:
            refuse(f"{source} does not compile")
    command = ["arm-none-eabi-gcc", *FLAGS, "-nostartfiles", "--specs=nano.specs", *objects, "-Wl,--gc-sections", f"-T{PORT / 'link.ld'}",
               "-lm", "-o", image]
    if subprocess.run(command, check=False).returncode:
        refuse(f"{peer['name']} does not link")
    return image


def measure(peer, folder):
    command = core.ARM_QEMU + ["-display", "none", "-monitor", "none", "-serial", "stdio"]
    done = subprocess.run(command + ["-kernel", str(build(peer, folder, core.INPUTS))], stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=core.TIME_LIMIT_S, check=False)
    line = re.search(r"^job (\d+) (\d+) (\d+) (\d+)\r?\n+end", done.stdout, re.M)
    if done.returncode or not line:
        refuse(f"{peer['name']}: the emulator ended with status {done.returncode}\n{done.stdout[-500:]}")
    least, total, greatest, error = (int(word) for word in line.groups())
    image = build(peer, folder, TRACED)
    code = estimate.disassemble(image)
    calls = [steps for _, steps in flash.calls_of(code, image, command, ["peer_job"])]
    cycles = [sum(flash.cycles_of(code, steps, line) for steps in calls) / len(calls) for line in (None, *flash.BANKS.values())]
    return {"name": peer["name"], "min": least, "mean": total / core.INPUTS, "max": greatest, "error_lsb": error / 10,
            "cycles": [round(value) for value in cycles]}


def page(rows):
    gcc = subprocess.run(["arm-none-eabi-gcc", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    lines = [
        "# The same job in other libraries", "",
        "For engineers who compare libraries for a Cortex-M4: instructions, cycles and error of one current-control step in each library's own",
        "functions. Two currents and an angle in, three duties out: Clarke, sine and cosine, Park, two PI, inverse Park, min/max modulation",
        "([peer.h](peers/peer.h)). The tree holds no sources of other libraries. With them, one command writes this page:", "",
        "    ./dev bench --peers --cmsis DIR --moteus DIR --write", "",
        "| library | instructions | cycles, zero-wait memory | cycles, STM32G4 flash, two banks | one bank | error, LSB |",
        "| --- | ---: | ---: | ---: | ---: | ---: |"]
    for row in rows:
        spread = "" if row["min"] == row["max"] else f" ({row['min']} ... {row['max']})"
        lines.append(f"| {row['name']} | {row['mean']:.0f}{spread} | " + " | ".join(f"{value:,}" for value in row["cycles"])
                     + f" | {row['error_lsb']:,.1f} |")
    lines += ["", f"- **Instructions**: from call to return of the job in QEMU (mps2-an386), over {core.INPUTS:,} inputs, gcc {gcc},",
              f"  `{' '.join(FLAGS[:5])}`.",
              "- **Cycles**: estimates from the documented timings and a model of the flash ([bench.md](../docs/bench.md#how-it-is-counted)).",
              "  Not measured on a chip.",
              "- **Error**: the largest one of a duty, against double precision. One LSB is 2^-24.",
              "- **Limits** of voltage and integrators are compiled in, but no input reaches one.",
              "- **moteus** takes sine and cosine from the STM32G4's CORDIC. Memory replaces its registers: the wait for its result is in no column,",
              "  and its error is that of exact values rounded to Q31. Modulation and limits are in a class that needs the whole firmware. The rows",
              "  have this project's version of them ([moteus.cpp](peers/moteus.cpp)).",
              "- **CMSIS-DSP** has no modulator and no limits. Its rows have this project's modulation.", ""]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--peers", action="store_true", help="this command")
    parser.add_argument("--cmsis", type=pathlib.Path, metavar="DIR", help="CMSIS-DSP's sources")
    parser.add_argument("--moteus", type=pathlib.Path, metavar="DIR", help="moteus' sources")
    parser.add_argument("--write", action="store_true", help="write bench/peers.md")
    parser.add_argument("--json", type=pathlib.Path, metavar="F", help="write the rows to F")
    options = parser.parse_args()
    rows = []
    for peer in peers(options):
        with tempfile.TemporaryDirectory(prefix="iqfoc-peers-") as folder:
            rows.append(measure(peer, pathlib.Path(folder)))
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    text = page(rows)
    if options.write:
        (HERE / "peers.md").write_text(text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
