# A step of L_q (src/observer_inductance.c): x/(x^2 + least^2) is at most 1/(2 least), 8, and the squares' rounding. For negative x
# the same with the other sign.
@near = fixed<-24,nu>;
share = near(x / (x * x + least * least + e));
{ least in [0.0625,1] /\ x in [0.0625,8] /\ e in [-1b-24,1b-24] ->
share in [0,9]
}
x / (x * x + least * least + e) -> 1 / ((x - least) * (x - least) / x + 2 * least + e / x);
