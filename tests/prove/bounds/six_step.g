# The voltage of an inverter's state (modulation.h, finite_set.h): twice a third of the DC link, or a root of a third.
@near = fixed<-24,nu>;
# A number of LSB already: what is bounded by less than 2 is bounded by 1.
@whole = fixed<-24,zr>;
third = near(u * 715827883b-31);
root = near(u * 1239850262b-31);
{ u in [-63.999999,63.999999] ->
# modulation.h: |u_dc| < 64: 0 for another state. Error 0.7 LSB
# finite_set.h: |u_dc| <= 32: error 0.7 LSB
2 * |whole(3 * third - u)| / 3 * 1b24 <= 0.7
/\ |root - u / sqrt(3)| * 1b24 <= 0.7
}
3 * third - u -> 3 * (near(u * 715827883b-31) - u * 715827883b-31) + u * (3 * 715827883b-31 - 1);
root - u / sqrt(3) -> (near(u * 1239850262b-31) - u * 1239850262b-31) + u * (1239850262b-31 - 1 / sqrt(3));
