# A step of R (src/observer_resistance.c): off is within 1 and the part along d at least 1/32, so that their quotient is within 32. For
# the other signs the same.
@near = fixed<-24,nu>;
change = near(off / along);
{ off in [0,1] /\ along in [0.03125,46] ->
change in [0,32]
}
