#!/usr/bin/env python3
"""Certifies the error bounds in LSB that the public headers state, and compares the table in docs/proofs.md with them.

A claim is shown in one of three ways:

    proof         a Gappa script in tests/prove/bounds. A goal bears the claims that it proves in comments above it:
                  "# header.h: words of the header".
    enumeration   a test that goes through all inputs: tests/prove/bounds/shown.txt
    drawn         a test that draws inputs. The header says so by the word "drawn", and how many; the same file.

Each number of LSB in a comment of include/iqfoc must stand within the words of a claim, and each claim in its header.

    tools/bounds.py            proves, and compares with the table
    tools/bounds.py --check    compares alone: nothing is run
    tools/bounds.py --write    proves, and writes the table
"""
import concurrent.futures
import math
import os
import pathlib
import re
import subprocess
import sys

from marked import with_table

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests/prove/bounds"
PAGE = ROOT / "docs/proofs.md"
LIMIT_S, PLANTED_LIMIT_S = 60, 3
CLAIM = re.compile(r"^# (\w+\.h): (.*)$", re.MULTILINE)
STATED = re.compile(r"[0-9)] LSB|[0-9)] unit where")


def comments(header):
    """The comments of a header, a blank for whatever parts their words."""
    text = (ROOT / "include/iqfoc" / header).read_text()
    found = [re.sub(r"\s+", " ", re.sub(r"\n\s*\*", " ", comment)) for comment in re.findall(r"/\*(.*?)\*/", text, re.DOTALL)]
    return " | ".join(found)


def scripts():
    return sorted(path for path in FOLDER.glob("*.g") if path.stem != "planted")


def other_claims():
    """(header, words, how, test, what else) of shown.txt."""
    lines = (FOLDER / "shown.txt").read_text().splitlines()
    return [[part.strip() for part in line.split(" :: ")] for line in lines if line and not line.startswith("#")]


def tests():
    names = set()
    for folder in ("tests", "sim_host", "port", "tools"):
        for path in (ROOT / folder).rglob("CMakeLists.txt"):
            names |= set(re.findall(r"NAME (\w+)", path.read_text()))
            for part in re.findall(r"foreach\(part ([\w ]+)\)", path.read_text()):
                names |= set(part.split())
    return names


def confidence(draws):
    """Drawn so often without one beyond: what share of inputs may be, with 99.9 % confidence."""
    share = f"{-math.log(0.001) / draws:.1e}".replace("e-0", "e-")
    return f"{draws} drawn, none beyond: with 99.9 % confidence fewer than {share} of such draws are"


def rows_and_mistakes():
    rows, wrong, stated = [], [], {}
    known = tests()
    for path in scripts():
        for header, words in CLAIM.findall(path.read_text()):
            rows.append((header, words, f"proof: [{path.name}](../tests/prove/bounds/{path.name})"))
    for claim in other_claims():
        if len(claim) != 5:
            wrong.append(f"shown.txt: {' :: '.join(claim)}: five parts are wanted")
            continue
        header, words, how, test, more = claim
        if test != "-" and test not in known:
            wrong.append(f"shown.txt: {header}: there is no test {test}")
        if how == "drawn":
            if "drawn" not in words:
                wrong.append(f"{header} does not say that this is only drawn: {words}")
            source = (ROOT / f"tests/unit/library/test_{test}.c").read_text()
            if not re.search(rf"\b{more}\b", source):
                wrong.append(f"shown.txt: {header}: tests/unit/library/test_{test}.c does not draw {more}")
            rows.append((header, words, f"{confidence(int(more))} (`{test}`)"))
        elif how in ("enumeration", "by definition", "argument"):
            rows.append((header, words, f"{how}: {more}" + (f" (`{test}`)" if test != "-" else "")))
        else:
            wrong.append(f"shown.txt: {header}: what is {how}?")
    for header, words, _ in rows:
        stated.setdefault(header, []).append(words)
    for path in sorted((ROOT / "include/iqfoc").glob("*.h")):
        text = comments(path.name)
        covered = [False] * len(text)
        for words in stated.get(path.name, []):
            at = text.find(words)
            if at < 0:
                wrong.append(f"{path.name} does not say: {words}")
            while at >= 0:
                covered[at:at + len(words)] = [True] * len(words)
                at = text.find(words, at + 1)
        wrong += [f"{path.name}: nothing shows: ...{text[max(0, m.start() - 60):m.end() + 20]}..."
                  for m in STATED.finditer(text) if not covered[m.start()]]
    return sorted(rows), wrong


def gappa(text, limit_s):
    """Whether it proves all of it; and what it has against it, a hint that is no identity above all."""
    try:
        done = subprocess.run(["gappa"], input=text, text=True, capture_output=True, timeout=limit_s, check=False)
    except subprocess.TimeoutExpired:
        return False, "no end"
    against = [line for line in done.stderr.splitlines() if "assumed to be nonzero" not in line and "no need for" not in line]
    return done.returncode == 0 and not against, "\n".join(against[:5])


def one_goal(text, number):
    """The script with the goal of this number alone, its bound a quarter; None where it has none."""
    begin = text.index("->") + 2
    end = text.index("\n}", begin)
    goals = [line.strip() for line in text[begin:end].splitlines() if line.strip() and not line.strip().startswith("#")]
    goals = [goal for goal in goals if re.search(r" <= [0-9.]+$", goal)]
    if number >= len(goals):
        return None
    goal = goals[number].removeprefix("/\\").strip()
    term, bound = goal.rsplit(" <= ", 1)
    return f"{text[:begin]} {term} <= {float(bound) / 4:.9f}{text[end:]}"


def prove(path):
    text = path.read_text()
    good, against = gappa(text, LIMIT_S)
    if path.stem == "planted":
        return [] if not good else [f"{path.name}: a wrong bound is proved"]
    wrong = [] if good else [f"{path.name}: not proved\n{against}"]
    # A script whose hypotheses contradict each other would prove anything.
    planted = one_goal(text, 0)
    if planted is not None and gappa(planted, PLANTED_LIMIT_S)[0]:
        wrong.append(f"{path.name}: proves a quarter of its bound as well: what does it say?")
    return wrong


def main():
    rows, wrong = rows_and_mistakes()
    if "--check" not in sys.argv[1:]:
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("IQFOC_JOBS", os.cpu_count() or 1))) as pool:
            for path, found in zip(sorted(FOLDER.glob("*.g")), pool.map(prove, sorted(FOLDER.glob("*.g")))):
                print(f"{'FAIL' if found else 'ok  '}  {path.name}", flush=True)
                wrong += found
    table = "\n".join(["| header | claim | shown by |", "| --- | --- | --- |",
                       *(f"| {header} | {words.replace('|', chr(92) + '|')} | {how} |" for header, words, how in rows)])
    page = PAGE.read_text()
    new = with_table(page, "bounds", table)
    if "--write" in sys.argv[1:] and not wrong:
        PAGE.write_text(new)
    elif new != page:
        wrong.append("the table in docs/proofs.md is another: tools/bounds.py --write")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
