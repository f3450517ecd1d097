#!/usr/bin/env python3
"""Packs the library as Arduino library and as CMSIS pack.

    package.py --url URL [--day YYYY-MM-DD] [-o DIR] [arduino] [cmsis]

writes DIR/iqfoc-arduino-VERSION.zip (the Arduino IDE's "Add .ZIP Library") and DIR/iqfoc.iqfoc.VERSION.pack (CMSIS), by default both, into
build/packages. URL is the address where you publish the package: both formats require one, and this tree has none. The version is the
header's, the day that of the last commit. The same tree, URL and day give the same bytes.

PlatformIO, ESP-IDF and Zephyr take the tree unchanged: library.json, idf_component.yml, zephyr/.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def version():
    return re.search(r'IQFOC_VERSION_STRING "(.*)"', (ROOT / "include/iqfoc/version.h").read_text(encoding="utf-8"))[1]


def day():
    """The last commit's, YYYY-MM-DD."""
    return subprocess.run(["git", "log", "-1", "--format=%cs"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()


def filled(template, **values):
    """The text of a template with each @NAME@ replaced."""
    text = (ROOT / "packages" / template).read_text(encoding="utf-8")
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    left = re.search(r"@[A-Z]+@", text)
    if left:
        sys.exit(f"packages/{template}: no value for {left[0]}")
    return text


def library(folder, headers):
    """{name in the archive: bytes} of the library's sources in `folder` and its headers in `headers`."""
    files = {}
    for file in [*(ROOT / "src").glob("*.c"), *(ROOT / "src").glob("*.h")]:
        files[f"{folder}/{file.name}"] = file.read_bytes()
    for file in (ROOT / "include/iqfoc").rglob("*.h"):
        files[f"{headers}/{file.relative_to(ROOT / 'include').as_posix()}"] = file.read_bytes()
    return files


def write_zip(path, files):
    """An archive of these files, in the order of their names, all of the same old day."""
    path.parent.mkdir(parents=True, exist_ok=True)
    whole = path.with_name(path.name + ".part")
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            data = files[name]
            archive.writestr(entry, data.encode() if isinstance(data, str) else data)
    whole.replace(path)
    print(path)


def arduino(folder, url, _):
    """Arduino compiles all of src/ with src/ alone on the include path, and finds a library by a header that lies in it."""
    files = library("src", "src")
    files["src/iqfoc.h"] = '/* What a sketch includes: all of the library. */\n#include "iqfoc/iqfoc.h"\n'
    files["library.properties"] = filled("arduino/library.properties.in", VERSION=version(), URL=url)
    files["examples/one_cycle/one_cycle.ino"] = (ROOT / "packages/arduino/one_cycle/one_cycle.ino").read_bytes()
    for name in ("LICENSE", "README.md"):
        files[name] = (ROOT / name).read_bytes()
    write_zip(folder / f"iqfoc-arduino-{version()}.zip", {f"iqfoc/{name}": data for name, data in files.items()})


def cmsis(folder, url, date):
    files = library("src", "include")
    lines = [f'        <file category="source" name="{name}"/>' for name in sorted(files) if name.endswith(".c")]
    files["iqfoc.iqfoc.pdsc"] = filled("iqfoc.pdsc.in", VERSION=version(), URL=url, DATE=date, SOURCES="\n".join(lines))
    for name in ("LICENSE", "README.md", "CHANGELOG.md"):
        files[name] = (ROOT / name).read_bytes()
    write_zip(folder / f"iqfoc.iqfoc.{version()}.pack", files)


KINDS = {"arduino": arduino, "cmsis": cmsis}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("kinds", nargs="*", metavar="arduino|cmsis", help="formats; default both")
    parser.add_argument("--url", required=True, help="address where you publish the package, http:// or https://")
    parser.add_argument("--day", help="of the release; the last commit's if not given")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=ROOT / "build/packages")
    options = parser.parse_args()
    if not re.fullmatch(r"https?://\S+", options.url):
        parser.error(f"--url {options.url}: expected http:// or https:// and an address")
    for kind in options.kinds:
        if kind not in KINDS:
            parser.error(f"unknown package '{kind}'; there are {', '.join(KINDS)}")
    for kind in options.kinds or KINDS:
        KINDS[kind](options.output, options.url, options.day or day())


if __name__ == "__main__":
    main()
