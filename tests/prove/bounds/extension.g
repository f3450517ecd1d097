# What a diagnosis found, put right (extension.h). Clamps bring nothing further apart and are left out.
@near = fixed<-24,nu>;
current = near((measured - offset) * gain);
angle = theta - (theta_0 + near(delay * speed));
share = near(i * knee);
lost = near(v_dead * share_held);
more = near(lost * inverse);
square = near(Square);
rise = near(saturation * square);
coefficient = near(k * (1 + rise));
acting = near(u * k_u) - common;
{ measured in [-31,31] /\ offset in [-1,1] /\ gain in [0.5,2] /\ delay in [-8,8] /\ speed in [-1,1] /\ i in [-128,128] /\
  knee in [0,127] /\ v_dead in [-0.25,0.25] /\ share_held in [-1,1] /\ Share in [-1,1] /\ (share_held - Share) * 1b24 in [-0.5,0.5] /\
  inverse in [0,2] /\ Square in [0,50] /\ saturation in [0,4] /\ k in [0,16] /\ rise in [0,1] /\ u in [-16,16] /\ k_u in [0.5,2] /\
  (common - Common) * 1b24 in [-1.53,1.53] ->
# extension.h: held to +-15.9, what the cycle takes. Largest error: 0.5 LSB
|current - (measured - offset) * gain| * 1b24 <= 0.5
# extension.h: whole turns are immaterial. |speed| <= 1. Largest error: 0.5 LSB
/\ |angle - (theta - (theta_0 + delay * speed))| * 1b24 <= 0.5
/\ |share - i * knee| * 1b24 <= 0.5
# extension.h: 0.63 LSB, the quotient's 0.5 LSB times v_dead and one more rounding
/\ |lost - v_dead * Share| * 1b24 <= 0.63
# extension.h: as iqfoc_clarke_inverse gives them: 2.1 LSB (of 300000 drawn 1.6)
# three legs' 0.63 LSB in clarke3 are 4/3 of one, and its own 0.69
/\ |acting - (u * k_u - Common)| * 1b24 <= 2.1
# extension.h: 0 < u_dc_inverse <= 2. Largest error: 1.8 LSB
/\ |more - v_dead * Share * inverse| * 1b24 <= 1.8
# extension.h: 2.5 LSB per unit of the coefficient, and 0.5 LSB
/\ |rise - saturation * Square| * 1b24 <= 2.5
/\ |coefficient - k * (1 + rise)| * 1b24 <= 0.5
}
angle - (theta - (theta_0 + delay * speed)) -> 0 - (near(delay * speed) - delay * speed);
lost - v_dead * Share -> (near(v_dead * share_held) - v_dead * share_held) + v_dead * (share_held - Share);
more - v_dead * Share * inverse -> (near(lost * inverse) - lost * inverse) + (lost - v_dead * Share) * inverse;
rise - saturation * Square -> (near(saturation * square) - saturation * square) + saturation * (square - Square);
acting - (u * k_u - Common) -> (near(u * k_u) - u * k_u) - (common - Common);
