#!/usr/bin/env python3
"""What the archives of the static programs hold links the program again with another C library, by the line that RELINK.txt says.

    tests/cli/relink.py build/static-x86-64 ...     run by ./dev test --all

The other C library is the machine's, changed: what it calls a file that is not there.
"""

import pathlib
import subprocess
import sys
import tarfile
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import pack_static  # noqa: E402
from static import runner  # noqa: E402

TEXT, CHANGED = b"No such file or directory", b"no file is there any more"


def told(command, status):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == status, f"{command}: {done.stderr}"
    return done.stdout + done.stderr


def relinked(folder, work):
    """The archive unpacked in work, and the program that its line makes there."""
    subprocess.run([ROOT / "tools/pack_static.py", folder, "-o", work], check=True, stdout=subprocess.DEVNULL)
    (archive,) = work.glob("*.tar.gz")
    with tarfile.open(archive) as tar:
        tar.extractall(work)
    (place,) = (path for path in work.iterdir() if path.is_dir())
    library = pack_static.c_library(pack_static.compiler_of(folder))[0].read_bytes()
    assert len(TEXT) == len(CHANGED) and TEXT in library
    (work / "libc.a").write_bytes(library.replace(TEXT, CHANGED))
    (line,) = (line for line in (place / "RELINK.txt").read_text().splitlines() if " -static " in line)
    words = line.replace("FOLDER", str(work)).split()
    words[words.index("-o") + 1] = "relinked"
    subprocess.run(words, cwd=place, check=True)
    return place / "iqfoc", place / "relinked"


def main():
    folders = [pathlib.Path(name).resolve() for name in sys.argv[1:]]
    assert folders, __doc__
    for folder in folders:
        with tempfile.TemporaryDirectory() as name:
            before, after = relinked(folder, pathlib.Path(name))
            missing = ["diagnose", "none.csv", "--motor", ROOT / "data/motors/compressor_salient.toml"]
            assert TEXT.decode() in told([*runner(before), *missing], 2)
            assert CHANGED.decode() in told([*runner(after), *missing], 2)
            assert told([*runner(after), "golden"], 0) == told([*runner(before), "golden"], 0)
            print(f"ok    {folder.name}: relinked with another C library")
    return 0


if __name__ == "__main__":
    sys.exit(main())
