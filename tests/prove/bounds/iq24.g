# Products and sums of products of iq24.h: one rounding each of an exact value.
@near = fixed<-24,nu>;
@down = fixed<-24,dn>;
@unit = fixed<0,nu>;
{ a in [-128,128] /\ b in [-128,128] /\ sum in [-32768,32768] /\ scaled in [-0x80000000,0x80000000] ->
# iq24.h: error below 1 LSB (trunc) or <= 0.5 LSB (round, sat)
|down(a * b) - a * b| * 1b24 <= 1
/\ |near(a * b) - a * b| * 1b24 <= 0.5
# iq24.h: Error below 1 LSB where it fits; <= 0.5 LSB if the sum started from IQ24_ACC_HALF
/\ |down(sum) - sum| * 1b24 <= 1
/\ |down(sum + 1b-25) - sum| * 1b24 <= 0.5
# iq24.h: to the nearest iq24_t, ties up, wrapping. Error <= 0.5 LSB where it fits
# iq24.h: to the nearest iq24_t, ties up, saturating. Error <= 0.5 LSB where it fits
/\ |near(sum) - sum| * 1b24 <= 0.5
# iq24.h: Error <= 0.5 unit where it fits
/\ |unit(scaled) - scaled| <= 0.5
}
down(sum + 1b-25) - sum -> (down(sum + 1b-25) - (sum + 1b-25)) + 1b-25;
