# The ripple's vector (ripple.h), one leg and then the Clarke transform of three; u_dc is 1.5.
@near = fixed<-24,nu>;
d2 = near(d * d);
cube = near(d * d2);
bow = d - cube;
Bow = d - d * d * d;
curve = near(square * (1 + d2));
Curve = square * (1 + d * d);
leg = bow - near(bow * curve);
Leg = Bow - Bow * Curve;
scaled = near(v * u_dc);
{ d in [0,1] /\ square in [0,0.055] /\ (v - V) * 1b24 in [-2.96,2.96] /\ v in [-0.4,0.4] /\ u_dc in [0,1.5] ->
|leg - Leg| * 1b24 <= 1.7
# ripple.h: 5 LSB at u_dc = 1.5
# clarke3 of three legs: 4/3 of a leg's error and its own 0.69, in the worst case
/\ |scaled - V * u_dc| * 1b24 <= 5
}
cube - d * d * d -> (near(d * d2) - d * d2) + d * (d2 - d * d);
bow - Bow -> 0 - (cube - d * d * d);
curve - Curve -> (near(square * (1 + d2)) - square * (1 + d2)) + square * (d2 - d * d);
leg - Leg -> (bow - Bow) * (1 - curve) - Bow * (curve - Curve) - (near(bow * curve) - bow * curve);
scaled - V * u_dc -> (near(v * u_dc) - v * u_dc) + (v - V) * u_dc;
$ d in 32;
