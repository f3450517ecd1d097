# Control of a pulse pattern (src/pattern_control.c, pattern_trajectory.c): pattern_l, pattern_cycles, pattern_link, pattern_moved_time.
@near = fixed<-24,nu>;
@low = fixed<-24,dn>;
# L I_b/(U_b T) of k_u, and a quarter of the cycles of a turn.
l = near(1 / k_u);
quarter = near(0.25 / speed);
# 1/u_dc by a Newton step a cycle: the mean moves by at most 1/64 and an LSB. 1 - mean inverse stays within 1/30, and so the inverse.
moved = mean + change;
off = (1 - mean * inverse) - change * inverse;
rest = 1 - low(moved * inverse);
next = inverse + low(inverse * rest);
# An edge's time, in whole LSB: its angle is at least one below the movement. The cycles of a turn are off by half a unit.
ticks = 70368744177664 / movement + half;
time = (movement - less) * ticks / 4194304;
{ k_u in [0.125,16] /\ speed in [0.0078125,0.125] /\ mean in [0.5,1.5] /\ moved in [0.5,1.5] /\ change in [-0.0156251,0.0156251] /\
  inverse in [0.644442,2.066669] /\ 1 - mean * inverse in [-0.033333,0.033333] /\
  movement in [131072,2097152] /\ less in [1,2097152] /\ movement - less in [0,2097151] /\ half in [-0.5,0.5] ->
l in [0.0625,8]
/\ quarter in [2,32]
/\ 1 - moved * next in [-0.033333,0.033333]
/\ next in [0.644442,2.066669]
/\ time >= 0
/\ time <= 16777215.9
}
moved * inverse -> 1 - off;
1 - moved * next -> off * off + (1 - off) * (low(moved * inverse) - moved * inverse) - moved * (low(inverse * rest) - inverse * rest);
next -> (1 - (1 - moved * next)) / moved;
time -> 16777216 - 16777216 * (less / movement) + half * (movement - less) / 4194304;
