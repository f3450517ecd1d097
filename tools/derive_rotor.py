#!/usr/bin/env python3
"""Computes the coefficients of the rotor-movement polynomials in src/rotor.c.

    s1(phi) = sin(phi/2)/(phi/2)                          = P1(v)
    s2(phi) = (2 sin(phi/2) - phi cos(phi/2))/phi^2       = x P2(v)
    g(phi)  = s1 + 2 tan(phi/2) s2 = sin(h) tan(h) / h^2  = P3(4 v),   h = phi/2, in Q27

with x = phi/(2 pi) in turns, v = x^2, |x| <= 1/3. Each polynomial interpolates at the Chebyshev nodes of v in
[0, 1/9] (within a small factor of the minimax error) and is printed in Q30 (P3 in Q27), lowest power first.

Usage: tools/derive_rotor.py [--check FILE]   (--check: fail unless FILE holds exactly these tables)
"""
import math
import re
import sys

V_MAX = 1.0 / 9.0


def s1(v):
    h = math.pi * math.sqrt(v)
    return math.sin(h) / h if h > 1e-4 else 1 - h * h / 6


def s2_over_x(v):
    """s2/x from its series: the closed form subtracts nearly equal numbers at small x."""
    phi2 = 4 * math.pi * math.pi * v
    term, total, n = 1.0, 0.0, 0
    # 2 sin(p/2) - p cos(p/2) = sum (-1)^n p^(2n+1) 2^-2n / (2n)! * (1/(2n+1) - 1)
    while n < 30:
        n += 1
        coefficient = (-1) ** n / (4.0**n * math.factorial(2 * n)) * (1.0 / (2 * n + 1) - 1.0)
        total += coefficient * phi2 ** (n - 1)
    return 2 * math.pi * total


def steady_gain(v):
    h = math.pi * math.sqrt(v)
    return math.sin(h) * math.tan(h) / (h * h) if h > 1e-4 else 1 + h * h / 6


def poly_add(p, q):
    n = max(len(p), len(q))
    return [(p[k] if k < len(p) else 0.0) + (q[k] if k < len(q) else 0.0) for k in range(n)]


def poly_mul(p, q):
    result = [0.0] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for k, b in enumerate(q):
            result[i + k] += a * b
    return result


def fit(function, count, scale, q=30):
    """Coefficients in Q(q) of a polynomial in w = scale*v, lowest power first."""
    nodes = [math.cos(math.pi * (k + 0.5) / count) for k in range(count)]
    values = [function(V_MAX * (t + 1) / 2) for t in nodes]
    to_t = [-1.0, 2.0 / (scale * V_MAX)]  # t = 2 w / (scale V_MAX) - 1
    result = [0.0]
    before, now = [1.0], to_t  # the Chebyshev polynomials T_j(t) as polynomials in w
    for j in range(count):
        c = sum(f * math.cos(j * math.pi * (k + 0.5) / count) for k, f in enumerate(values)) * 2 / count
        result = poly_add(result, [(c / 2 if j == 0 else c) * a for a in before])
        before, now = now, poly_add([2 * a for a in poly_mul(to_t, now)], [-a for a in before])
    return [round(c * 2**q) for c in result]


TABLES = {
    "iqfoc_rotor_poly": [c for pair in zip(fit(s1, 5, 1.0), fit(s2_over_x, 5, 1.0)) for c in pair],
    "steady_gain_poly": fit(steady_gain, 10, 4.0, 27),
}


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "--check":
        text = open(sys.argv[2], encoding="utf-8").read()
        for name, values in TABLES.items():
            match = re.search(name + r"[\[\]\w]*\s*=\s*\{([^;]*)\};", text)
            found = [int(v) for v in re.findall(r"-?\d+", match.group(1))] if match else None
            if found != values:
                print(f"{sys.argv[2]}: {name} is {found}, derived {values}", file=sys.stderr)
                return 1
        return 0
    for name, values in TABLES.items():
        print(f"{name}: " + ", ".join(str(v) for v in values))
    return 0


if __name__ == "__main__":
    sys.exit(main())
