# The proof itself: a product rounded to nearest is not within 0.4 LSB.
@near = fixed<-24,nu>;
{ a in [-128,128] /\ b in [-128,128] -> |near(a * b) - a * b| * 1b24 <= 0.4 }
