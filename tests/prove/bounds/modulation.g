# Duties (modulation.h, overmodulation.h). With v = (A, B) the voltage over the DC link, in LSB:
#     da, db   what its floors take, -1 ... 0         k    what sqrt(3)/2 is off by, times |v| <= 1
#     r        rounding of sqrt(3)/2 beta             h    floor of half an alpha, 0 or -1/2
#     f        floor of half of 1 less the span, 0 or -1/2
# so that phase a is off by da, b by r + k + sqrt(3)/2 db - da/2 - h, and c by what makes their sum 0. A duty is
# phase + (1 - (high - low))/2 - low: each phase in each order of the three, and where two are nearly equal and a rounding
# chooses the other, the error lies between those of both choices.
@down = fixed<-24,dn>;
scale = down((span_max - 1b-24) / span - digit);
{ da in [-1,0] /\ db in [-1,0] /\ r in [-0.5,0.5] /\ h in [-0.5,0] /\ f in [-0.5,0] /\ k in [-0.004,0.004] /\
  span in [0.5,111] /\ span_max in [0.5,1] /\ digit in [0,1b-24] ->
# modulation.h: a duty within the hexagon 3 LSB
# modulation.h: Error within the hexagon, all floors: voltage over u_dc 1 LSB, inverse Clarke 1.2
# overmodulation.h: Duties lie in [0, 1]. Largest error 3 LSB
|0.75 * da - 0.5 * (sqrt(3) / 2) * db - 0.5 * r - 0.5 * k + 0.5 * h + f| <= 3
/\ |0.75 * da + 0.5 * (sqrt(3) / 2) * db + 0.5 * r + 0.5 * k - 0.5 * h + f| <= 3
/\ |1.5 * da + f| <= 3
/\ |0 - 0.75 * da + 0.5 * (sqrt(3) / 2) * db + 0.5 * r + 0.5 * k - 0.5 * h + f| <= 3
/\ |0 - 0.75 * da + 1.5 * (sqrt(3) / 2) * db + 1.5 * r + 1.5 * k - 1.5 * h + f| <= 3
/\ |(sqrt(3) / 2) * db + r + k - h + f| <= 3
/\ |0 - 0.75 * da - 1.5 * (sqrt(3) / 2) * db - 1.5 * r - 1.5 * k + 1.5 * h + f| <= 3
/\ |0 - 0.75 * da - 0.5 * (sqrt(3) / 2) * db - 0.5 * r - 0.5 * k + 0.5 * h + f| <= 3
/\ |0 - (sqrt(3) / 2) * db - r - k + h + f| <= 3
# overmodulation.h: 3 LSB + 1 LSB per unit of
# a unit of |v| more makes k 2^-8 more, which counts 1.5 times
/\ 1.5 * |1 - 575416510b-32 - sqrt(3) / 2| * 1b24 <= 1
# modulation.h: 1 LSB <= span_max < span; with span_max >= 1/2 the largest error is 7 LSB, downwards
/\ |scale - span_max / span| * 1b24 <= 7
}
scale - span_max / span -> (down((span_max - 1b-24) / span - digit) - ((span_max - 1b-24) / span - digit)) - digit - 1b-24 / span;
