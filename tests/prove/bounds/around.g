# What stands around the cycle: encoder.h, start.h, tracker.h, offset.h, halls.h, tuned_control.h, overmodulation.h.
@near = fixed<-24,nu>;
@quotient = fixed<-24,na>;
@down = fixed<-24,dn>;
@near32 = fixed<-32,nu>;
@down32 = fixed<-32,dn>;
@down48 = fixed<-48,dn>;
per_count = down48(pairs / counts);
encoder = near(count * per_count);
share = quotient(done / all);
part = near(whole * share);
ahead = near(speed * at);
handover = near(current * sc);
tracked = down(theta32 + down32(speed32 * at8));
tracked_speed = near(speed32);
mean = near(Mean);
hall_speed = down((angle + half) / span);
moved = down(turned * since);
rippled = near(ripple);
keep_cos = near(keep * cos);
voltage = near(alpha * u_dc);
inverse = quotient(1 / s1);
limit = near((inverse + s1 - phi_s2) * 683565276b-31);
{ pairs in [1,64] /\ counts in [4,65536] /\ count in [0,65535] /\ done in [0,1] /\ all in [1,1] /\ whole in [-16,16] /\
  speed in [-0.3334,0.3334] /\ at in [-1,1] /\ current in [-16,16] /\ sc in [-1,1] /\ Sc in [-1,1] /\ (sc - Sc) * 1b24 in [-0.51,0.51] /\
  speed32 in [-0.3334,0.3334] /\ at8 in [-8,8] /\ theta32 in [-0.5,0.5] /\ Mean in [-128,128] /\ angle in [0,1] /\ span in [1b-8,6291456] /\
  half / span * 1b24 in [0,0.5] /\ turned in [-0.3334,0.3334] /\ since in [0,1048577] /\ ripple in [-64,64] /\ keep in [0,1] /\ cos in [-1,1] /\ Cos in [-1,1] /\ (cos - Cos) * 1b24 in [-0.51,0.51] /\
  alpha in [-1.34,1.34] /\ Alpha in [-1.34,1.34] /\ (alpha - Alpha) * 1b24 in [-0.69,0.69] /\ u_dc in [0,2] /\
  S1 in [0.8269,1] /\ s1 in [0.8268,1] /\ (s1 - S1) * 1b24 in [-0.51,0.51] /\ Phi_s2 in [0,0.327] /\ phi_s2 in [0,0.327] /\
  (phi_s2 - Phi_s2) * 1b24 in [-0.6,0.6] ->
# encoder.h: below counts_per_turn. Largest error: 0.51 LSB
|encoder - count * pairs / counts| * 1b24 <= 0.51
# start.h: current 0.5 LSB, and 0.5 LSB per unit of i_align
# start.h: angle and the speed of the run-up 1 LSB per cycle
/\ |share - done / all| * 1b24 <= 0.5
/\ |part - whole * share| * 1b24 <= 0.5
# start.h: -1 ... 1: turns. Error 0.5 LSB
/\ |ahead - speed * at| * 1b24 <= 0.5
# start.h: 0.51 LSB per unit of the current, and 0.5
/\ |handover - current * Sc - current * (sc - Sc)| * 1b24 <= 0.5
# tracker.h: Largest error 1 LSB of the tracker's own
# observer.h: Largest error 1 LSB of the observer's own
/\ |tracked - theta32 - speed32 * at8| * 1b24 <= 1.004
# tracker.h: Error 0.5 LSB of the tracker's own
# observer.h: Error 0.5 LSB of the observer's own
/\ |tracked_speed - speed32| * 1b24 <= 0.5
# offset.h: offset 0.5 LSB of the exact mean
/\ |mean - Mean| * 1b24 <= 0.5
# halls.h: speed 1 LSB
/\ |hall_speed - angle / span| * 1b24 <= 1
# halls.h: theta 1 LSB per cycle since the border, and 1 LSB
# the speed's LSB, times the cycles, and what is floored here
/\ |moved - turned * since| * 1b24 <= 1
# induction.h: Rounding: 1 LSB more
/\ |rippled - ripple| * 1b24 <= 0.5
# tuned_control.h: keep_cos and keep_sin 1.1 LSB
/\ |keep_cos - keep * Cos| * 1b24 <= 1.1
# overmodulation.h: for u_dc, 0 ... 2: largest error 1.9 LSB
/\ |voltage - Alpha * u_dc| * 1b24 <= 1.9
# overmodulation.h: rotor: of the speed. Largest error 1.3 LSB
/\ |limit - (1 / S1 + S1 - Phi_s2) * 0.31830988618379067| * 1b24 <= 1.3
}
encoder - count * pairs / counts -> (near(count * per_count) - count * per_count) + count * (per_count - pairs / counts);
handover - current * Sc - current * (sc - Sc) -> near(current * sc) - current * sc;
tracked - theta32 - speed32 * at8 ->
    (down(theta32 + down32(speed32 * at8)) - (theta32 + down32(speed32 * at8))) + (down32(speed32 * at8) - speed32 * at8);
hall_speed - angle / span -> (down((angle + half) / span) - (angle + half) / span) + half / span;
keep_cos - keep * Cos -> (near(keep * cos) - keep * cos) + keep * (cos - Cos);
voltage - Alpha * u_dc -> (near(alpha * u_dc) - alpha * u_dc) + (alpha - Alpha) * u_dc;
limit - (1 / S1 + S1 - Phi_s2) * 0.31830988618379067 ->
    (near((inverse + s1 - phi_s2) * 683565276b-31) - (inverse + s1 - phi_s2) * 683565276b-31) +
    (inverse + s1 - phi_s2) * (683565276b-31 - 0.31830988618379067) +
    ((quotient(1 / s1) - 1 / s1) + (s1 - S1) * (1 - 1 / (s1 * S1)) - (phi_s2 - Phi_s2)) * 0.31830988618379067;
