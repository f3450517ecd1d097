#!/usr/bin/env python3
"""
Counts clock cycles of the benchmark's functions on open RV32 cores, simulated from their sources by Verilator.

    ./dev bench --rtl                           cv32e40p and picorv32, as PyPI has them
    ./dev bench --rtl --write                   the same, into the table of docs/bench.md
    ./dev bench --rtl --cv32e40p DIR            that core from a checkout: DIR has cv32e40p_manifest.flist
    ./dev bench --rtl --picorv32 DIR            DIR has picorv32.v

The memory has no wait states. This tree holds no core's sources.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import core as emulated

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
from marked import with_table

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
RTL = HERE / "rtl"
PYPI = ROOT / ".cache/python/cores/lib"
INPUTS = 64
PAGE = ROOT / "docs/bench.md"
# Which of the benchmark's rows the page shows.
ROWS = ["isr_cycle", "sample_to_duty", "isr_exact", "current_control", "modulation", "sincos", "div"]
FLAGS = ["--binary", "-O3", "--x-assign", "fast", "--x-initial", "fast", "--no-assert", "-Wno-fatal", "-Wno-lint", "-Wno-style",
         "-Wno-BLKANDNBLK"]  # of counters that the image does not read


def refuse(text):
    print(f"./dev bench --rtl: {text}", file=sys.stderr)
    raise SystemExit(2)


def cv32e40p(folder):
    """The core's sources in the order of its own list, and what else Verilator is to know."""
    manifest = folder / "cv32e40p_manifest.flist"
    if not manifest.is_file():
        refuse(f"{folder} has no {manifest.name}")
    lines = [line.strip().replace("${DESIGN_RTL_DIR}", str(folder / "rtl")) for line in manifest.read_text().splitlines()]
    sources = [line for line in lines if line.endswith(".sv") and "tracer" not in line and "tb_wrapper" not in line]
    return ["-DCV32E40P", *(line for line in lines if line.startswith("+incdir")), *sources]


def picorv32(folder):
    source = folder / "picorv32.v"
    if not source.is_file():
        refuse(f"{folder} has no {source.name}")
    return [str(source)]


# Sources, and their place in the package from PyPI.
CORES = {"cv32e40p": (cv32e40p, "system_verilog"), "picorv32": (picorv32, "verilog")}


def sources_of(name, given):
    """What Verilator is to read, from the folder given or PyPI's package."""
    of_folder, inside = CORES[name]
    places = [given] if given else sorted(PYPI.glob(f"python*/site-packages/pythondata_cpu_{name}/{inside}"))
    if not places:
        refuse(f"no sources of {name}; --{name} DIR says where they are")
    return of_folder(places[0].resolve())


def image(folder):
    """The benchmark for a core with a memory from 8000_0000 on, as words for $readmemh."""
    target = emulated.riscv("rv32im")
    target["harness"] = ["startup.S", RTL / "board.c"]
    target["compile"] += [f"-I{RTL}", "-DWITHOUT_TRAPS", "-DIQFOC_BENCH_CYCLES", f"-DBENCH_INPUT_COUNT={INPUTS}"]
    elf, _ = emulated.build(target, ["-O2"], None, folder)
    flat = folder / "image.bin"
    subprocess.run(["riscv64-unknown-elf-objcopy", "-O", "binary", elf, flat], check=True)
    code = flat.read_bytes()
    code += bytes(-len(code) % 4)
    (folder / "image.hex").write_text("".join(f"{int.from_bytes(code[k:k + 4], 'little'):08x}\n" for k in range(0, len(code), 4)))


def count(name, sources, folder):
    """{function: mean cycles} of the image in the folder."""
    command = ["verilator", *FLAGS, "--top-module", "bench", "--Mdir", name, *sources, str(RTL / "bench.sv")]
    built = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if built.returncode:
        refuse(f"Verilator does not build {name}:\n" + built.stderr[-2000:])
    ran = subprocess.run([folder / name / "Vbench"], cwd=folder, capture_output=True, text=True, check=False)
    rows = [line.split() for line in ran.stdout.splitlines()]
    if ["exit", "0"] not in rows:
        refuse(f"the program on {name} did not end:\n" + ran.stdout[-500:])
    return {row[0]: int(row[2]) / INPUTS for row in rows if len(row) == 4 and row[1].isdigit()}


def main():
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--rtl", action="store_true", help="this command")
    for name in CORES:
        parser.add_argument(f"--{name}", type=pathlib.Path, metavar="DIR", help=f"sources of {name} (default: PyPI's)")
    parser.add_argument("--write", action="store_true", help="write the table of docs/bench.md")
    parser.add_argument("--json", type=pathlib.Path, metavar="F", help="write all rows to F")
    options = parser.parse_args()
    if not shutil.which("verilator"):
        refuse("needs Verilator (Debian: verilator)")
    sources = {name: sources_of(name, getattr(options, name)) for name in CORES}
    with tempfile.TemporaryDirectory(prefix="iqfoc-rtl-") as work:
        folder = pathlib.Path(work)
        image(folder)
        cycles = {name: count(name, sources[name], folder) for name in CORES}
    if options.json:
        options.json.write_text(json.dumps(cycles, indent=1) + "\n")
    table = [f"| row | {' | '.join(f'cycles, {name}' for name in CORES)} |", "| --- |" + " ---: |" * len(CORES)]
    table += [f"| `{row}` | {' | '.join(f'{cycles[name][row]:.0f}' for name in CORES)} |" for row in ROWS]
    print("\n".join(table))
    if options.write:
        PAGE.write_text(with_table(PAGE.read_text(), "rtl", "\n".join(table)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
