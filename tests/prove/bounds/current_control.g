# Current control (current_control.h), one axis. A bound per unit of a current is that of its factor, and what is left.
@near = fixed<-24,nu>;
@down = fixed<-24,dn>;
sum = integral + kp * e;
u = down(sum);
reactance = near(speed * x);
apart = reactance * i + speed * emf;
v = down(apart);
floored = down(speed * x);
both = integral + kp * e + floored * i + speed * emf;
all = down(both);
{ integral in [-8,8] /\ kp in [0,32] /\ e in [-64,64] /\ speed in [-0.3334,0.3334] /\ x in [0,96] /\ emf in [0,96] /\ i in [-32,32] ->
# current_control.h: Largest error against double: 1 LSB (rounded down); of the integrator none
|u - sum| * 1b24 <= 1
# current_control.h: 0.5 LSB + 0.5 LSB per unit of i (the rounded reactance), rounded down: 1 LSB more
/\ |reactance - speed * x| * 1b24 <= 0.5
/\ |v - (speed * x * i + speed * emf) - (reactance - speed * x) * i| * 1b24 <= 1
# current_control.h: 1 LSB (rounded down) and 1 LSB per unit of i (the reactance, rounded down)
/\ |floored - speed * x| * 1b24 <= 1
/\ |all - (integral + kp * e + speed * x * i + speed * emf) - (floored - speed * x) * i| * 1b24 <= 1
}
v - (speed * x * i + speed * emf) - (reactance - speed * x) * i -> down(apart) - apart;
all - (integral + kp * e + speed * x * i + speed * emf) - (floored - speed * x) * i -> down(both) - both;
