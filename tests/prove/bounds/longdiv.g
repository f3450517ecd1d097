# One step of the long division (src/iq24_longdiv.h), d >= 2^24: trial = d/256 + more, 0 < more <= 1, so that the digit is
# never too large and at most 1 too small, and what is left is again within 0 ... 1.004 d. Where d < 2^24, more is 0. From
# that, quotient d = 2^24 n - rest after three digits: no more than 2^24 where n <= d, which src/iq24_trig.c relies on.
@floor = int<dn>;
d = 256 * (trial - more);
r = x * d;
digit = floor(r / trial);
{ x in [0,1.004] /\ trial in [65536,8388609] /\ more in [0,1] ->
256 * x - digit in [0,1.004]
/\ digit in [0,257.5]
}
256 * x - digit -> 256 * x * more / trial - (floor(r / trial) - r / trial);
r / trial -> 256 * x - 256 * x * more / trial;
