# Current control (current_control.h), one axis. A bound per unit of a current is that of its factor, and what is left.
@near = fixed<-24,nu>;
@down = fixed<-24,dn>;
sum = integral + kp * e;
u = down(sum);
reactance = near(turns * x);
apart = reactance * i + turns * emf;
v = down(apart);
floored = down(turns * x);
both = integral + kp * e + floored * i + turns * emf;
all = down(both);
{ integral in [-8,8] /\ kp in [0,32] /\ e in [-64,64] /\ turns in [-0.3334,0.3334] /\ x in [0,96] /\ emf in [0,96] /\ i in [-32,32] ->
# current_control.h: Largest error against double: 1 LSB (rounded down); of the integrator none
|u - sum| * 1b24 <= 1
# current_control.h: 0.5 LSB + 0.5 LSB per unit of i (the rounded reactance), rounded down: 1 LSB more
/\ |reactance - turns * x| * 1b24 <= 0.5
/\ |v - (turns * x * i + turns * emf) - (reactance - turns * x) * i| * 1b24 <= 1
# current_control.h: 1 LSB (rounded down) and 1 LSB per unit of i (the reactance, rounded down)
/\ |floored - turns * x| * 1b24 <= 1
/\ |all - (integral + kp * e + turns * x * i + turns * emf) - (floored - turns * x) * i| * 1b24 <= 1
}
v - (turns * x * i + turns * emf) - (reactance - turns * x) * i -> down(apart) - apart;
all - (integral + kp * e + turns * x * i + turns * emf) - (floored - turns * x) * i -> down(both) - both;
