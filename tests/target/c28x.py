#!/usr/bin/env python3
"""
What a C28x demands of the library and of its port, checked without one: its char has 16 bits and its int 16.

1. No 8-bit type, nothing that depends on the size of a char, no int-sized assumption in a name: a scan of all tokens.
2. Every source compiles without a warning where int has 16 bits (clang for MSP430): a constant or shift that needs a wider
   int is an error there, and so is a conversion that loses bits.
3. examples/template-f280049c builds by its Makefile with a stand-in for TI's compiler, and names the same files in its CCS project.
4. The port's linker command files fit the chips: regions within the memories and apart, each section in one.
The checker is tested on code that it must refuse. Called by tests/target/run.sh.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PORT = ROOT / "port" / "c2000"
SOURCES = sorted((ROOT / "src").glob("*.c")) + sorted(PORT.glob("*.c"))
FILES = SOURCES + sorted((ROOT / "src").glob("*.h")) + sorted((ROOT / "include" / "iqfoc").rglob("*.h")) + sorted(PORT.glob("*.h"))
# RAM and flash of the chips, (first, past the last) word: the data sheets' memory maps, less what prefetch needs at an end.
MEMORIES = {"link_f28004x.cmd": [(0x0, 0x7F8), (0x8000, 0xC000), (0xC000, 0x13FF8), (0x80000, 0x9FFF0), (0x3FFFC0, 0x3FFFC2)],
            "link_f2837xd.cmd": [(0x0, 0x7F8), (0x8000, 0xC000), (0xC000, 0x1BFF8), (0x80000, 0xBFFF0), (0x3FFFC0, 0x3FFFC2)]}
SECTIONS = {"codestart", ".text", ".cinit", ".const", ".switch", ".init_array", ".binit", ".TI.ramfunc", ".stack", ".bss", ".data",
            ".sysmem", ".reset"}

# int itself is allowed nowhere: it has another size on every kind of target.
FORBIDDEN = {"char", "int8_t", "uint8_t", "int_least8_t", "uint_least8_t", "int_fast8_t", "uint_fast8_t", "int_fast16_t",
             "uint_fast16_t", "int_fast32_t", "uint_fast32_t", "sizeof", "CHAR_BIT", "memcpy", "memset", "memcmp", "union",
             "int", "short", "unsigned", "signed", "float", "double"}
# What refuses to compile where constants are not doubles: sizes compared with each other, whatever a char is.
ALLOWED_LINES = (re.compile(r"^(typedef char iq24_assume_\w+\[|static_assert\(|_Static_assert\()"),
                 re.compile(r"^extern cregister volatile unsigned int IER;$"))  # a register of the core: an int by TI's definition
# The one header that computes in floating point, for those who include it: its texts are read by people, and a count of
# elements is the same whatever a char is.
SLOW_HEADER = ROOT / "include" / "iqfoc" / "iqfoc_si.h"
ALLOWED_IN_SLOW = re.compile(r"\bdouble\b|\bconst char \*|\bsizeof (\w+) / sizeof \1\[0\]")
# The option that computes by the TMU.
FLOAT_HEADER = PORT / "iqfoc_tmu.h"
ALLOWED_IN_FLOAT = re.compile(r"\bfloat\b")
COMPILE = ["clang", "--target=msp430", "-std=c99", "-ffreestanding", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic",
           "-Wconversion", "-Wshift-overflow", "-Wconstant-conversion", "-Werror", "-I", str(ROOT / "include"), "-I", str(ROOT / "src")]

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def without_comments(text):
    """The text with comments, strings and the words of #error and #include blanked, and its lines kept."""
    text = re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m.group()), text, flags=re.S)
    return re.sub(r'"[^"\n]*"|^#(error|include).*', " ", text, flags=re.M)


def offences(text):
    """(line number, token) of every forbidden token."""
    found = []
    for number, line in enumerate(without_comments(text).split("\n"), 1):
        if not any(pattern.search(line) for pattern in ALLOWED_LINES):
            found += [(number, word) for word in re.findall(r"[A-Za-z_]\w*", line) if word in FORBIDDEN]
    return found


def compiles(path):
    # A header by itself, as included: what it holds and nobody calls is no mistake.
    unit = ["-include", str(path), "-x", "c", "/dev/null"] if path.suffix == ".h" else [str(path)]
    unit += ["-I", str(ROOT / "tests" / "target" / "iqmath"), '-DIQFOC_IQMATH_HEADER="types.h"']
    if path.name == "tmu_on_host.h":
        unit += ["-I", str(PORT), "-D__TMS320C28XX__"]
    done = subprocess.run(COMPILE + unit, capture_output=True, text=True, check=False)
    return done.returncode == 0, done.stderr


def self_test():
    for line, words in (("uint8_t octet;\n/* int8_t here is prose */", ["uint8_t"]), ("x = sizeof y;", ["sizeof"]),
                        ("q = (unsigned char *)p + 1;", ["unsigned", "char"]), ("n = bits / CHAR_BIT;", ["CHAR_BIT"]),
                        ("memcpy(a, b, n);", ["memcpy"]), ("int k = 0;", ["int"])):
        check([word for _, word in offences(line + "\n")] == words, f"the scan sees {' '.join(words)}")
    with tempfile.TemporaryDirectory() as folder:
        planted = pathlib.Path(folder) / "planted.c"
        for text, what in (("#include <stdint.h>\nint32_t f(void);\nint32_t f(void)\n{\n    return 1 << 20;\n}\n", "a shift beyond 16 bits"),
                           ("#include <stdint.h>\nint32_t f(int32_t x);\nint32_t f(int32_t x)\n{\n    return (int)x;\n}\n"
                            "int g(int32_t x);\nint g(int32_t x)\n{\n    return x;\n}\n", "32 bits kept in an int")):
            planted.write_text(text)
            check(not compiles(planted)[0], f"the compiler refuses {what}")


def linker_faults(text, memories):
    """What is wrong with a linker command file, in words."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    regions = {name: (int(origin, 16), int(origin, 16) + int(length, 16))
               for name, origin, length in re.findall(r"^\s+(\w+)\s*: origin = (\w+), length = (\w+)$", text, flags=re.M)}
    faults = [f"{name} is not within one memory" for name, (first, end) in regions.items()
              if not any(low <= first < end <= high for low, high in memories)]
    ordered = sorted(regions.items(), key=lambda item: item[1])
    faults += [f"{one} and {other} overlap" for (one, (_, end)), (other, (first, _)) in zip(ordered, ordered[1:]) if end > first]
    placed = re.findall(r"^\s+([.\w]+)\s*: (?:> (\w+)|LOAD = (\w+), RUN = (\w+))", text, flags=re.M)
    faults += [f"{name} is in no region" for name, *where in placed if not set(filter(None, where)) <= set(regions)]
    return faults + [f"{name} is placed nowhere" for name in sorted(SECTIONS - {name for name, *_ in placed})]


def check_linker_files():
    for name, memories in MEMORIES.items():
        text = (PORT / name).read_text()
        check(not linker_faults(text, memories), f"{name}: regions and sections fit" + "".join(f"\n        {x}" for x in linker_faults(text, memories)))
        for old, new, what in (("origin = 0x000400", "origin = 0x008000", "overlapping regions"), ("origin = 0x000400", "origin = 0x000500", "a region past its memory"),
                               (".const  ", ".other  ", "a section without a place"), ("> STACK", "> STOCK", "an unknown region")):
            check(old in text and linker_faults(text.replace(old, new), memories), f"{name}: {what} is noticed")


def check_template():
    here = ROOT / "examples" / "template-f280049c"
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder)
        for part in ("src", "include", "port/c2000", "examples/template-f280049c", "examples/template-stm32f405"):
            shutil.copytree(ROOT / part, tree / part)
        work = tree / "examples" / "template-f280049c"
        command = ["make", "-s", "-C", str(work), f"CL={sys.executable} {ROOT}/tests/target/cl2000_stand_in.py"]
        for family in ("f28004x", "f2837xd"):
            done = subprocess.run([*command, f"FAMILY={family}"], capture_output=True, text=True, check=False)
            check(done.returncode == 0 and (work / "build" / "first_drive.out").exists(), f"template-f280049c: builds for {family}\n{done.stderr}".strip())
            shutil.rmtree(work / "build", ignore_errors=True)
        (work / "main.c").write_text((work / "main.c").read_text() + "\nint32_t f(void);\nint32_t f(void)\n{\n    return 1 << 20;\n}\n")
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        check(done.returncode != 0, "template-f280049c: a shift beyond 16 bits does not build")
    files = subprocess.run(["make", "-s", "-C", str(here), "list"], capture_output=True, text=True, check=True).stdout.split()
    project = xml.etree.ElementTree.parse(here / "template_f280049c.projectspec").getroot().find("project")
    named = [file.get("path") for file in project.findall("file")]
    check(sorted(named) == sorted(files), f"template-f280049c: CCS's project names the Makefile's files; they differ in {set(named) ^ set(files)}")
    flags = re.search(r"^FLAGS := (.*?)^vpath", (here / "Makefile").read_text(), flags=re.M | re.S)[1]
    wanted = {word for word in flags.replace("\\\n", " ").split() if not word.startswith("--include_path")}
    check(wanted <= set(project.get("compilerBuildOptions").split()), "template-f280049c: CCS's project has the Makefile's options")
    board = (here / "main.c").read_text()
    check("volatile bool may_run;" in board and "i_wanted" not in board, "template-f280049c: as printed it does not run, and asks for no current")


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n")[0])
    parser.add_argument("--build", help="not needed")
    parser.parse_args()
    self_test()
    for path in FILES:
        text = path.read_text()
        allowed = {SLOW_HEADER: ALLOWED_IN_SLOW, FLOAT_HEADER: ALLOWED_IN_FLOAT}.get(path)
        found = offences(allowed.sub(" ", text) if allowed else text)
        check(not found, f"{path.relative_to(ROOT)}: no type of 8 bits or of another size" +
              "".join(f"\n        line {number}: {token}" for number, token in found))
    check(not list(re.finditer(r"\b(float|double)\b", "".join(without_comments(path.read_text()) for path in SOURCES))),
          "src/ and port/c2000/*.c: no floating point")
    for path in SOURCES + [SLOW_HEADER, PORT / "iqfoc_iqmath.h", ROOT / "tests/target/tmu/tmu_on_host.h"]:
        good, text = compiles(path)
        check(good, f"{path.relative_to(ROOT)}: compiles where int has 16 bits" + ("\n" + text if not good else ""))
    check_linker_files()
    check_template()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
