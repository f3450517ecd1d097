"""The generators of figures.py by the name that a document calls them.

A generator is a function (program, arguments) -> Markdown. `program.json("reproduce", ...)` is the program's JSON for that command
line, `program.output(...)` what another command of the tree prints; `arguments` are the words behind the name in the document. It
raises ValueError for arguments that it cannot use. Figures are rounded to what a reader needs: further digits may differ between
machines.
"""

from . import (bench, carried_on, commission, diagnosis, front, induction, instructions, iqmath, loops, mean_map, observers, papers, patterns, picture, plan,
               run, sensorless, sweep, thresholds, tune, watch)

GENERATORS = {
    "bench": bench.generate,
    "carried_on": carried_on.generate,
    "commission": commission.generate,
    "diagnosis": diagnosis.generate,
    "front": front.generate,
    "loops": loops.generate,
    "identified": sensorless.identified,
    "induction": induction.generate,
    "instructions": instructions.generate,
    "iqmath": iqmath.generate,
    "mean_map": mean_map.generate,
    "observers": observers.generate,
    "papers": papers.generate,
    "pattern_control": patterns.control,
    "patterns": patterns.generate,
    "picture": picture.generate,
    "plan": plan.generate,
    "pulse_mode": patterns.modes,
    "pulse_shares": patterns.shares,
    "reversals": sensorless.reversals,
    "run": run.generate,
    "sensorless": sensorless.generate,
    "sweep": sweep.generate,
    "thresholds": thresholds.generate,
    "tune": tune.generate,
    "watch": watch.generate,
}
