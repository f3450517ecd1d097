"""The build of the package: scikit-build-core, and a package with uPlot where the tree has none (cmake/iqfoc-uplot.cmake)."""

import os
import pathlib

from scikit_build_core import build as _build
from scikit_build_core.build import *  # noqa: F403

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = (os.environ.get("UPLOT_DIR"), ROOT / ".cache/uplot", "/usr/local/lib/node_modules/uplot", "/usr/lib/node_modules/uplot")


def get_requires_for_build_wheel(config_settings=None):
    there = any(folder and pathlib.Path(folder, "dist/uPlot.iife.min.js").is_file() for folder in FOLDERS)
    return _build.get_requires_for_build_wheel(config_settings) + ([] if there else ["uplot-python==1.1.1"])
