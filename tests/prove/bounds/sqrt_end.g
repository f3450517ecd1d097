# The end of the square root (iq24_math.h, src/iq24_math.c): s is at most 1 below r, the root of m, and 0.02 above (sqrt.g).
@cut = int<zr>;
@near = int<nu>;
# m and s are whole: a difference below 131072 is at most 131071.
@whole = int<zr>;
s = r - t;
rest = r * r - s * s;
root = s * 32768 + cut(rest * 16384 / s);
{ r in [32768,65535.99999237] /\ t in [-0.02,1] /\ 1 - t in [0,1.02] /\ 2 * r - 1 - t in [65534,131072] ->
# 2^14 times the rest fits
whole(rest) in [-131071,131071]
# iq24_math.h: Error: 0.63 LSB at most
/\ |near(root / 8) - r * 4096| <= 0.63
# iq24_math.h: and 0.57 below 64.0
/\ |near(root / 16) - r * 2048| <= 0.57
}
rest -> t * (2 * r - t);
rest -> (2 * r - 1) - (1 - t) * (2 * r - 1 - t);
near(root / 8) - r * 4096 -> (near(root / 8) - root / 8) + (cut(rest * 16384 / s) - rest * 16384 / s) / 8 + t * t * 2048 / s;
near(root / 16) - r * 2048 -> (near(root / 16) - root / 16) + (cut(rest * 16384 / s) - rest * 16384 / s) / 16 + t * t * 1024 / s;
near(root / 8) - r * 4096, near(root / 16) - r * 2048 $ t in (0);
