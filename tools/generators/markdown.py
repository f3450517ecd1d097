"""Tables and numbers as the documents show them."""

import re


def number(value):
    """A number to three significant digits, four if it begins with a 1; a dash for none."""
    if value is None:
        return "-"
    if value == 0:
        return "0"
    digits = 4 if f"{abs(value):.2e}".startswith("1") else 3
    if 1e-4 <= abs(value) < 1e5:
        text = f"{value:.{digits}g}"
        return f"{float(text):.0f}" if "e" in text else text
    return re.sub(r"e([+-])0*(\d)", r"e\1\2", f"{value:.{digits - 1}e}").replace("e+", "e")


def table(heads, rows, right=()):
    """A Markdown table; the columns whose heads are in `right` are aligned to the right."""
    lines = ["| " + " | ".join(heads) + " |",
             "| " + " | ".join("---:" if head in right else "---" for head in heads) + " |"]
    lines += ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


class Notes:
    """Notes that rows share, numbered in the order of their first use and listed below the table."""

    def __init__(self):
        self.texts = []

    def mark(self, text):
        """The mark to put into the row; nothing for an empty note."""
        if not text:
            return ""
        if text not in self.texts:
            self.texts.append(text)
        return f"[{self.texts.index(text) + 1}]"

    def listing(self):
        """One line for each note, as a Markdown list."""
        return "\n".join(f"- [{index}] {text}" for index, text in enumerate(self.texts, 1))
