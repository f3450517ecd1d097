# Modulation by pulse pattern (pattern.h, src/pattern.c).
@near = fixed<-24,nu>;
@floor = fixed<-24,dn>;
# The index: two products, and the constant's own rounding.
half_pi = 26353589b-24;
index = near(near(u * inverse) * half_pi);
Index = u * inverse * pi_2;
# An angle between those of two rows: one floor, and the place's rounding.
angle = a + floor(part * rise);
Angle = a + Part * rise;
# An edge's time, for whole numbers of an angle's LSB: the distance is below the movement, so at most 1 LSB less.
at = near((movement - less) / movement);
{ u in [0,32] /\ inverse in [0,2] /\ near(u * inverse) in [0,0.7] /\ pi_2 - half_pi in [-1b-25,1b-25] /\
  part in [0,1] /\ Part - part in [-1b-25,1b-25] /\ rise in [-0.25,0.25] /\ movement in [1,2097152] /\ less in [1,2097152] /\
  (movement - less) / movement in [0,1] ->
# pattern.h: for a result up to 1: 1.7 LSB
|index - Index| * 1b24 <= 1.7
# pattern.h: against the line between the rows: 1.2 LSB
/\ |angle - Angle| * 1b24 <= 1.2
/\ at in [0,0.99999994]
}
index - Index -> (near(near(u * inverse) * half_pi) - near(u * inverse) * half_pi) + (near(u * inverse) - u * inverse) * pi_2 - near(u * inverse) * (pi_2 - half_pi);
angle - Angle -> (floor(part * rise) - part * rise) - (Part - part) * rise;
(movement - less) / movement -> 1 - less / movement;
