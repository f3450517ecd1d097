# 1/u_dc, followed by a Newton step a cycle (cycle_steps.h): from where it starts, 1, it never leaves 0.488 ... 2.012.
@near = fixed<-24,nu>;
@down27 = fixed<-27,dn>;
p = down27(u * r);
next = near(r * (2 - p));
held = near(r * 0.5);
{ u in [0.5,1.5] /\ r in [0.48828125,2.01171875] ->
  (2 - p >= 0.5 -> next in [0.48828125,2.01171875])
  /\ (2 - p <= 0.5 -> held in [0.48828125,2.01171875])
}
next $ r in 512;
held $ r in 64;
