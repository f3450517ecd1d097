"""The fleet, small: a bad file and a recording that kills its worker stop nobody, and the page says what is what."""

import json
import os
import pathlib
import subprocess
import sys

import pytest
from dask.distributed import Client, LocalCluster

import fleet
import make
import page

HERE = pathlib.Path(__file__).parent
DRIVES = 7
BREAKS = 4  # a drive that the second batch has a fault in


@pytest.fixture(scope="module")
def batches(tmp_path_factory):
    """Two batches through the command, the first with a file that was cut off."""
    folder = tmp_path_factory.mktemp("fleet")
    for batch in (1, 2):
        recordings = folder / f"recordings-{batch}"
        subprocess.run([sys.executable, HERE / "make.py", recordings, "--drives", str(DRIVES), "--batch", str(batch)], check=True)
        if batch == 1:
            cut = recordings / "drive-0003.csv.gz"
            cut.write_bytes(cut.read_bytes()[:3000])
        before = ["--before", folder / "out-1" / "batch.json"] if batch == 2 else []
        subprocess.run([sys.executable, HERE / "fleet.py", recordings, "-o", folder / f"out-{batch}", "--workers", "2", *before], check=True)
    return folder


def rows_of(batches, n):
    return json.loads((batches / f"out-{n}" / "batch.json").read_text())["rows"]


def test_every_drive_has_its_row(batches):
    for n in (1, 2):
        truth = json.loads((batches / f"recordings-{n}" / "truth.json").read_text())
        rows = rows_of(batches, n)
        assert [r["drive"] for r in rows] == list(truth)
        right = [{c["id"] for c in r["causes"]} == ({truth[r["drive"]]} - {None}) for r in rows if r["verdict"] != "unusable"]
        assert sum(right) >= len(right) - 1


def test_the_bad_file_is_named(batches):
    (bad,) = [r for r in rows_of(batches, 1) if r["verdict"] == "unusable"]
    assert bad["drive"] == "drive-0003" and "drive-0003.csv.gz" in bad["words"]
    assert "drive-0003.csv.gz" in (batches / "out-1" / "fleet.html").read_text()


def test_the_page_says_what_changed(batches):
    changed = page.changes(rows_of(batches, 2), rows_of(batches, 1))
    assert make.drive_of(BREAKS, 1)[1] is None and make.drive_of(BREAKS, 2)[1] is not None
    (new,) = [words for drive, words, _ in changed if drive == f"drive-{BREAKS:04d}"]
    assert f"{make.drive_of(BREAKS, 2)[1]} appeared" in new
    assert "Changed since recordings-1" in (batches / "out-2" / "fleet.html").read_text()


def test_outliers_stand_apart():
    rows = [{"drive": str(n), "estimates": {"R": [0.75 + 0.001 * (n % 3), "ohm", 0.74, 0.76]}} for n in range(20)]
    rows.append({"drive": "far", "estimates": {"R": [0.95, "ohm", 0.94, 0.96]}})
    assert [(r[0], r[1]) for r in page.outliers(rows)] == [("far", "R")]
    assert page.outliers(rows[:5]) == []


def killer(name, recording, motor):
    if name == "kills":
        os._exit(1)
    if name == "raises":
        raise RuntimeError("each time")
    return {"drive": name}


def test_a_dead_worker_stops_nobody():
    fleet.careful()
    names = ["a", "kills", "b", "raises", *"cdefgh"]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        rows = fleet.run(client, {n: ("", "") for n in names}, task=killer)
    assert [r["drive"] for r in rows] == names
    failed = {r["drive"]: r["words"] for r in rows if r.get("verdict") == "failed"}
    assert set(failed) == {"kills", "raises"} and "each time" in failed["raises"]


def unlucky(name, recording, motor):
    """Takes its worker with it as often as a recording may, and not once more."""
    deaths = pathlib.Path(recording)
    if name == "neighbour" and len(deaths.read_text()) < 2:
        deaths.write_text(deaths.read_text() + "x")
        os._exit(1)
    return {"drive": name}


def test_who_was_beside_a_dead_worker_is_tried_alone(tmp_path):
    fleet.careful()
    deaths = tmp_path / "deaths"
    deaths.write_text("")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        rows = fleet.run(client, {n: (deaths, "") for n in ["a", "neighbour", "b"]}, task=unlucky)
    assert rows == [{"drive": n} for n in ["a", "neighbour", "b"]] and deaths.read_text() == "xx"


def test_a_drive_keeps_its_fault():
    for number in range(1, 50):
        first, second = make.drive_of(number, 1), make.drive_of(number, 2)
        assert first == second or (first[1] is None and number % 7 == 4)


@pytest.mark.parametrize("arguments", [["nowhere"], [".", "--before", "nowhere.json"]])
def test_a_missing_folder_is_one_line(tmp_path, arguments):
    done = subprocess.run([sys.executable, HERE / "fleet.py", *arguments, "-o", "out"], cwd=tmp_path,
                          capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.endswith("no such folder\n" if arguments[0] == "nowhere" else "no such file\n")
    assert done.stderr.count("\n") == 1
