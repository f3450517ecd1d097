# Mean currents (mean_current.h). The angle's sine is the root of what its square leaves of 1, both being rounded: q. A
# sine of the other sign, or the smaller of the two, only renames components, whose errors have the same bounds; so the
# cosine is the smaller one here, and one component stands for both.
@near = fixed<-24,nu>;
@down = fixed<-24,dn>;
@half = fixed<-24,nd>;
sin = sqrt(q - cos * cos);

# general and steady: v = s1 i - j s2 delta, or gain i
va = near(s1 * ia + s2 * db);
vb = near(s1 * ib - s2 * da);
Va = s1 * ia + s2 * db;
Vb = s1 * ib - s2 * da;
P = va * cos + vb * sin;
d = near(P);

# from the prediction, given or made here
m = near(k_psi * phi_s2);
mean = half((i + i_next) * 0.5) - near(m * cos);
E = (i + i_next) * 0.5 - k_psi * phi_s2 * cos;
Made = (i + Next) * 0.5 - k_psi * phi_s2 * cos;

# seen from the rotor: v is floored
ta = down(Ta);
tb = down(Tb);
S = ta * cos + tb * sin - w * s2;
seen = near(S);
F = ta * cos + tb * sin;
seen_q30 = down(F) - down(w * s2);
{ cos in [-0.7072,0.7072] /\ q in [0.99999976,1.00000024] /\ s1 in [0.8269,1.38] /\ s2 in [-0.1564,0.1564] /\
  ia in [-48,48] /\ ib in [-48,48] /\ da in [-48,48] /\ db in [-48,48] /\ i in [-32,32] /\ i_next in [-80.8,80.8] /\
  Next in [-80.8,80.8] /\ (i_next - Next) * 1b24 in [-1,1] /\ k_psi in [0,8] /\ phi_s2 in [0,0.327] /\
  Ta in [-48,48] /\ Tb in [-48,48] /\ w in [-13.9,13.9] ->
# mean_current.h: with s1, s2 and sine as given: 1.3 LSB
# mean_current.h: with gain and sine as given: 1.3 LSB
# mean_current.h: v is rounded once (0.5 LSB a component
|d - (Va * cos + Vb * sin)| * 1b24 <= 1.3
# mean_current.h: Largest error with i_next as given: 1.5 LSB
# mean_current.h: the half is floored (0.5 LSB at most), q and its product are rounded
/\ |mean - E| * 1b24 <= 1.5
# mean_current.h: phi s1, phi s2 and sine: 2 LSB
/\ |mean - Made| * 1b24 <= 2
# mean_current.h: Largest error with i_next and w as given: 1.92 LSB
# mean_current.h: by less than 1 LSB a component
/\ |seen - (Ta * cos + Tb * sin - w * s2)| * 1b24 <= 1.92
# mean_current.h: Largest error with them and i_next as given: 3.2 LSB
/\ |seen_q30 - (Ta * cos + Tb * sin - w * s2)| * 1b24 <= 3.2
}
d - (Va * cos + Vb * sin) -> (near(P) - P) + ((va - Va) * cos + (vb - Vb) * sin);
mean - E -> (half((i + i_next) * 0.5) - (i + i_next) * 0.5) - ((near(m * cos) - m * cos) + (m - k_psi * phi_s2) * cos);
mean - Made -> (mean - E) + (i_next - Next) * 0.5;
seen - (Ta * cos + Tb * sin - w * s2) -> (near(S) - S) + ((ta - Ta) * cos + (tb - Tb) * sin);
seen_q30 - (Ta * cos + Tb * sin - w * s2) -> (down(F) - F) - (down(w * s2) - w * s2) + ((ta - Ta) * cos + (tb - Tb) * sin);
d - (Va * cos + Vb * sin),
seen - (Ta * cos + Tb * sin - w * s2),
seen_q30 - (Ta * cos + Tb * sin - w * s2) $ cos in 64;
