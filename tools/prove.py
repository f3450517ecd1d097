#!/usr/bin/env python3
"""Proves by Frama-C's EVA that the library has no undefined behaviour, for all inputs that its headers allow.

Each function prove_* in tests/prove calls library functions with every value of their documented range at once. An alarm is a
place where a signed sum may overflow, a shift be beyond the width, an index out of bounds, a division be by zero, or a value be
cut. What is left open stands in tests/prove/open.txt with its reason, and must be just that. The functions planted_* must alarm.

    tools/prove.py            proves, and compares with the table in docs/proofs.md
    tools/prove.py --write    writes the table
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests/prove"
PAGE = ROOT / "docs/proofs.md"
START, END = "<!-- proofs: begin -->", "<!-- proofs: end -->"
TIME_LIMIT_S = 600
# 32-bit int as on the targets; downcasts that cut count as alarms; the library's plain C in place of a target's instructions.
EVA = ["frama-c", "-eva", "-machdep", "gcc_x86_32", "-eva-precision", "7", "-eva-domains", "symbolic-locations", "-warn-signed-downcast",
       "-eva-no-show-progress", "-cpp-extra-args=-std=c99 -Iinclude -Isrc -Itests/prove -DIQFOC_TARGET_HEADER='<stdint.h>'"]
FUNCTION = re.compile(r"^/\* (.*?) \*/\nvoid ((?:prove|planted)_\w+)\(void\)", re.MULTILINE | re.DOTALL)


def functions():
    """(source, function, its words) in the files' order."""
    found = []
    for source in ("numbers", "prediction", "around", "planted"):
        path = FOLDER / f"{source}.c"
        found += [(path, name, " ".join(words.split())) for words, name in FUNCTION.findall(path.read_text())]
    return found


def alarms(source, function):
    """Their number, and the text of the analysis. Ends the program where the analysis did not end well."""
    library = sorted((ROOT / "src").glob("*.c"))
    done = subprocess.run([*EVA, "-main", function, str(source), *map(str, library)], cwd=ROOT, text=True, capture_output=True,
                          timeout=TIME_LIMIT_S, check=False)
    count = re.search(r"^  (\d+|No) alarms? generated", done.stdout, re.MULTILINE)
    reached = re.search(r"(\d+) functions? analyzed", done.stdout)
    if done.returncode != 0 or count is None or reached is None or int(reached[1]) < 2:
        sys.exit(f"{function}: the analysis failed\n{done.stdout[-3000:]}{done.stderr[-1000:]}")
    return 0 if count[1] == "No" else int(count[1]), done.stdout


def left_open():
    lines = [line for line in (FOLDER / "open.txt").read_text().split("\n") if line and not line.startswith("#")]
    return {name: (int(count), reason) for name, count, reason in (line.split(" ", 2) for line in lines)}


def main():
    allowed = left_open()
    rows = ["| proved for | result |", "| --- | --- |"]
    wrong = []
    for source, function, words in functions():
        count, text = alarms(source, function)
        planted = function.startswith("planted_")
        expected, reason = allowed.pop(function, (0, ""))
        good = count > 0 if planted else count == expected
        print(f"{'ok  ' if good else 'FAIL'}  {function}: {count} alarm{'s' if count != 1 else ''}", flush=True)
        if not good:
            places = re.findall(r"\[eva:alarm\] (\S+): Warning: *\n *(.*)", text)
            wrong += [f"  {function}: {place} {what}" for place, what in places] or [f"  {function}: no alarm"]
        if not planted:
            rows.append(f"| {words} | {'no alarm' if count == 0 else f'open, {count}: {reason}'} |")
    wrong += [f"  open.txt names {name}, which there is not" for name in allowed]
    table = "\n".join(rows)
    page = PAGE.read_text()
    new = page[:page.index(START) + len(START)] + "\n" + table + "\n" + page[page.index(END):]
    if "--write" in sys.argv[1:]:
        PAGE.write_text(new)
    elif new != page:
        wrong.append("  the table in docs/proofs.md is another: tools/prove.py --write")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
