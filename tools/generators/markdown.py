"""Tables and numbers as the documents show them."""


def number(value, digits=3):
    """A number with that many significant digits and no exponent where it reads well; a dash for none."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    if 1e-4 <= abs(value) < 1e5:
        text = f"{value:.{digits}g}"
        return f"{float(text):.0f}" if "e" in text else text
    return f"{value:.{digits - 1}e}"


def table(heads, rows, right=()):
    """A Markdown table; the columns whose heads are in `right` are aligned to the right."""
    lines = ["| " + " | ".join(heads) + " |",
             "| " + " | ".join("---:" if head in right else "---" for head in heads) + " |"]
    lines += ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)
