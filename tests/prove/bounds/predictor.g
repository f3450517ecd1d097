# One-cycle predictions (predictor.h); one component, the other has the cosine in the sine's place.
@near = fixed<-24,nu>;
@down = fixed<-24,dn>;
@down26 = fixed<-26,dn>;
@down30 = fixed<-30,dn>;
w = near(k_psi * phi);
sum = i * (1 - k_r) + k_u * u + w * sin;
next = near(sum);
left = i * (1 - k_r) + k_u * u;
# the cycle's w, of s1 in Q30 and turns (cycle_predict.h)
x_s1 = down30(x * s1);
phi_s1 = down26(x_s1 * 1686629713b-28);
w_cycle = down26(k_psi * phi_s1);
next_q30 = down(left) + down(w_q26 * sin);
{ i in [-32,32] /\ u in [-2,2] /\ k_u in [0,16] /\ k_r in [0,1] /\ k_psi in [0,8] /\ phi in [-2.0944,2.0944] /\
  sin in [-1,1] /\ w_q26 in [-13.9,13.9] /\ x in [-0.3334,0.3334] /\ s1 in [0.82,1] ->
# predictor.h: Range: |k_psi phi s1| <= 8 * 1.7321 = 13.9. Error: 0.5 LSB
|w - k_psi * phi| * 1b24 <= 0.5
# predictor.h: in the accumulator below 2^55. Error: one rounding, 0.5 LSB
/\ |next - sum| * 1b24 <= 0.5
# predictor.h: with the same coefficients, phi and sine: 1 LSB
# predictor.h: with the same coefficients, phi s1 and sine: 1 LSB
/\ |next - (left + k_psi * phi * sin)| * 1b24 <= 1
/\ |next| <= 80.8
# predictor.h: with the same coefficients, w and sine: 2 LSB
/\ |next_q30 - (left + w_q26 * sin)| * 1b24 <= 2
# cycle_predict.h: floors, 0.25 LSB, and 0.35 LSB per unit of k_psi
/\ |phi_s1 - x * s1 * 6.283185307179586| * 1b24 <= 0.35
/\ |w_cycle - k_psi * phi_s1| * 1b24 <= 0.25
}
next - (left + k_psi * phi * sin) -> (near(sum) - sum) + (w - k_psi * phi) * sin;
next_q30 - (left + w_q26 * sin) -> (down(left) - left) + (down(w_q26 * sin) - w_q26 * sin);
phi_s1 - x * s1 * 6.283185307179586 -> (down26(x_s1 * 1686629713b-28) - x_s1 * 1686629713b-28) +
    x_s1 * (1686629713b-28 - 6.283185307179586) + (down30(x * s1) - x * s1) * 6.283185307179586;
