# Most torque per ampere (src/reference.c): with |i_q| <= i_max and |s i_max| <= 11, the share of both is within 1.
@near = fixed<-24,nu>;
x = near(s_i_max * share);
exact = product / (1 + sqrt(1 + product * product)) * i_q;
{ s_i_max in [-11.00000006,11.00000006] /\ share in [-1,1] /\ product in [-11.01,11.01] /\ i_q in [-4,4] ->
x in [-11.0000001,11.0000001]
/\ exact in [-4.0001,4.0001]
}
exact $ product in 64;
