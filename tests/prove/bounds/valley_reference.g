# The valley's reference (valley_reference.h). s1 is the rotor's, 0.51 LSB from its own.
@near = fixed<-24,nu>;
@quotient = fixed<-24,na>;
square = near(s1 * s1);
gain = quotient(1 / square);
magnet = near(k_psi * (gain - 1));
valley = near(gain * mean) + magnet;
{ S1 in [0.8269,1] /\ s1 in [0.8268,1] /\ (s1 - S1) * 1b24 in [-0.51,0.51] /\ k_psi in [0,8] /\ mean in [-20,20] ->
# valley_reference.h: gain 3.4 LSB where s1 is least, magnet 0.5 LSB + 3.4 LSB per unit of k_psi
|gain - 1 / (S1 * S1)| * 1b24 <= 3.4
/\ |magnet - k_psi * (gain - 1)| * 1b24 <= 0.5
# valley_reference.h: Largest error with gain and magnet as given: 0.5 LSB
/\ |valley - (gain * mean + magnet)| * 1b24 <= 0.5
}
gain - 1 / (S1 * S1) -> (quotient(1 / square) - 1 / square) - ((square - s1 * s1) + (s1 - S1) * (s1 + S1)) / (square * S1 * S1);
valley - (gain * mean + magnet) -> near(gain * mean) - gain * mean;
