#!/usr/bin/env python3
"""MISRA C:2023 over include/ and src/, and a size and complexity for each function: docs/misra.md.

    misra.py write     writes the page
    misra.py check     exit status 1 where the page is not what the sources give
    misra.py list      each place: file, line, guideline

The guidelines are checked by cppcheck's addon, as for a Cortex-M4; tools/misra.txt has the class and the reason of each that is
departed from. What the addon has not, the standard's later amendments, stands in tools/misra_2023.txt with how each is met, and what must
not be in the code for it is looked for. Complexity is lizard's (.cache/python/checks), size that of the Cortex-M4 build (build/cortex-m4).
"""

import csv
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/misra.md"
REASONS = ROOT / "tools/misra.txt"
LATER = ROOT / "tools/misra_2023.txt"
LIBRARY = ROOT / "build/cortex-m4/src/libiqfoc.a"
LIZARD = ROOT / ".cache/python/checks/bin/lizard"
# What gcc defines for a Cortex-M4, as far as the library's headers ask.
TARGET = ["-DDBL_MANT_DIG=53", "-D__STDC_VERSION__=199901L", "-D__GNUC__=12", "-D__arm__", "-D__ARM_ARCH=7", "-D__ARM_FEATURE_DSP=1",
          "-UIQFOC_TARGET_HEADER"]
FOUND = re.compile(r"^([^:\n]+):(\d+):\d+: .*\[misra-c2012-([0-9.]+)\]$", re.MULTILINE)
# The functions that a reader should look at: above what is usual.
COMPLEX = 15
# How far a function's size may be off: another release of the compiler lays code out otherwise.
SIZE_MARGIN = 0.05


def findings():
    """[(file, line, guideline)], each place once."""
    command = ["cppcheck", "--quiet", "--addon=misra", "--enable=style", "--std=c99", "-I", "include", *TARGET,
               f"-j{os.cpu_count()}", "src"]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    broken = [line for line in done.stderr.split("\n") if "preprocessorErrorDirective" in line or "syntaxError" in line]
    if broken:
        sys.exit("cppcheck cannot read the sources:\n" + "\n".join(broken))
    return sorted({(file, int(line), rule) for file, line, rule in FOUND.findall(done.stderr)})


def reasons():
    """{guideline: (class, reason)}."""
    lines = [line.split(" ", 2) for line in REASONS.read_text(encoding="utf-8").split("\n") if line and not line.startswith("#")]
    return {rule: (kind, reason) for rule, kind, reason in lines}


def order(rule):
    return [int(part) for part in rule.split(".")]


def misra_table(found):
    known = reasons()
    rules = sorted({rule for _, _, rule in found}, key=order)
    unknown = [rule for rule in rules if rule not in known]
    if unknown:
        places = [f"{file}:{line}: {rule}" for file, line, rule in found if rule in unknown]
        sys.exit("tools/misra.txt gives no reason for\n" + "\n".join(places))
    stale = sorted(set(known) - set(rules), key=order)
    if stale:
        sys.exit(f"tools/misra.txt gives reasons for what is no longer departed from: {', '.join(stale)}")
    lines = ["| guideline | class | places | where | why |", "| --- | --- | ---: | --- | --- |"]
    for rule in rules:
        files = [file for file, _, other in found if other == rule]
        where = ", ".join(f"{pathlib.PurePath(file).name}{f' ({files.count(file)})' if files.count(file) > 1 else ''}"
                          for file in dict.fromkeys(files))
        lines.append(f"| {rule} | {known[rule][0]} | {len(files)} | {where} | {known[rule][1]} |")
    return "\n".join(lines)


def code_of(file):
    """Without comments, and without what stands in quotes."""
    return re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"', lambda found: "\n" * found[0].count("\n"), file.read_text(encoding="utf-8"), flags=re.DOTALL)


def later_table():
    """What the amendments brought; ends where the code has what is said to be absent."""
    rows = [line.split(" :: ") for line in LATER.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    code = {file: code_of(file) for folder in ("include", "src") for file in sorted((ROOT / folder).rglob("*.[ch]"))}
    wrong = []
    for guidelines, _, _, _, absent in rows:
        for file, text in code.items() if absent != "-" else ():
            wrong += [f"{file.relative_to(ROOT)}:{text.count(chr(10), 0, found.start()) + 1}: {guidelines}: {found[0]}"
                      for found in re.finditer(absent, text)]
    if wrong:
        sys.exit("not absent, as tools/misra_2023.txt says:\n" + "\n".join(wrong))
    lines = ["| guidelines | since | about | how they stand here |", "| --- | --- | --- | --- |"]
    return "\n".join(lines + [f"| {' | '.join(row[:4])} |" for row in rows])


def functions():
    """[(file, name, lines, complexity)] of each function with a body."""
    files = sorted(str(file.relative_to(ROOT)) for folder in ("include", "src") for file in (ROOT / folder).rglob("*.[ch]"))
    done = subprocess.run([LIZARD, "--csv", "-l", "cpp", *files], cwd=ROOT, check=False, capture_output=True, text=True)
    return sorted((row[6], row[7], int(row[0]), int(row[1])) for row in csv.reader(done.stdout.splitlines()))


def sizes():
    """{(source, function): bytes of its code} in the Cortex-M4 build."""
    done = subprocess.run(["arm-none-eabi-nm", "-A", "--size-sort", "--format=posix", LIBRARY], check=True, capture_output=True,
                          text=True)
    found = re.findall(r"^\S*\[(\S+?)\.o\w*\]: (\w+)\S* [Tt] \w+ (\w+)$", done.stdout, re.MULTILINE)
    return {(f"src/{source}", name): int(size, 16) for source, name, size in found}


def function_table():
    size = sizes()
    lines = ["| function | file | lines | complexity | bytes |", "| --- | --- | ---: | ---: | ---: |"]
    for file, name, length, complexity in functions():
        lines.append(f"| `{name}` | {file} | {length} | {complexity} | {size.get((file, name), 'inlined')} |")
    return "\n".join(lines)


def page():
    found = findings()
    known = reasons()
    table = function_table()
    complexities = [int(row.split("|")[4]) for row in table.split("\n")[2:]]
    required = sum(known[rule][0] == "required" for _, _, rule in found)
    return f"""# MISRA C:2023, and the size of each function

Made by `./dev misra`; `./dev test` fails where it is not what the sources give. Checked is the library, `include/` and `src/`, as a
Cortex-M4 compiles it, by cppcheck's addon, which knows MISRA C:2012 as it was published and a part of its first two amendments; MISRA
C:2023, which is all of it with the amendments 1 to 4 and the corrigenda 1 and 2, keeps the numbers. What that adds and changes is a table
of its own below. The addon needs no text of the standard, and none is given here. clang-tidy reads the same files in CI without a
finding; what it looks for stands in [.clang-tidy](../.clang-tidy). That no behaviour is undefined, which many of the guidelines are for,
is proved: [proofs.md](proofs.md).

## Departures

{len(found)} places, {required} of them of required guidelines, none of a mandatory one. `tools/misra.py list` names each line.

{misra_table(found)}

## What MISRA C:2023 adds

MISRA C:2023 has 221 guidelines: the 159 of 2013 and 62 that the amendments brought. Each of these, and each that a later amendment or
corrigendum 2 changed, in our words and by what it is met; which there are and which changed is taken from what makers of checkers
publish, for the text of the standard is not free. Where something is said to be absent, `tools/misra.py` looks for it in the code.

{later_table()}

## Functions

Lines and cyclomatic complexity by lizard, bytes of code at `-O2` for a Cortex-M4 (inlined: no code of its own). Of {len(complexities)}
functions {sum(c > COMPLEX for c in complexities)} have a complexity above {COMPLEX}; the greatest is {max(complexities)}.

{table}
"""


def differences(there, made):
    """Lines of the page that differ, sizes within the margin apart."""
    def row(line):
        return re.fullmatch(r"(\| `.*) (\d+) \|", line)

    old, new = there.split("\n"), made.split("\n")
    if len(old) != len(new):
        return [f"{len(new)} lines, the page has {len(old)}: " + line for line in sorted(set(new) ^ set(old))[:20]]
    wrong = []
    for before, now in zip(old, new):
        a, b = row(before), row(now)
        if a and b and a[1] == b[1] and abs(int(a[2]) - int(b[2])) <= max(8, SIZE_MARGIN * int(a[2])):
            continue
        if before != now:
            wrong.append(f"{before}\n  is now\n{now}")
    return wrong


def main():
    task = sys.argv[1] if len(sys.argv) == 2 else ""
    if task == "list":
        for file, line, rule in findings():
            print(f"{file}:{line}: {rule}")
        return 0
    if task not in ("write", "check"):
        print("expected write, check or list", file=sys.stderr)
        return 2
    made = page()
    if task == "write":
        PAGE.write_text(made, encoding="utf-8")
        return 0
    wrong = differences(PAGE.read_text(encoding="utf-8"), made)
    print("\n".join(wrong) or "docs/misra.md is as the sources are")
    if wrong:
        print("./dev misra writes docs/misra.md anew")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
