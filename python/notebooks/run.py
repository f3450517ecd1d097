#!/usr/bin/env python3
"""Runs notebooks from their first cell to the last, without writing into them: run.py NOTEBOOK..."""

import pathlib
import sys

import nbclient
import nbformat


def main():
    for path in map(pathlib.Path, sys.argv[1:]):
        book = nbformat.read(path, as_version=4)
        if any(cell.get("outputs") for cell in book.cells):
            sys.exit(f"{path}: holds outputs; clear them before it is committed")
        nbclient.NotebookClient(book, timeout=300, kernel_name="python3", resources={"metadata": {"path": path.parent}}).execute()
        for cell in book.cells:
            for output in cell.get("outputs", []):
                if output.output_type == "stream":
                    print(output.text, end="")
        print(f"{path}: {sum(c.cell_type == 'code' for c in book.cells)} cells ran")


if __name__ == "__main__":
    main()
