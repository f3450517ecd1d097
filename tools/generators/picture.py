"""picture COMMAND FILE.svg PATH "words": a picture that `iqfoc COMMAND -o DIR` draws, kept in the tree as docs/figures/FILE.svg.

COMMAND may have options; it stands in quotes then.

    <!-- figures: picture reproduce 2019-figure-7.svg docs/figures "Errors over the ratio" -->

PATH is the folder as the document writes it. `write` copies the picture; `check` compares what it shows: every word, and every number to
a hundredth of the drawing's unit, so that another version's last digit is no drift.
"""

import pathlib
import re
import shlex
import shutil
import tempfile

FOLDER = pathlib.Path("docs") / "figures"
NUMBER = re.compile(r"-?\d+\.\d+")
VERSION = re.compile(r"Produced by GNUPLOT [^<]*")


def shown(text):
    """What a picture shows, without the drawing program's version and the last digits."""
    return NUMBER.sub(lambda match: f"{float(match.group(0)):.2f}", VERSION.sub("", text))


def generate(program, arguments):
    if len(arguments) != 4:
        raise ValueError(f"expected a command, a file, the folder as the document writes it and words, got {arguments}")
    command, name, folder, words = arguments
    kept = program.root / FOLDER / name
    with tempfile.TemporaryDirectory() as made:
        program.output(str(program.path), *shlex.split(command), "-o", made)
        drawn = pathlib.Path(made) / name
        if not drawn.exists():
            raise ValueError(f"`iqfoc {command} -o DIR` draws no {name}")
        if program.writes:
            kept.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(drawn, kept)
        elif not kept.exists() or shown(kept.read_text(encoding="utf-8")) != shown(drawn.read_text(encoding="utf-8")):
            raise ValueError(f"{kept.relative_to(program.root)} is not what `iqfoc {command}` draws; `./dev figures` draws it anew")
    return f"![{words}]({folder}/{name})"
