"""Puts the page together: one file with all that it needs.   assemble.py PAGE.wasm UPLOT_DIR OUT_DIR"""

import base64
import gzip
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent

EXAMPLE = HERE.parent / "data/recordings/dead_time"


def text_of(octets):
    return base64.b64encode(octets).decode()


def main():
    wasm, uplot, out = map(pathlib.Path, sys.argv[1:])
    version = re.search(r'IQFOC_VERSION_STRING\s+"([^"]+)"', (HERE.parent / "include/iqfoc/version.h").read_text())[1]
    parts = {
        "VERSION": version,
        "WASM": text_of(gzip.compress(wasm.read_bytes(), mtime=0)),
        "EXAMPLE_NAME": EXAMPLE.name,
        "EXAMPLE": text_of(EXAMPLE.with_name(EXAMPLE.name + ".csv.gz").read_bytes()),
        "EXAMPLE_MOTOR": text_of(EXAMPLE.with_name(EXAMPLE.name + ".toml").read_bytes()),
        "UPLOT_CSS": (uplot / "dist/uPlot.min.css").read_text(),
        "UPLOT_JS": (uplot / "dist/uPlot.iife.min.js").read_text(),
        "UPLOT_LICENCE": (uplot / "LICENSE").read_text().replace("--", "- -"),
        "REPORT_CSS": (HERE.parent / "sim_host/report/page.css").read_text(),
        "PAGE_JS": (HERE / "page.js").read_text(),
        "LIVE_JS": (HERE / "live.js").read_text(),
        "WORKER_JS": (HERE / "worker.js").read_text(),
    }
    for name in ("PAGE_JS", "LIVE_JS", "WORKER_JS", "UPLOT_JS"):
        if "</script" in parts[name]:
            sys.exit(f"{name} holds </script, which would end it")
    page = re.sub("@@([A-Z_]+)@@", lambda found: parts[found[1]], (HERE / "page.html").read_text())
    out.mkdir(parents=True, exist_ok=True)
    (out / "index.html").write_text(page)
    (out / "golden.txt").unlink(missing_ok=True)  # what an earlier page showed (tests/browser/web_page.py)


if __name__ == "__main__":
    main()
