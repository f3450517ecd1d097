"""Logs of other programs: every format gives the recording that the same numbers as text give."""

import importlib
import json

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


@pytest.mark.extra
def test_mat(columns, expected, tmp_path):
    io = pytest.importorskip("scipy.io")
    io.savemat(tmp_path / "plain.mat", columns)
    io.savemat(tmp_path / "struct.mat", {"log": columns, "comment": "bench 3"})
    same(iqfoc.read_log(tmp_path / "plain.mat", MAP), expected)
    same(iqfoc.read_log(tmp_path / "struct.mat", prefixed("log.")), expected)


@pytest.mark.extra
def test_parquet_and_feather(columns, expected, tmp_path):
    arrow = pytest.importorskip("pyarrow")
    from pyarrow import feather, parquet

    table = arrow.table(columns)
    parquet.write_table(table, tmp_path / "log.parquet")
    feather.write_feather(table, tmp_path / "log.feather")
    same(iqfoc.read_log(tmp_path / "log.parquet", MAP), expected)
    same(iqfoc.read_log(tmp_path / "log.feather", MAP), expected)


@pytest.mark.extra
def test_hdf5(columns, expected, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "log.h5", "w") as file:
        for name, column in columns.items():
            file[f"bench/{name}"] = column.reshape(-1, 1)
        file["bench/note"] = "a text"
    same(iqfoc.read_log(tmp_path / "log.h5", prefixed("bench/")), expected)


@pytest.mark.extra
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


@pytest.mark.extra
def test_xlsx(columns, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    columns = {n: np.array([float(f"{x:.16g}") for x in c]) for n, c in columns.items()}  # all that openpyxl writes of a number
    expected = iqfoc.read_log(columns, MAP)
    for units in ([], [["s", "mA", "mA", "V", "V", "V", "deg"]]):
        book = openpyxl.Workbook()
        book.active.append(["Bench 3"])
        sheet = book.create_sheet("log")
        sheet.append(["recorded on Monday"])
        for row in ([*columns], *units, *zip(*[c.tolist() for c in columns.values()], strict=True)):
            sheet.append(row)
        book.save(tmp_path / "log.xlsx")
        same(iqfoc.read_log(tmp_path / "log.xlsx", MAP), expected)
    sheet.cell(row=10, column=2).value = None
    book.save(tmp_path / "hole.xlsx")
    with pytest.raises(iqfoc.InputError, match="hole.xlsx.*Ia is no finite number"):
        iqfoc.read_log(tmp_path / "hole.xlsx", MAP)
    (tmp_path / "cut.xlsx").write_bytes(b"PK\x03\x04")
    with pytest.raises(iqfoc.InputError, match="cut.xlsx"):
        iqfoc.read_log(tmp_path / "cut.xlsx", MAP)


def mcap_of(path, topics):
    """{topic: (encoding, [(time in ns, data)])}"""
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for topic, (encoding, messages) in topics.items():
            channel = writer.register_channel(topic=topic, message_encoding=encoding, schema_id=0)
            for t, data in messages:
                writer.add_message(channel_id=channel, log_time=t, publish_time=t, data=data)
        writer.finish()


@pytest.mark.extra
def test_mcap(columns, expected, tmp_path):
    pytest.importorskip("mcap")
    rows = [dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values(), strict=True)]
    t_ns = [10 ** 9 + round(1e9 * r["time"]) for r in rows]
    fast = [(t, json.dumps({"motor": r, "text": "a"}).encode()) for t, r in zip(t_ns, rows, strict=True)]
    slow = [(t, json.dumps({"Udc": 48.0 + k}).encode()) for k, t in enumerate(t_ns[::100])]
    mcap_of(tmp_path / "log.mcap", {"/drive": ("json", fast), "/link": ("json", slow), "/camera": ("cdr", [(t_ns[0], b"x")])})
    same(iqfoc.read_log(tmp_path / "log.mcap", prefixed("/drive.motor.")), expected)
    link = iqfoc.read_log(tmp_path / "log.mcap", {"columns": {**prefixed("/drive.motor.")["columns"], "t_s": "t_s", "u_dc_V": "/link.Udc"}})
    assert (link["u_dc_V"] == 48.0 + np.arange(600) // 100).all()
    mcap_of(tmp_path / "other.mcap", {"/camera": ("cdr", [(0, b"x")])})
    with pytest.raises(iqfoc.InputError, match="other.mcap: expected messages in JSON, found /camera: cdr"):
        iqfoc.read_log(tmp_path / "other.mcap", MAP)


@pytest.mark.parametrize("ending", ["bin", "dat"])
def test_packed_rows(columns, expected, tmp_path, ending):
    """Doubles lose no digit; the map says that the log is packed, whatever its name."""
    (tmp_path / f"log.{ending}").write_bytes(np.array(list(columns.values())).T.astype("<f8").tobytes())
    packed = {"format": {"type": "binary", "frame": "fixed", "fields": [[n, "f64"] for n in columns]}, **MAP}
    same(iqfoc.read_log(tmp_path / f"log.{ending}", packed), expected)


@pytest.mark.parametrize("ending, extra", [("xlsx", "xlsx"), ("mcap", "mcap"), ("mat", "mat"), ("parquet", "parquet"), ("h5", "hdf5"), ("mf4", "mdf")])
def test_a_missing_library_is_one_line(tmp_path, monkeypatch, ending, extra):
    path = tmp_path / f"log.{ending}"
    path.write_bytes(b"")
    monkeypatch.setattr(importlib, "import_module", lambda name: (_ for _ in ()).throw(ImportError(name)))
    with pytest.raises(ImportError, match=rf"pip install iqfoc\[{extra}\]$") as missing:
        iqfoc.read_log(path, MAP)
    assert "\n" not in str(missing.value)


def test_what_cannot_be_used(columns):
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


@pytest.mark.extra
def test_a_cut_file(tmp_path):
    pytest.importorskip("h5py")
    (tmp_path / "cut.h5").write_bytes(b"\x89HDF\r\n\x1a\nand no more")
    with pytest.raises(iqfoc.InputError, match="cut.h5"):
        iqfoc.read_log(tmp_path / "cut.h5", MAP)
