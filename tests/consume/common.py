"""What the checks of this folder share: how a command is run, and how one fails."""
import pathlib
import re
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
INCLUDE = ROOT / "include"
SOURCES = sorted((ROOT / "src").glob("*.c"))
PROGRAM = HERE / "every_header.c"
BOARD = HERE / "board"
QEMU_ARM = ["qemu-system-arm", "-M", "mps2-an386", "-semihosting-config", "enable=on,target=native", "-display", "none",
            "-monitor", "none", "-serial", "stdio"]
QEMU_RV32 = ["qemu-system-riscv32", "-M", "virt", "-bios", "none", "-display", "none", "-monitor", "none", "-serial", "stdio"]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror"]
BARE = ["-ffreestanding", "-ffunction-sections", "-fdata-sections", "-O2"]
TIME_LIMIT_S = 1200


class Failed(Exception):
    """What a check says when it fails."""


def run(command, status=0, **more):
    """The output of a command that must end with this status (None: with any but 0)."""
    done = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", timeout=TIME_LIMIT_S, check=False, **more)
    good = done.returncode != 0 if status is None else done.returncode == status
    if not good:
        raise Failed(f"{' '.join(map(str, command))}\nended with {done.returncode}:\n{done.stdout[-3000:]}")
    return done.stdout


def expect(good, what):
    if not good:
        raise Failed(what)


def cmake(source, build, *options, env=None):
    run(["cmake", "-G", "Ninja", "-S", source, "-B", build, "-DCMAKE_BUILD_TYPE=Release", *options], env=env)
    run(["cmake", "--build", build])


def version_of_the_header():
    return re.search(r'IQFOC_VERSION_STRING "(.*)"', (INCLUDE / "iqfoc/version.h").read_text())[1]
