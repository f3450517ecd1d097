"""What the tests share: the tree's data, a short recording and its diagnosis, and the program to compare with (IQFOC)."""

import os
import pathlib

import pytest

import iqfoc

ROOT = pathlib.Path(__file__).resolve().parents[2]

SCENARIO = {
    "sensors": {"current_bits": 12, "current_full_scale_A": 25.0, "current_noise_A": 0.025},
    "log": {"duties": True},
    "run": [{"cycles": 700, "speed_rpm": rpm, "i_d_A": {"value": d, "square": {"amplitude": 1.0, "period_s": 0.023}},
             "i_q_A": {"value": q, "square": {"amplitude": 1.0, "period_s": 0.037}}}
            for rpm, d, q in ((300.0, 0.0, 3.0), (1500.0, -1.0, 6.0), (-1500.0, 0.0, -5.0))],
}


def pytest_configure(config):
    config.addinivalue_line("markers", "extra: needs a package that iqfoc itself does without")


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def program():
    """The program of the same tree, whose digits are to be met; CI says where it is."""
    path = os.environ.get("IQFOC")
    if not path:
        pytest.skip("IQFOC does not say where the program is")
    return path


@pytest.fixture(scope="session")
def motor(root):
    return iqfoc.Motor(root / "data" / "motors" / "jarzebowicz2019.toml")


@pytest.fixture(scope="session")
def recording(motor):
    return iqfoc.Drive(motor, ["resistance:R=0.95"], seed=3).run(SCENARIO)


@pytest.fixture(scope="session")
def diagnosis(recording, motor):
    return iqfoc.diagnose(recording, motor)
