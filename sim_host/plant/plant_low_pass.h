/*
 * The exact step of the current sensors' first-order low-pass, dy/dt = b (i - y).
 *
 * For a current i = c_0 + c_1 x + c_2 x^2 + ..., x = t/h from 0 to 1, and beta = b h:
 *
 *     y(h) = e^-beta y(0) + sum c_n w_n,     w_n = integral of beta e^(-beta (1 - x)) x^n over x
 *
 * The step is exact for any beta: a fast filter asks for no shorter step.
 */
#ifndef SIM_HOST_PLANT_PLANT_LOW_PASS_H
#define SIM_HOST_PLANT_PLANT_LOW_PASS_H

#define LOW_PASS_TERMS_MAX 21

/* weight[0 .. terms - 1] for beta > 0 and terms <= LOW_PASS_TERMS_MAX, to 1e-15; e^-beta = 1 - weight[0]. */
void low_pass_weights(double beta, int terms, double weight[]);

#endif
