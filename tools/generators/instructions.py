"""instructions FUNCTION...: instruction counts of bench/baseline.json, which `./dev bench --check` holds to what is counted.

    <!-- figures: instructions watch_step watch_block -->

A row of the documents names the function as docs/bench.md does.
"""

import importlib.util
import json
import sys

from .markdown import table

TARGETS = {"cortex-m4": "Cortex-M4", "rv32": "RV32IM"}


def names(root):
    """Each function's words: bench/table.py has them."""
    sys.path.insert(0, str(root / "bench"))
    try:
        spec = importlib.util.spec_from_file_location("bench_table", root / "bench" / "table.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return {function: row[0] for function, row in module.ROWS.items()}
    finally:
        sys.path.remove(str(root / "bench"))


def count(row):
    """The mean; with the least and the largest count, if the inputs differ."""
    mean = f"{row['mean']:.0f}"
    return mean if row["min"] == row["max"] else f"{mean} ({row['min']} ... {row['max']})"


def generate(program, arguments):
    if not arguments:
        raise ValueError("expected functions of bench/baseline.json")
    baseline = json.loads((program.root / "bench" / "baseline.json").read_text(encoding="utf-8"))
    counted = {target: {row["function"]: row for row in baseline[target]} for target in TARGETS}
    words = names(program.root)
    unknown = [function for function in arguments if any(function not in of_target for of_target in counted.values())]
    if unknown:
        raise ValueError(f"bench/baseline.json has no {', '.join(unknown)}")
    rows = [[f"{words[function]} (`{function}`)", *(count(counted[target][function]) for target in TARGETS)] for function in arguments]
    return table(["instructions", *TARGETS.values()], rows, right=list(TARGETS.values()))
