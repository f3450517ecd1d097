#!/usr/bin/env python3
"""
Counts instructions for one core with any compiler flags: the benchmark, or your own kernel.

    ./dev bench --core m4 --cflags "-O3" --kernel mine.c --json counts.json

A kernel is a C file with `void bench_kernel(const bench_input_t *input)` (bench/inputs.h); it is counted over the 4,096 inputs. --cflags
gives all compiler flags (default -O2).
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

import elf32

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
INPUTS = 4096
TIME_LIMIT_S = 1200

ARM_QEMU = ["qemu-system-arm", "-M", "mps2-an386", "-semihosting-config", "enable=on,target=native", "-icount", "shift=10"]
RV_QEMU = ["qemu-system-riscv32", "-M", "virt", "-bios", "none", "-icount", "shift=0"]


def arm(cpu):
    """Code for an Arm core. The emulated Cortex-M4 has every integer instruction of Cortex-M0 to M7 and M33."""
    return {"compiler": "arm-none-eabi-gcc", "always": [f"-mcpu={cpu}", "-mthumb", "-mfloat-abi=soft"], "port": "cortex-m4",
            "harness": ["startup.c", "console.c", "semihost_call.c"], "link": ["-nostartfiles", "--specs=nano.specs"],
            "compile": [], "qemu": ARM_QEMU}


def riscv(isa):
    return {"compiler": "riscv64-unknown-elf-gcc", "always": [f"-march={isa}_zicsr", "-mabi=ilp32", "-mcmodel=medany"],
            "port": "rv32", "harness": ["startup.S", "trap.c", "console.c", "semihost_call.S"],
            "link": [f"-march={isa}", "-nostartfiles", "--specs=picolibc.specs", "-Wl,--no-warn-rwx-segments"],
            "compile": ["--specs=picolibc.specs"], "qemu": RV_QEMU}


CORES = {
    "m0plus": arm("cortex-m0plus"), "m3": arm("cortex-m3"), "m4": arm("cortex-m4"), "m7": arm("cortex-m7"),
    "m33": arm("cortex-m33"), "rv32": riscv("rv32im"), "rv32imc": riscv("rv32imc"),
}


def refuse(text):
    print(f"./dev bench: {text}", file=sys.stderr)
    raise SystemExit(2)


def build(core, flags, kernel, folder):
    """The image, and the objects of the library. If a source does not compile: the compiler's message and exit status 2."""
    port = ROOT / "port" / core["port"]
    emulated = ROOT / "port/emulated"
    program = [HERE / name for name in ("inputs.c", "kernel_main.c")] + [kernel] if kernel else [
        HERE / name for name in ("main.c", "services.c", "inputs.c", "kernels.c", "drives.c", "handler.c")] + [
        ROOT / "port/stm32g4/hal_stm32g4.c"]
    library = sorted((ROOT / "src").glob("*.c"))
    sources = program + library + [port / name for name in core["harness"]] + [
        emulated / "console.c", emulated / "semihost.c"]
    include = [f"-I{path}" for path in (ROOT / "include", HERE, port, emulated, ROOT / "port/stm32g4")]
    image = folder / "bench.elf"
    objects = []
    for number, source in enumerate(sources):
        objects.append(folder / f"{number}.o")
        command = [core["compiler"], *core["always"], "-ffunction-sections", "-fdata-sections", *flags, *core["compile"],
                   *include, "-c", source, "-o", objects[-1]]
        if subprocess.run(command, check=False).returncode:
            refuse(f"{source} does not compile with {' '.join(flags)}")
    command = [core["compiler"], *core["always"], *flags, *core["link"], *objects, "-Wl,--gc-sections", f"-T{port / 'link.ld'}",
               "-o", image]
    if subprocess.run(command, check=False).returncode:
        refuse(f"the image does not link with {' '.join(flags)}")
    return image, objects[len(program):len(program) + len(library)]


def count(core, image):
    """{function: (min, mean, max)}."""
    command = core["qemu"] + ["-display", "none", "-monitor", "none", "-serial", "stdio", "-kernel", str(image)]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=TIME_LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        raise SystemExit(f"no end after {TIME_LIMIT_S} s")
    lines = done.stdout.decode(errors="replace").replace("\r", "").split("\n")
    if done.returncode != 0 or "end" not in lines:
        raise SystemExit(f"the emulator ended with status {done.returncode}: the image uses a device that it does not have\n"
                         + "\n".join(lines[-5:]))
    rows = [line.split() for line in lines]
    return [{"function": r[0], "min": int(r[1]), "mean": round(int(r[2]) / INPUTS, 2), "max": int(r[3])}
            for r in rows if len(r) == 4]


def costs(name, functions):
    """{function: mean instructions} on a core at -O2, and "code": bytes of code of the whole library."""
    core = CORES[name]
    with tempfile.TemporaryDirectory(prefix="iqfoc-bench-") as folder:
        image, library = build(core, ["-O2"], None, pathlib.Path(folder))
        rows = count(core, image)
        code = sum(section.size for path in library for section in elf32.read(path).sections if section.flags & elf32.SHF_EXECINSTR)
    return {**{row["function"]: row["mean"] for row in rows if row["function"] in functions}, "code": code}


def main():
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--core", required=True, help=", ".join(CORES))
    parser.add_argument("--cflags", default="-O2", metavar="FLAGS", help="all flags for the compiler (default: -O2)")
    parser.add_argument("--kernel", type=pathlib.Path, metavar="FILE.c", help="count this file's bench_kernel alone")
    parser.add_argument("--json", type=pathlib.Path, metavar="F", help="write the counts to F, keyed by the core")
    options = parser.parse_args()
    if options.core not in CORES:
        refuse(f"--core {options.core}: QEMU cannot count instructions of it here; it can of {', '.join(CORES)}")
    if options.kernel and not options.kernel.is_file():
        refuse(f"--kernel {options.kernel}: no such file")
    core = CORES[options.core]
    with tempfile.TemporaryDirectory(prefix="iqfoc-bench-") as folder:
        image, _ = build(core, shlex.split(options.cflags), options.kernel and options.kernel.resolve(), pathlib.Path(folder))
        rows = count(core, image)
    print(f"{options.core}, {options.cflags}: instructions a call")
    for row in rows:
        print("  {function:26} {min:6} {mean:10.1f} {max:6}".format(**row))
    if options.json:
        options.json.write_text(json.dumps({options.core: rows}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
