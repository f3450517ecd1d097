# Deadbeat control (deadbeat.h), one component. m: all that the model adds without voltage, exact.
@near = fixed<-24,nu>;
@quotient = fixed<-24,na>;
inverse = quotient(1 / k_u);
alone = near(m);
change = target - alone;
u = near(change * inverse);
sum = m + k_u * u;
reached = near(sum);
{ k_u in [0.015625,16] /\ m in [-81,81] /\ target in [-32,32] ->
# deadbeat.h: 1/k_u to 0.5 LSB
|inverse - 1 / k_u| * 1b24 <= 0.5
# deadbeat.h: at most 1.5 LSB + 0.5 k_u (1 + |change|) LSB
# deadbeat.h: 4 LSB where both are about 1.5
# the voltage's rounding counts k_u times, the inverse's k_u |change| times, and what is left is two roundings
/\ |u - change * inverse| * 1b24 <= 0.5
/\ |reached - target - k_u * (u - change * inverse) - k_u * change * (inverse - 1 / k_u)| * 1b24 <= 1.5
}
reached - target - k_u * (u - change * inverse) - k_u * change * (inverse - 1 / k_u) ->
    (near(sum) - sum) - (near(m) - m);
