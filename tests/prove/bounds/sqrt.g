# The square root (iq24_math.h, src/iq24_math.c) on m = x 4^k, r its root: a line, two of Heron's steps, and what is left.
@floor = int<dn>;
@cut = int<zr>;
@near = int<nu>;
m = r * r;
low = floor(m / 32768);
line = 22528 + floor(low * 11 / 32);
Line = 22528 + r * r * 11b-20;
first = floor((line + floor(m / line)) / 2);
second = floor((first + floor(m / first)) / 2);
{ r in [32768,65535.99999237] ->
# what src/iq24_math.c says of its two steps; that none leads below the floor of r, so that r - s <= 1, needs no proof by
# ranges: the mean of s and m/s is above r, and a floor of it above the floor of r
first - r in [-1.6,36]
/\ second - r in [-1.6,0.02]
}
line - Line -> (floor(low * 11 / 32) - low * 11 / 32) + (floor(m / 32768) - m / 32768) * 11 / 32;
line - r -> (line - Line) + (Line - r);
first - r -> (floor((line + floor(m / line)) / 2) - (line + floor(m / line)) / 2) + (floor(m / line) - m / line) / 2 + (line - r) * (line - r) / (2 * line);
second - r -> (floor((first + floor(m / first)) / 2) - (first + floor(m / first)) / 2) + (floor(m / first) - m / first) / 2 + (first - r) * (first - r) / (2 * first);
first - r, second - r $ r in 64;
