"""picture COMMAND FILE.svg PATH "words": a figure of the page that `iqfoc COMMAND -o DIR` writes, kept in the tree as docs/figures/FILE.svg.

COMMAND may have options; put it in quotes then.

    <!-- figures: picture reproduce 2019-figure-7.svg docs/figures "Errors over the ratio" -->

FILE is the figure's id in the page. Its charts are drawn by gnuplot here; the program draws contour lines itself, into a file next to the page.
PATH is the folder as the document writes it. `write` copies the picture; `check` compares what it shows: every word, and every number to
a hundredth of the drawing's unit, so that another version's last digit is no drift, wherever it falls on a rounding's edge.
"""

import pathlib
import re
import shlex

from . import chart_svg

FOLDER = pathlib.Path("docs") / "figures"
NUMBER = re.compile(r"-?\d+\.\d+")
VERSION = re.compile(r"Produced by GNUPLOT [^<]*")


def shows_the_same(one, other):
    """Whether two pictures show the same, whatever the drawing program's version and rounding."""
    one, other = VERSION.sub("", one), VERSION.sub("", other)
    if NUMBER.split(one) != NUMBER.split(other):
        return False
    numbers = zip(map(float, NUMBER.findall(one)), map(float, NUMBER.findall(other)))
    return all(abs(here - there) <= 0.0101 for here, there in numbers)


def drawn(folder, name):
    """The picture, from the file next to the page or from the page's charts; None if there is none."""
    if (folder / name).exists():
        return (folder / name).read_text(encoding="utf-8")
    for page in sorted(folder.glob("*.html")):
        told = chart_svg.figure(page.read_text(encoding="utf-8"), name.removesuffix(".svg"))
        if told is not None:
            return chart_svg.svg(told)
    return None


def generate(program, arguments):
    if len(arguments) != 4:
        raise ValueError(f"expected a command, a file, the folder as the document writes it and words, got {arguments}")
    command, name, folder, words = arguments
    kept = program.root / FOLDER / name
    picture = drawn(program.written(*shlex.split(command)), name)
    if picture is None:
        raise ValueError(f"the page of `iqfoc {command} -o DIR` has no figure {name}")
    if program.writes:
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(picture, encoding="utf-8")
    elif not kept.exists() or not shows_the_same(kept.read_text(encoding="utf-8"), picture):
        raise ValueError(f"{kept.relative_to(program.root)} is not what `iqfoc {command}` draws; `./dev figures` draws it again")
    return f"![{words}]({folder}/{name})"
