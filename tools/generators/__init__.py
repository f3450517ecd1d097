"""The generators of figures.py by the name that a document calls them.

A generator is a function (program, arguments) -> Markdown. `program.json("reproduce", ...)` is the program's JSON for that command
line, `program.output(...)` what another command of the tree prints; `arguments` are the words behind the name in the document. It
raises ValueError for arguments that it cannot use. Figures are rounded to what a reader needs: the last digits may differ between
machines.
"""

from . import bench, carried_on, diagnosis, induction, loops, mean_map, papers, picture, plan, sweep, tune, watch

GENERATORS = {
    "bench": bench.generate,
    "carried_on": carried_on.generate,
    "diagnosis": diagnosis.generate,
    "loops": loops.generate,
    "induction": induction.generate,
    "mean_map": mean_map.generate,
    "papers": papers.generate,
    "picture": picture.generate,
    "plan": plan.generate,
    "sweep": sweep.generate,
    "tune": tune.generate,
    "watch": watch.generate,
}
