# From one count on to another (src/encoder.c), both below n. Forwards: what n - 1 has beyond it is what n - 1 has beyond
# `to`, and `from`. Around: it is what `from` has beyond `to`, less 1. Neither is below 0.
{ rest in [0,65535] /\ from in [0,65535] /\ back in [1,65535] /\ n in [4,65536] ->
n - 1 - (n - 1 - rest - from) in [0,131070]
/\ n - 1 - (n - back) in [0,65534]
}
n - 1 - (n - 1 - rest - from) -> rest + from;
n - 1 - (n - back) -> back - 1;
