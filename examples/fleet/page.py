"""The fleet's page: which causes, which drives, outliers, what changed since the last batch. One file, nothing loaded from elsewhere."""

from collections import Counter, defaultdict
from html import escape
from statistics import median

FAR = 5.0  # robust standard deviations from the fleet that make a drive an outlier
FEWEST = 8  # drives needed to estimate a spread

STYLE = """
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; } td, th { padding: .2em .8em .2em 0; text-align: left; vertical-align: top; }
th { border-bottom: 1px solid; } .scroll { overflow-x: auto; } .bar { background: #3b7dd8; height: .8em; }
.number { text-align: right; font-variant-numeric: tabular-nums; }
"""


def _table(head, rows):
    if not rows:
        return "<p>None.</p>"
    body = "".join("<tr>" + "".join(_cell(x) for x in row) + "</tr>" for row in rows)
    return f'<div class="scroll"><table><tr>{"".join(f"<th>{escape(h)}</th>" for h in head)}</tr>{body}</table></div>'


def _cell(x):
    if isinstance(x, tuple):  # a share of 1, as a bar
        return f'<td style="min-width:8em"><div class="bar" style="width:{100.0 * x[0]:.1f}%"></div></td>'
    if isinstance(x, (int, float)):
        return f'<td class="number">{x:.4g}</td>'
    return f"<td>{escape(str(x))}</td>"


def _named(row):
    return {c["id"] for c in row["causes"]}


def causes(rows):
    """(cause, drives, share, least, median and most of each parameter, which drives)."""
    drives, values = defaultdict(list), defaultdict(list)
    for row in rows:
        for cause in row["causes"]:
            drives[cause["id"]].append(row["drive"])
            for name, (value, _, unit, *_) in cause["parameters"].items():
                if value is not None:
                    values[cause["id"], name, unit].append(value)
    table = []
    for cause, names in sorted(drives.items(), key=lambda item: -len(item[1])):
        sizes = "; ".join(f"{n} {min(v):.4g} … {median(v):.4g} … {max(v):.4g}{'' if u == '1' else f' {u}'}" for (c, n, u), v in values.items() if c == cause)
        shown = ", ".join(names[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
        table.append((cause, len(names), (len(names) / len(rows),), sizes, shown))
    return table


def outliers(rows):
    """Drives with a machine parameter far from the others' median, named as a cause or not."""
    table = []
    for name in dict.fromkeys(n for row in rows for n in row["estimates"]):
        have = [(row["drive"], row["estimates"][name]) for row in rows if name in row["estimates"] and row["estimates"][name][0] is not None]
        if len(have) < FEWEST:
            continue
        middle = median(e[0] for _, e in have)
        spread = 1.4826 * median(abs(e[0] - middle) for _, e in have)
        for drive, (value, unit, low, high) in have:
            own = 0.0 if low is None else (high - low) / 3.92
            far = abs(value - middle) / max((spread ** 2 + own ** 2) ** 0.5, 1e-300)
            if far > FAR:
                table.append((drive, name, value, unit, middle, far))
    return sorted(table, key=lambda r: -r[-1])


def changes(rows, before):
    """What is new, gone or moved since the batch before, a line a drive."""
    old = {row["drive"]: row for row in before}
    table = []
    for row in rows:
        was = old.pop(row["drive"], None)
        if was is None:
            table.append((row["drive"], "new in the fleet", row["words"]))
            continue
        appeared, gone = _named(row) - _named(was), _named(was) - _named(row)
        if appeared or gone:
            words = [f"{', '.join(sorted(appeared))} appeared"] if appeared else []
            words += [f"{', '.join(sorted(gone))} is gone"] if gone else []
            table.append((row["drive"], "; ".join(words), row["words"]))
        elif row["verdict"] != was["verdict"]:
            table.append((row["drive"], f"{was['verdict']} became {row['verdict']}", row["words"]))
        else:
            table += [(row["drive"], words, row["words"]) for words in _moved(row, was)]
    return table + [(drive, "no recording in this batch", "") for drive in old]


def _moved(row, was):
    """Parameters of the same cause whose 95 % intervals do not touch."""
    for cause in row["causes"]:
        old = next(c for c in was["causes"] if c["id"] == cause["id"])
        for name, (value, _, unit, low, high) in cause["parameters"].items():
            old_value, _, _, old_low, old_high = old["parameters"].get(name, [None] * 5)
            if None not in (low, old_low) and (low > old_high or high < old_low):
                yield f"{cause['id']}: {name} went from {old_value:.4g} to {value:.4g} {unit}"


def page(batch, before=None):
    """The page of a batch, with the changes since the batch before."""
    rows = batch["rows"]
    verdicts = Counter(row["verdict"] for row in rows)
    bad = [row for row in rows if row["verdict"] in ("unusable", "failed")]
    open_ones = [row for row in rows if row["verdict"] in ("partly", "unexplained")]
    parts = ["<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>",
             f"<title>Fleet {escape(batch['folder'])}</title><style>{STYLE}</style>",
             f"<h1>Fleet {escape(batch['folder'])}</h1><p>{len(rows)} recordings, diagnosed by iqfoc {escape(batch['iqfoc'])}: ",
             ", ".join(f"{n} {v}" for v, n in verdicts.most_common()) + ".</p>"]
    if before is not None:
        changed = changes(rows, before["rows"])
        parts += [f"<h2>Changed since {escape(before['folder'])}: {len(changed)}</h2>", _table(("drive", "what", "now"), changed)]
    parts += ["<h2>Causes</h2>", _table(("cause", "drives", "", "least … median … most", "which"), causes(rows)),
              "<h2>Outliers</h2><p>Drives with a parameter far from the fleet's median, in standard deviations of fleet and "
              "measurement, named as a cause or not.</p>",
              _table(("drive", "parameter", "value", "unit", "fleet's median", "far by"), outliers(rows)),
              "<h2>Not explained</h2>", _table(("drive", "verdict", "error left in %", "floor in %", "what"),
                                                [(r["drive"], r["verdict"], r["extended"], r["noise_floor"], r["words"]) for r in open_ones]),
              "<h2>Without a diagnosis</h2>", _table(("drive", "", "why"), [(r["drive"], r["verdict"], r["words"]) for r in bad]),
              "<h2>All drives</h2>", _table(("drive", "verdict", "causes", "error in %", "left", "floor"),
                                             [(r["drive"], r["verdict"], ", ".join(sorted(_named(r))), r["nominal"], r["extended"],
                                               r["noise_floor"]) for r in rows if r not in bad])]
    return "".join(parts) + "</html>\n"
