#!/usr/bin/python3
"""Effects that the list of causes does not have: none may be named for them, and none is clean. Each had a false cause once.

    tests/blind/unnamed.py --iqfoc build/host/iqfoc
"""

import argparse
import os
import sys

import run

# An angle's error of the third order called a flux map, twice; a sensor with hysteresis called a voltage delay and sensors' gains;
# mains in the voltage called a flux map.
CASES = [(83007, "angle_order", "main"), (98003, "angle_order", "main"), (96002, "sensor_hysteresis", "second"),
         (96102, "mains_hum", "second")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--iqfoc", default=os.path.join(run.ROOT, "build", "host", "iqfoc"))
    iqfoc = os.path.abspath(parser.parse_args().iqfoc)
    results, failures = run.run_cases([run.Case(*case, True, None, iqfoc, None) for case in CASES], os.cpu_count())
    for r in results:
        print(f"seed {r['seed']} {r['kind']} {r['plant']}: named {'+'.join(r['named']) or 'nothing'} ({r['verdict']})")
    for case, words in failures:
        print(f"failed: seed {case.seed} {case.kind}: {words}")
    return 1 if failures or any(r["named"] or r["verdict"] != "unexplained" for r in results) else 0


if __name__ == "__main__":
    sys.exit(main())
