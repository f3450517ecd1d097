#!/usr/bin/env python3
"""
The golden vectors and the closed loop with the option of port/c2000/iqfoc_tmu.h: what computes no sine has the digest of golden.txt, and the
loop controls. Argument: the program same_bits_tmu.
"""
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
WITHOUT_SINE = {"arithmetic", "atan2", "current_control", "div", "edges", "extension", "induction", "modulation", "overmodulation", "pattern",
                "predictor_salient", "recorder", "reference", "rotor", "six_step", "sqrt"}


def digests(text):
    return {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) == 2}


def main():
    done = subprocess.run([sys.argv[1]], capture_output=True, text=True, check=False)
    plain, tmu = digests((HERE.parent / "golden/golden.txt").read_text()), digests(done.stdout)
    same = {name for name in plain if tmu.get(name) == plain[name]}
    print(f"{len(same)} of {len(plain)} digests are those of golden.txt:", *sorted(same))
    wrong = sorted(WITHOUT_SINE - same)
    if wrong or "sincos" in same or done.returncode:
        print("not the same:", *wrong, f"; sincos is another: {'sincos' not in same}; status {done.returncode}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
