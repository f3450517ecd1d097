"""Logs of other programs: every format gives the recording that the same numbers as text give."""

import numpy as np
import pytest

import iqfoc

MAP = {"columns": {"t_s": "time", "i_a_A": {"from": "Ia", "scale": 1e-3}, "i_b_A": {"from": "Ib", "scale": 1e-3}, "u_a_V": "Ua", "u_b_V": "Ub",
                   "u_c_V": "Uc", "theta_e_rad": {"from": "angle", "unit": "deg"}}}


@pytest.fixture(scope="module")
def columns(recording):
    r = {n: c[:600] for n, c in recording.items()}
    return {"time": r["t_s"], "Ia": 1e3 * r["i_a_A"], "Ib": 1e3 * r["i_b_A"], "Ua": r["u_a_V"], "Ub": r["u_b_V"], "Uc": r["u_c_V"],
            "angle": np.rad2deg(r["theta_e_rad"])}


@pytest.fixture(scope="module")
def expected(columns, tmp_path_factory):
    """From text, as the command reads it."""
    path = tmp_path_factory.mktemp("log") / "log.csv"
    rows = zip(*[c.tolist() for c in columns.values()], strict=True)
    path.write_text(";".join(columns) + "\n" + "".join(";".join(map(repr, row)) + "\n" for row in rows))
    return iqfoc.read_log(path, MAP)


def same(read, expected):
    assert list(read) == list(expected) and read.rows == expected.rows
    for name in expected:
        assert (read[name] == expected[name]).all(), name


def prefixed(prefix):
    return {"columns": {k: {**(v if isinstance(v, dict) else {}), "from": prefix + (v["from"] if isinstance(v, dict) else v)}
                        for k, v in MAP["columns"].items()}}


def test_text_and_memory(columns, expected, recording):
    assert np.abs(expected["i_a_A"] - recording["i_a_A"][:600]).max() < 1e-12
    same(iqfoc.read_log(columns, MAP), expected)


def test_mat(columns, expected, tmp_path):
    io = pytest.importorskip("scipy.io")
    io.savemat(tmp_path / "plain.mat", columns)
    io.savemat(tmp_path / "struct.mat", {"log": columns, "comment": "bench 3"})
    same(iqfoc.read_log(tmp_path / "plain.mat", MAP), expected)
    same(iqfoc.read_log(tmp_path / "struct.mat", prefixed("log.")), expected)


def test_parquet_and_feather(columns, expected, tmp_path):
    arrow = pytest.importorskip("pyarrow")
    from pyarrow import feather, parquet

    table = arrow.table(columns)
    parquet.write_table(table, tmp_path / "log.parquet")
    feather.write_feather(table, tmp_path / "log.feather")
    same(iqfoc.read_log(tmp_path / "log.parquet", MAP), expected)
    same(iqfoc.read_log(tmp_path / "log.feather", MAP), expected)


def test_hdf5(columns, expected, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "log.h5", "w") as file:
        for name, column in columns.items():
            file[f"bench/{name}"] = column.reshape(-1, 1)
        file["bench/note"] = "a text"
    same(iqfoc.read_log(tmp_path / "log.h5", prefixed("bench/")), expected)


def test_mdf(columns, expected, tmp_path):
    asammdf = pytest.importorskip("asammdf")
    t = columns["time"]
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(c, t, name=n) for n, c in columns.items() if n != "time"])
        slow = asammdf.Signal(np.full(6, 48.0), t[::100], name="Udc")
        file.append([slow])
        file.save(tmp_path / "log.mf4")
    by_clock = {"columns": {**MAP["columns"], "t_s": "t_s", "u_dc_V": "Udc"}}
    read = iqfoc.read_log(tmp_path / "log.mf4", by_clock)
    assert (read["u_dc_V"] == 48.0).all()
    same(iqfoc.read_log({**columns, "t_s": t, "Udc": np.full(t.size, 48.0)}, by_clock), read)
    assert all((read[n] == expected[n]).all() for n in expected)


def test_what_cannot_be_used(columns, tmp_path):
    wrong = {"columns": {**MAP["columns"], "i_a_A": "Iaa"}}
    for log, map, words in ((columns, wrong, r'^map:\d+:\d+: i_a_A: log has no column "Iaa"; did you mean "Ia"\?'),
                            ({**columns, "Ia": np.full(600, np.nan)}, MAP, "Ia is no finite number"),
                            ({"name": np.array(["a"])}, MAP, "no column of numbers"),
                            ("nowhere.mat", MAP, "nowhere.mat: there is no such file"),
                            ("nowhere.csv", MAP, "nowhere.csv")):
        with pytest.raises(iqfoc.InputError, match=words):
            iqfoc.read_log(log, map)
    with pytest.raises(TypeError):
        iqfoc.read_log(columns)
    pytest.importorskip("h5py")
    (tmp_path / "cut.h5").write_bytes(b"\x89HDF\r\n\x1a\nand no more")
    with pytest.raises(iqfoc.InputError, match="cut.h5"):
        iqfoc.read_log(tmp_path / "cut.h5", MAP)
