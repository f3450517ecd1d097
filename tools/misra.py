#!/usr/bin/env python3
"""MISRA C:2023 over include/ and src/, and lines, complexity and bytes of each function.

    misra.py write     writes the page with every place and function to build/misra.md, the counts to tools/misra.txt, and the
                       summary to docs/misra.md
    misra.py page      writes build/misra.md alone
    misra.py check     exit status 1 if the counts or the summary are not those of the sources
    misra.py list      each place: file, line, guideline

cppcheck's addon checks the guidelines, as for a Cortex-M4. tools/misra.txt is the budget: class, places and reason of each guideline
that is departed from. tools/misra_2023.txt lists the later amendments, which the addon does not know, and how each is met; a construct
that it calls absent is searched for in the code. lizard (.cache/python/checks) gives lines and complexity, the Cortex-M4 build
(build/cortex-m4) gives bytes.
"""

import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from marked import with_table

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/misra.md"
WHOLE = ROOT / "build/misra.md"
REASONS = ROOT / "tools/misra.txt"
LATER = ROOT / "tools/misra_2023.txt"
LIBRARY = ROOT / "build/cortex-m4/src/libiqfoc.a"
LIZARD = ROOT / ".cache/python/checks/bin/lizard"
# What gcc defines for a Cortex-M4, as far as the library's headers ask.
TARGET = ["-DDBL_MANT_DIG=53", "-D__STDC_VERSION__=199901L", "-D__GNUC__=12", "-D__arm__", "-D__ARM_ARCH=7", "-D__ARM_FEATURE_DSP=1",
          "-UIQFOC_TARGET_HEADER"]
FOUND = re.compile(r"^([^:\n]+):(\d+):\d+: .*\[misra-c2012-([0-9.]+)\]$", re.MULTILINE)
# Cyclomatic complexity above which a function is named in the summary.
COMPLEX = 15


def findings():
    """[(file, line, guideline)], each place once."""
    command = ["cppcheck", "--quiet", "--addon=misra", "--enable=style", "--std=c99", "-I", "include", *TARGET,
               f"-j{os.cpu_count()}", "src"]
    # cppcheck writes next to each source, which others may be copying.
    with tempfile.TemporaryDirectory() as copy:
        for folder in ("src", "include"):
            shutil.copytree(ROOT / folder, pathlib.Path(copy, folder))
        done = subprocess.run(command, cwd=copy, check=True, capture_output=True, text=True)
    broken = [line for line in done.stderr.split("\n") if "preprocessorErrorDirective" in line or "syntaxError" in line]
    if broken:
        sys.exit("cppcheck cannot read the sources:\n" + "\n".join(broken))
    return sorted({(file, int(line), rule) for file, line, rule in FOUND.findall(done.stderr)})


def budget():
    """{guideline: (class, places, reason)}."""
    lines = [line.split(" ", 3) for line in REASONS.read_text(encoding="utf-8").split("\n") if line and not line.startswith("#")]
    return {rule: (kind, int(places), reason) for rule, kind, places, reason in lines}


def order(rule):
    return [int(part) for part in rule.split(".")]


def counts(found):
    """{guideline: places}, in the order of the guidelines; ends if the budget has no reason for one, or a reason without a place."""
    known = budget()
    rules = sorted({rule for _, _, rule in found}, key=order)
    unknown = [rule for rule in rules if rule not in known]
    if unknown:
        places = [f"{file}:{line}: {rule}" for file, line, rule in found if rule in unknown]
        sys.exit("tools/misra.txt gives no reason for\n" + "\n".join(places))
    stale = sorted(set(known) - set(rules), key=order)
    if stale:
        sys.exit(f"tools/misra.txt gives reasons for guidelines that the library meets: {', '.join(stale)}")
    return {rule: sum(other == rule for _, _, other in found) for rule in rules}


def with_counts(text, seen):
    """The budget's text with these numbers of places."""
    return re.sub(r"^([\d.]+ \w+) \d+ ", lambda line: f"{line[1]} {seen[line[1].split()[0]]} ", text, flags=re.MULTILINE)


def misra_table(found):
    lines = ["| guideline | class | places | where | why |", "| --- | --- | ---: | --- | --- |"]
    for rule, places in counts(found).items():
        kind, _, reason = budget()[rule]
        files = [file for file, _, other in found if other == rule]
        where = ", ".join(f"{pathlib.PurePath(file).name}{f' ({files.count(file)})' if files.count(file) > 1 else ''}"
                          for file in dict.fromkeys(files))
        lines.append(f"| {rule} | {kind} | {places} | {where} | {reason} |")
    return "\n".join(lines)


def code_of(file):
    """The code without comments and string literals."""
    return re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"', lambda found: "\n" * found[0].count("\n"), file.read_text(encoding="utf-8"), flags=re.DOTALL)


def later_table():
    """The amendments' guidelines; ends if the code has a construct that the list calls absent."""
    rows = [line.split(" :: ") for line in LATER.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    code = {file: code_of(file) for folder in ("include", "src") for file in sorted((ROOT / folder).rglob("*.[ch]"))}
    wrong = []
    for guidelines, _, _, _, absent in rows:
        for file, text in code.items() if absent != "-" else ():
            wrong += [f"{file.relative_to(ROOT)}:{text.count(chr(10), 0, found.start()) + 1}: {guidelines}: {found[0]}"
                      for found in re.finditer(absent, text)]
    if wrong:
        sys.exit("tools/misra_2023.txt calls absent:\n" + "\n".join(wrong))
    lines = ["| guidelines | since | about | how they are met |", "| --- | --- | --- | --- |"]
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


def function_table(listed):
    size = sizes()
    lines = ["| function | file | lines | complexity | bytes |", "| --- | --- | ---: | ---: | ---: |"]
    for file, name, length, complexity in listed:
        lines.append(f"| `{name}` | {file} | {length} | {complexity} | {size.get((file, name), 'inlined')} |")
    return "\n".join(lines)


def summary(seen, listed):
    """The table of docs/misra.md."""
    classes = {rule: kind for rule, (kind, _, _) in budget().items()}
    lines = ["| class | guidelines departed from | places |", "| --- | ---: | ---: |"]
    for kind in ("mandatory", "required", "advisory"):
        places = [number for rule, number in seen.items() if classes[rule] == kind]
        lines.append(f"| {kind} | {len(places)} | {sum(places)} |")
    high = sorted(((complexity, name) for _, name, _, complexity in listed if complexity > COMPLEX), reverse=True)
    return "\n".join(lines + ["", f"{len(listed)} functions; cyclomatic complexity above {COMPLEX}: "
                              + (", ".join(f"`{name}` ({complexity})" for complexity, name in high) or "none") + "."])


def whole_page(found, listed):
    """The page with every place and function."""
    return f"""# MISRA C:2023: every departure and every function

For readers who assess the library: each guideline that the library departs from, with the files and the reason, then each function with
its size. `./dev misra` writes this page. [MISRA C:2023](misra.md) says how it is checked and what is not covered.

## Departures

{len(found)} places. `tools/misra.py list` prints file and line of each.

{misra_table(found)}

## Guidelines of the amendments

cppcheck does not know the guidelines that amendments 1 to 4 and corrigendum 2 added or changed. The table gives each in our words, and
how the library meets it. `tools/misra.py` searches the code for every construct that the table calls absent.

{later_table()}

## Functions

Lines and cyclomatic complexity are lizard's. Bytes are those of the code at `-O2` for a Cortex-M4. *Inlined*: the function has no code
of its own.

{function_table(listed)}
"""


def main():
    task = sys.argv[1] if len(sys.argv) == 2 else ""
    if task not in ("write", "page", "check", "list"):
        print("expected write, page, check or list", file=sys.stderr)
        return 2
    if task in ("write", "page") and not LIBRARY.exists():
        print(f"{LIBRARY.relative_to(ROOT)} is missing: `./dev misra` builds it", file=sys.stderr)
        return 2
    found = findings()
    if task == "list":
        print("\n".join(f"{file}:{line}: {rule}" for file, line, rule in found))
        return 0
    seen, listed = counts(found), functions()
    if task != "check":
        WHOLE.write_text(whole_page(found, listed), encoding="utf-8")
        print(f"{WHOLE.relative_to(ROOT)}: every departure and every function")
    if task == "page":
        return 0
    later_table()
    made = {REASONS: with_counts(REASONS.read_text(encoding="utf-8"), seen),
            PAGE: with_table(PAGE.read_text(encoding="utf-8"), "misra", summary(seen, listed))}
    if task == "write":
        for file, text in made.items():
            file.write_text(text, encoding="utf-8")
        return 0
    known = budget()
    wrong = [f"{rule}: {places} places, the budget has {known[rule][1]}" for rule, places in seen.items() if places != known[rule][1]]
    if made[PAGE] != PAGE.read_text(encoding="utf-8"):
        wrong.append("docs/misra.md: the summary differs")
    print("\n".join(wrong) or f"{len(found)} places, as tools/misra.txt and docs/misra.md have them")
    if wrong:
        print("`tools/misra.py list` names the places; `./dev misra` writes the new counts")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
