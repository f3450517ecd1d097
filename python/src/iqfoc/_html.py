"""Small HTML tables for notebooks."""

from html import escape


def _cell(x):
    return f"{x:.5g}" if isinstance(x, float) else str(x)


def table(head, rows):
    """A table of texts and numbers; everything escaped."""
    cells = "".join("<tr>" + "".join(f"<td>{escape(_cell(x))}</td>" for x in row) + "</tr>" for row in rows)
    return "<table><thead><tr>" + "".join(f"<th>{escape(str(h))}</th>" for h in head) + f"</tr></thead><tbody>{cells}</tbody></table>"
