/*
 * What a modulator adds to all three legs alike: the phases do not see it, but it says when each leg switches, and which one
 * does not. Of a recording without duties it has to be guessed.
 *
 * Common practice (Hava, Kerkman, Lipo: "A high-performance generalized discontinuous PWM algorithm", 1998): the middle between
 * the highest and the lowest phase (as space vectors do), nothing (sine), or one leg held at a rail for a third of the time or
 * for sixths of it.
 */
#ifndef SIM_HOST_MODEL_MODULATOR_H
#define SIM_HOST_MODEL_MODULATOR_H

typedef enum modulator {
    MODULATOR_MIN_MAX, /* space vectors with both zero vectors alike */
    MODULATOR_SINE,
    MODULATOR_LOW,     /* the lowest leg is held low (DPWMMIN), */
    MODULATOR_HIGH,    /* the highest high (DPWMMAX), */
    MODULATOR_LARGEST, /* that of the largest voltage at its rail (DPWM1), */
    MODULATOR_AHEAD,   /* the same by a voltage 30 degrees ahead (DPWM0), */
    MODULATOR_BEHIND,  /* or as much behind (DPWM2), */
    MODULATOR_MIDDLE,  /* that of the middle size (DPWM3) */
    MODULATORS
} modulator;

extern const char *const modulator_words[MODULATORS];

/* Duties, 0 to 1, of mean phase voltages under a link. Without a link every leg is at one half. */
void modulator_duties(modulator which, const double u_V[3], double u_dc_V, double duty[3]);

#endif
