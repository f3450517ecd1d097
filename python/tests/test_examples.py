"""The examples in the docstrings run, and every public function has one."""

import doctest
import inspect
import sys

import numpy as np
import pytest

import iqfoc

DATA = {"Cause", "Errors", "Parameter", "Diagnosis", "Error", "InputError", "MissingFileError"}  # made by diagnose(), or raised


def _public(module):
    return {f"{module.__name__}.{n}": getattr(module, n) for n in module.__all__ if n not in DATA}


def _documented():
    return {n: x for n, x in {**_public(iqfoc), **_public(iqfoc.functions)}.items() if inspect.isclass(x) or inspect.isfunction(x)}


def test_every_public_name_has_an_example():
    without = [n for n, x in _documented().items() if n != "iqfoc.functions.IQ24" and ">>>" not in inspect.getdoc(x)]
    assert not without


@pytest.mark.parametrize("name", sorted(m for m in sys.modules if m.startswith("iqfoc.") and not m.endswith("motulator")))
def test_examples(name, root, monkeypatch):
    monkeypatch.chdir(root)
    result = doctest.testmod(sys.modules[name], extraglobs={"iqfoc": iqfoc, "np": np}, raise_on_error=False)
    assert result.failed == 0


def test_only_public_names():
    assert set(dir(iqfoc)) == set(iqfoc.__all__) and set(dir(iqfoc.functions)) == set(iqfoc.functions.__all__)
