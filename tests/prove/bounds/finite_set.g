# What one interval adds to a sequence's cost (src/finite_set.c): components of an error are held to 32, three legs switch.
# Two intervals lie before the third.
{ a in [-32,32] /\ b in [-32,32] /\ weight in [0,1] /\ legs in [0,3] ->
  2 * (a * a + b * b + weight * legs) in [0,4102]
}
