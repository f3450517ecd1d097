"""observers: the library's observer next to a Kalman filter and motulator's. It is the table of python/compare_observers.py.

    <!-- figures: observers -->
"""

import os


def generate(program, arguments):
    if arguments:
        raise ValueError(f"takes no arguments, got {arguments}")
    python = program.root / ".cache/python/motulator/bin/python"
    if not python.exists():
        raise ValueError("needs motulator; `./dev tools motulator` installs it")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    return program.output(str(python), "-B", "python/compare_observers.py", "--iqfoc", str(program.path))
