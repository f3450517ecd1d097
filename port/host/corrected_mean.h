/*
 * Stability of PI control with the corrected mean (2016 (10)) as feedback: which bandwidth a scenario may ask for.
 *
 * The corrected mean is that of the cycle that has ended, so the loop is one cycle slower than with the mid-point
 * sample. The loop at constant speed is a linear system from valley to valley, exact in machine, sampling, delay and
 * angle advance. Its inductance is the mean of L_d and L_q, its resistance the motor file's. Below an SFFR of some
 * 7.5 no bandwidth is stable, as decoupling by the old mean turns the current further out.
 */
#ifndef PORT_HOST_CORRECTED_MEAN_H
#define PORT_HOST_CORRECTED_MEAN_H

#include "data/motor.h"
#include "data/scenario.h"

/* The largest modulus of the loop's poles: below 1 if it is stable. rpm: mechanical, of either sign. */
double corrected_mean_radius(const motor *m, double bandwidth_Hz, double rpm);

/*
 * The highest stable bandwidth in Hz at a speed, to 1 %, up to f_pwm_Hz/4; 0 if no bandwidth from f_pwm_Hz/1000 is
 * stable.
 */
double corrected_mean_bandwidth_Hz(const motor *m, double rpm);

/*
 * False with *e set if the scenario feeds back the corrected mean under PWM, and its bandwidth is unstable at a speed
 * that a run gives to the shaft. The message has the bandwidth, the speed, and the highest stable bandwidth there.
 */
bool corrected_mean_fits(const motor *m, const scenario *s, error *e);

#endif
