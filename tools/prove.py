#!/usr/bin/env python3
"""Proves by Frama-C's EVA that the library has no undefined behaviour, for all inputs that its headers allow.

Each function prove_* in tests/prove calls library functions with every value of their documented range at once. An alarm is a place where
a signed sum may overflow, a shift may exceed the width, an index may be out of bounds, a divisor may be 0, or a conversion may lose bits.
tests/prove/open.txt lists every remaining alarm with its reason. The functions planted_* must raise an alarm. tests/prove/shown.txt names
the script or test that shows each assertion in the library's source, which the analysis only assumes. tests/prove/assembly.txt names each
file with assembly, which the analysis cannot read, and its test.

    tools/prove.py            proves, and compares with the tables in docs/proofs.md
    tools/prove.py --write    writes the tables
    tools/prove.py NAME...    proves these functions alone, and shows their alarms
"""
import collections
import concurrent.futures
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

from marked import with_table

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests/prove"
PAGE = ROOT / "docs/proofs.md"
TIME_LIMIT_S = 1200
# What is parsed together: the functions of tests/prove, and a port where they are of one. In the order of the page.
PROGRAMS = {
    "library": (["numbers", "prediction", "models", "control", "around", "sensors", "recorder", "cycle", "interrupts", "planted"], []),
    "patterns": (["patterns"], []),
    "port": (["ports"], ["port/stm32g4/hal_stm32g4.c"]),
}
# 32-bit int as on the targets; the library's plain C in place of a target's instructions. What each source has of
# a header's functions is merged.
PARSE = ["-machdep", "gcc_x86_32", "-aggressive-merging",
         "-cpp-extra-args=-std=c99 -Iinclude -Isrc -Itests/prove -Iport/stm32g4 -Iexamples/first_drive -Iexamples/corrected_drive"
         " -Dvolatile= -DIQFOC_TARGET_HEADER='<stdint.h>' -DSTM32G4_BUS_HEADER='\"bus.h\"'"]
# Downcasts that cut count as alarms. A set that was refused and one that was taken stay apart after the call that checks it. Few states of
# a leg's edges, and of what it loses, are kept apart, as any may come after any.
EVA = ["-eva", "-eva-split-return-function", "iqfoc_cycle_init_named:0", "-eva-domains", "symbolic-locations",
       "-eva-slevel-function", "move_edges:1,step_leg:1,move_leg:1,find_error:0,loss_of_leg:1,iqfoc_sensorless_acting:1", "-warn-signed-downcast",
       "-eva-no-show-progress"]
# Any precision proves: a higher one raises fewer alarms that are none, and takes longer. For an alarm or an assertion these need more
# than the least.
PRECISION = 4
NEED = {
    **dict.fromkeys(["prove_offset", "prove_pattern", "prove_pattern_control_init", "prove_pulse_mode_init"], 5),
    **dict.fromkeys(["prove_overmodulation", "prove_six_step_timer", "prove_synchronous_flux", "prove_cycle_first_drive",
                     "prove_cycle_corrected_drive", "prove_cycle_ready_made", "prove_interrupts", "prove_pattern_control_change",
                     "prove_pattern_control_aim", "prove_pattern_control_step", "prove_pattern_control_begin",
                     "prove_pulse_mode_to_pattern", "prove_pulse_mode_to_carrier"], 6),
    "prove_edges": 7,
}
# A function that the others take by its contract, and the one that shows the contract.
CONTRACT, CONTRACT_SHOWN_BY = {"patterns": "move_leg"}, "prove_pattern_control_leg"
FUNCTION = re.compile(r"^/\* ((?:(?!\*/).)*) \*/\nvoid ((?:prove|planted)_\w+)\(void\)", re.MULTILINE | re.DOTALL)
ALARM = re.compile(r"\[eva:alarm\] (\S+): Warning: *\n? *(.*)")
UNSHOWN = re.compile(r"assertion '(\w+)' got status (?:unknown|invalid)|((?:pre|post)condition '?\w*'?.*) got status (?:unknown|invalid)")

Result = collections.namedtuple("Result", "function words alarms taken text")


def functions():
    """(program, function, its words) in the page's order."""
    found = []
    for program, (sources, _) in PROGRAMS.items():
        for source in sources:
            found += [(program, name, " ".join(re.sub(r"\n ?\*", " ", words).split()))
                      for words, name in FUNCTION.findall((FOLDER / f"{source}.c").read_text())]
    return found


def run(arguments, what):
    done = subprocess.run(["frama-c", *arguments], cwd=ROOT, text=True, capture_output=True, timeout=TIME_LIMIT_S, check=False)
    if done.returncode != 0:
        sys.exit(f"{what}: Frama-C failed\n{done.stdout[-3000:]}{done.stderr[-1000:]}")
    return done.stdout


def parsed(program, folder):
    """The program as a file that each analysis begins from."""
    sources, port = PROGRAMS[program]
    saved = f"{folder}/{program}.sav"
    # A source that a program includes, for its static functions, is not linked once more.
    included = {name for source in sources for name in re.findall(r'#include "(\w+\.c)"', (FOLDER / f"{source}.c").read_text())}
    library = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "src").glob("*.c") if path.name not in included)
    run([*PARSE, *(f"tests/prove/{source}.c" for source in sources), *port, *library, "-save", saved], program)
    return saved


def analysed(saved, program, function, words):
    """Its alarms; what was taken without showing it: assertions, conditions, and a contract."""
    precision = str(NEED.get(function, PRECISION))
    contract = CONTRACT.get(program) if function != CONTRACT_SHOWN_BY else None
    by_contract = ["-eva-use-spec", contract] if contract else []
    text = run(["-load", saved, *EVA, *by_contract, "-eva-precision", precision, "-main", function], function)
    count = re.search(r"^  (\d+|No) alarms? generated", text, re.MULTILINE)
    reached = re.search(r"(\d+) functions? analyzed", text)
    if count is None or reached is None or int(reached[1]) < 2:
        sys.exit(f"{function}: the analysis failed\n{text[-3000:]}")
    taken = {name or other for name, other in UNSHOWN.findall(text)}
    if contract and f"using specification for function {contract}" in text:
        taken.add(contract)
    taken = sorted(taken)
    return Result(function, words, 0 if count[1] == "No" else int(count[1]), taken, text)


def listed(name):
    """The lines of a list: name and the rest."""
    lines = [line for line in (FOLDER / name).read_text().split("\n") if line and not line.startswith("#")]
    return dict(line.split(" ", 1) for line in lines)


def verdict(result, allowed, shown):
    """What the page says of it, and what is wrong with it."""
    expected, reason = allowed.pop(result.function, "0 ").split(" ", 1)
    wrong = []
    if result.function.startswith("planted_"):
        wrong += [] if result.alarms > 0 else [f"{result.function}: no alarm"]
    elif result.alarms != int(expected):
        wrong += [f"{result.function}: {result.alarms} alarms, {expected} expected"]
        wrong += [f"    {place} {what}" for place, what in ALARM.findall(result.text)]
    wrong += [f"{result.function}: nothing shows {name}" for name in result.taken if name not in shown]
    says = "no alarm" if result.alarms == 0 else f"open, {result.alarms}: {reason}"
    return says + "".join(f"; takes `{name}`" for name in result.taken), wrong


def assembly():
    """The table of what is not C, and what is wrong with the list."""
    lines = [line.split(" :: ") for line in (FOLDER / "assembly.txt").read_text().splitlines() if line and not line.startswith("#")]
    files = [path for folder in ("src", "include/iqfoc") for path in (ROOT / folder).rglob("*.[ch]")]
    there = {str(path.relative_to(ROOT)) for path in files if "__asm" in path.read_text()}
    listed_ones = {file for file, _, _ in lines}
    wrong = [f"assembly.txt: {file} has no assembly" for file in sorted(listed_ones - there)]
    wrong += [f"assembly.txt: nothing shows {file}" for file in sorted(there - listed_ones)]
    wrong += [f"assembly.txt: there is no {test}" for _, _, tests in lines for test in tests.split() if not (ROOT / test).is_file()]
    rows = [f"| `{file}` | {how} | {', '.join(f'[{pathlib.Path(test).stem}](../{test})' for test in tests.split())} |"
            for file, how, tests in lines]
    return ["| assembly | equal to the C by | test |", "| --- | --- | --- |", *rows], wrong


def main():
    names = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    wanted = [f for f in functions() if not names or f[1] in names]
    if missing := set(names) - {f[1] for f in wanted}:
        sys.exit(f"prove.py: tests/prove has no {', '.join(sorted(missing))}")
    allowed, shown = listed("open.txt"), listed("shown.txt")
    rows = ["| proved for | result |", "| --- | --- |"]
    not_c, wrong = assembly()
    with tempfile.TemporaryDirectory() as folder, \
            concurrent.futures.ThreadPoolExecutor(int(os.environ.get("IQFOC_JOBS", os.cpu_count() or 1))) as pool:
        used = {program for program, _, _ in wanted}
        saved = dict(zip(used, pool.map(lambda program: parsed(program, folder), used)))
        for result in pool.map(lambda f: analysed(saved[f[0]], *f), wanted):
            says, found = verdict(result, allowed, shown)
            print(f"{'FAIL' if found else 'ok  '}  {result.function}: {says.split(':')[0]}", flush=True)
            wrong += found
            if not result.function.startswith("planted_"):
                words = result.words.replace("|", "\\|")
                rows.append(f"| {words} | {says} |")
    cpu_s = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{cpu_s.ru_utime + cpu_s.ru_stime:.0f} s of processor")
    if not names:
        wrong += [f"open.txt names {name}, which there is not" for name in allowed]
        page = PAGE.read_text()
        new = with_table(with_table(page, "proofs", "\n".join(rows)), "assembly", "\n".join(not_c))
        if "--write" in sys.argv[1:]:
            PAGE.write_text(new)
        elif new != page:
            wrong.append("a table in docs/proofs.md is another: tools/prove.py --write")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
