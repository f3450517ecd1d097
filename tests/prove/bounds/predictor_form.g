# The predictors as coefficients of the exact step (predictor_form.h).
@near = fixed<-24,nu>;
@near26 = fixed<-26,nu>;
# A number of LSB already: what is bounded by less than 2 is bounded by 1.
@whole = fixed<-24,zr>;
left = i * (1 - k_r) + k_u * u;
w26 = near26(a * b);
w = near(a * b);
form = left + w26 * sin;
own = left + w * sin;
{ a in [-8,8] /\ b in [-2.1,2.1] /\ i in [-32,32] /\ u in [-2,2] /\ k_u in [0,16] /\ k_r in [0,1] /\ sin in [-1,1] ->
# predictor_form.h: error 1/8 LSB
|w26 - a * b| * 1b24 <= 0.125
# predictor_form.h: Ranges as there; difference 1 LSB
/\ |whole(near(form) - near(own))| * 1b24 <= 1
}
near(form) - near(own) -> (near(form) - form) - (near(own) - own) + ((w26 - a * b) - (w - a * b)) * sin;
