"""papers YEAR [ITEM [CONDITION]]: the rows of `iqfoc reproduce` for one paper, for one of its tables or figures, or for one condition of it.

    <!-- figures: papers 2019 "Table 1" "5000 rpm" -->
"""

from .markdown import Notes, number, table


def generate(program, arguments):
    if len(arguments) not in (1, 2, 3) or arguments[0] not in ("2016", "2019"):
        raise ValueError(f"expected a paper's year (2016 or 2019) and perhaps an item of it, got {arguments}")
    rows = [row for row in program.json("reproduce")["rows"]
            if row["paper"] == arguments[0] and row["item"] in (arguments[1:2] or [row["item"]])
            and row["condition"] in (arguments[2:] or [row["condition"]])]
    if not rows:
        raise ValueError(f"`iqfoc reproduce` has no row for {' '.join(arguments)}")
    heads = ["quantity", "method", "condition", "unit", "paper", "this project", "firmware (IQ24)", "ratio to the paper", ""]
    several_items = len({row["item"] for row in rows}) > 1
    if several_items:
        heads.insert(0, "item")
    notes, cells = Notes(), []
    for row in rows:
        ratio = row["value"] / row["paper_value"] if row["paper_value"] and row["value"] is not None else None
        line = [row["quantity"], row["method"], row["condition"], row["unit"], number(row["paper_value"]), number(row["value"]),
                number(row["value_iq24"]), "-" if ratio is None else f"{ratio:.2f}", notes.mark(row["note"])]
        cells.append([row["item"], *line] if several_items else line)
    figures = ("paper", "this project", "firmware (IQ24)", "ratio to the paper")
    return f"{table(heads, cells, right=figures)}\n\n{notes.listing()}"
