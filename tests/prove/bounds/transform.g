# Clarke, Park and their inverses (transform.h). The products with 1/sqrt(3) and sqrt(3)/2 are x plus a high word of
# twice the constant less 2^32.
@near = fixed<-24,nu>;
@down = fixed<-24,dn>;
# An even or odd number of LSB, halved and floored: half an LSB at most, so the nearest, ties down.
@half = fixed<-24,nd>;
# A number of LSB already: what is bounded by less than 3 is bounded by 2.
@whole = fixed<-24,zr>;
third = 1431655766b-32;
over_sqrt3 = -1815266772b-32;
half_sqrt3 = -575416510b-32;

x2 = a + 2 * b;
beta2 = x2 + near(x2 * over_sqrt3);
x3 = 2 * a - b - c;
alpha3 = near(x3 * third);
y3 = b - c;
beta3 = y3 + near(y3 * over_sqrt3);

vb = beta + near(beta * half_sqrt3) - half(alpha * 0.5);
vc = 0 - (alpha + vb);

d = near(alpha * cos + beta * sin);
q30 = down(alpha * cos - beta * sin);
{ a in [-31.9,31.9] /\ b in [-31.9,31.9] /\ c in [-31.9,31.9] /\ x2 in [-96,96] /\
  alpha in [-64,64] /\ beta in [-64,64] /\ sin in [-1,1] /\ cos in [-1,1] ->
# transform.h: their rounding costs at most |x| 2^-8 LSB
|1239850262b-31 - 1 / sqrt(3)| * 1b32 <= 1
/\ |715827883b-31 - 1 / 3| * 1b32 <= 1
/\ |1859775393b-31 - sqrt(3) / 2| * 1b32 <= 1
# transform.h: alpha exact, beta 0.7 LSB
/\ |beta2 - x2 / sqrt(3)| * 1b24 <= 0.69
# transform.h: Largest error: 0.7 LSB each
/\ |whole(3 * alpha3 - x3)| / 3 * 1b24 <= 0.69
/\ |beta3 - y3 / sqrt(3)| * 1b24 <= 0.69
# transform.h: a exact, b and c 1.2 LSB
# transform.h: alpha/2 is floored (0.5 LSB)
/\ |vb - (beta * (sqrt(3) / 2) - alpha * 0.5)| * 1b24 <= 1.2
/\ |vc - (0 - beta * (sqrt(3) / 2) - alpha * 0.5)| * 1b24 <= 1.2
# transform.h: |d|, |q| <= 90.6. Largest error: 0.5 LSB
/\ |d - (alpha * cos + beta * sin)| * 1b24 <= 0.5
# transform.h: |component| <= 64. Largest error: 1 LSB
/\ |q30 - (alpha * cos - beta * sin)| * 1b24 <= 1
}
beta2 - x2 / sqrt(3) -> (near(x2 * over_sqrt3) - x2 * over_sqrt3) + x2 * (1 + over_sqrt3 - 1 / sqrt(3));
beta3 - y3 / sqrt(3) -> (near(y3 * over_sqrt3) - y3 * over_sqrt3) + y3 * (1 + over_sqrt3 - 1 / sqrt(3));
3 * alpha3 - x3 -> 3 * ((near(x3 * third) - x3 * third) + x3 * (third - 1 / 3));
vb - (beta * (sqrt(3) / 2) - alpha * 0.5) ->
    (near(beta * half_sqrt3) - beta * half_sqrt3) + beta * (1 + half_sqrt3 - sqrt(3) / 2) - (half(alpha * 0.5) - alpha * 0.5);
vc - (0 - beta * (sqrt(3) / 2) - alpha * 0.5) -> 0 - (vb - (beta * (sqrt(3) / 2) - alpha * 0.5));
