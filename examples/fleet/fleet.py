#!/usr/bin/env python3
"""Diagnoses a folder of recordings on a Dask cluster, and makes the fleet's page.

    fleet.py FOLDER -o OUT [--before OLD/batch.json] [--workers N | --scheduler tcp://...]

Each recording is a drive; its motor file is NAME.toml in the same folder, else FOLDER/motor.toml. OUT gets batch.json, a row a drive, and fleet.html.
Only as many recordings are under way as the workers can use, and only a row of each comes back, so that memory does not grow with the
fleet. What fails by itself is tried twice more; what cannot be used, or takes its worker with it, is a row that says so.
"""

import argparse
import itertools
import json
import os
import pathlib
import resource
import sys
import time

import dask
from dask.distributed import Client, LocalCluster, as_completed, wait
from distributed.scheduler import KilledWorker

import iqfoc
import page

RETRIES = 2
AHEAD = 2  # recordings a worker has, running and next
MEMORY = "1GB"


def recordings(folder):
    """Names of drives and their files, in order."""
    return {p.name.removesuffix(".gz").removesuffix(".csv"): p
            for p in sorted(folder.iterdir()) if p.name.endswith((".csv", ".csv.gz"))}


def motor_file(recording, name):
    own = recording.with_name(f"{name}.toml")
    return own if own.exists() else recording.with_name("motor.toml")


def diagnose(name, recording, motor):
    """The row of one drive. What cannot be used is a finding, not a failure."""
    try:
        found = iqfoc.diagnose(recording, motor)
    except iqfoc.InputError as words:
        return {"drive": name, "verdict": "unusable", "words": str(words), "causes": [], "estimates": {}}
    return {"drive": name, "verdict": found.verdict, "words": found.summary,
            "nominal": found.error.nominal, "extended": found.error.extended, "noise_floor": found.error.noise_floor,
            "causes": [{"id": c.id, "probability": c.probability, "gain": c.gain,
                        "parameters": {p.name: [p.value, p.nominal, p.unit, *(p.ci95 or (None, None))] for p in c.parameters}}
                       for c in found.causes],
            "estimates": {e["name"]: [e["value"], e["unit"], *(e["ci95"] or (None, None))] for e in found.data["estimates"] if e["excited"]}}


def failed(name, why):
    """The row of a drive that came back with an exception."""
    return {"drive": name, "verdict": "failed", "words": f"{type(why).__name__}: {why}".splitlines()[0][:300], "causes": [], "estimates": {}}


def run(client, files, task=diagnose, report=lambda row: None):
    """A row for each of {name: (recording, motor)}, in the order of the names. A worker that ends abnormally may have had several
    recordings, and any of them may be the reason: each of those is tried again at the end, alone."""
    room = AHEAD * max(1, sum(client.ncores().values()))
    waiting = iter(files)
    names = {}

    def begin(name):
        recording, motor = files[name]
        future = client.submit(task, name, str(recording), str(motor), retries=RETRIES, pure=False)
        names[future.key] = name
        return future

    under_way = as_completed([begin(name) for name in itertools.islice(waiting, room)])
    rows, suspects = {}, []
    for future in under_way:
        name = names.pop(future.key)
        why = None if future.status == "finished" else future.exception()
        if isinstance(why, KilledWorker):
            suspects.append(name)
        else:
            rows[name] = future.result() if why is None else failed(name, why)
            report(rows[name])
        future.release()
        for following in itertools.islice(waiting, 1):
            under_way.add(begin(following))
    for name in suspects:
        future = begin(name)
        wait(future)
        rows[name] = future.result() if future.status == "finished" else failed(name, future.exception())
        report(rows[name])
        future.release()
    return [rows[name] for name in files]


def careful():
    """A worker that a recording ends is restarted, and the recording is tried once more. No other recording waits on that worker."""
    dask.config.set({"distributed.scheduler.allowed-failures": 1, "distributed.scheduler.worker-saturation": 1.0})


def peak_MB():
    """The most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def processor_s():
    """Processor time of this process and of its threads."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def start(args):
    """A client of the cluster that was asked for."""
    if args.scheduler:
        return Client(args.scheduler)
    os.environ["IQFOC_JOBS"] = "1"  # a worker is a core
    cluster = LocalCluster(n_workers=args.workers, threads_per_worker=1, memory_limit=MEMORY, dashboard_address=None)
    return Client(cluster)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--before", type=pathlib.Path, help="batch.json of the batch before, for what changed")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--scheduler", help="the address of a cluster that runs already")
    args = parser.parse_args()
    if not args.folder.is_dir():
        sys.exit(f"{args.folder}: no such folder")
    if args.before and not args.before.is_file():
        sys.exit(f"{args.before}: no such file")
    before = json.loads(args.before.read_text(encoding="utf-8")) if args.before else None
    files = {name: (path, motor_file(path, name)) for name, path in recordings(args.folder.resolve()).items()}
    if not files:
        sys.exit(f"{args.folder}: no recordings (*.csv, *.csv.gz)")
    careful()
    done = 0

    def report(row):
        nonlocal done
        done += 1
        if sys.stderr.isatty():
            print(f"\r{done} of {len(files)}", end="", file=sys.stderr, flush=True)

    with start(args) as client:
        client.wait_for_workers(1)
        begin, before_s = time.monotonic(), sum(client.run(processor_s).values())
        rows = run(client, files, report=report)
        took_s, used_s = time.monotonic() - begin, sum(client.run(processor_s).values()) - before_s
        worker_MB = max(client.run(peak_MB).values())
        if client.cluster is not None:
            client.cluster.close()
    batch = {"schema": 1, "folder": args.folder.name, "iqfoc": iqfoc.__version__, "rows": rows}
    args.output.mkdir(parents=True, exist_ok=True)
    (args.output / "batch.json").write_text(json.dumps(batch, indent=1) + "\n", encoding="utf-8")
    (args.output / "fleet.html").write_text(page.page(batch, before), encoding="utf-8")
    bad = sum(r["verdict"] in ("unusable", "failed") for r in rows)
    print(f"{len(rows)} recordings in {took_s:.1f} s, {used_s:.1f} s of the workers' processor time, {bad} without a diagnosis, "
          f"{worker_MB:.0f} MB a worker at most; "
          f"{args.output / 'fleet.html'}")


if __name__ == "__main__":
    main()
