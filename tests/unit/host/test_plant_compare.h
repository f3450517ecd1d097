/*
 * Runs the plant and its reference side by side and notes how far they are apart.
 */
#ifndef TESTS_UNIT_TEST_PLANT_COMPARE_H
#define TESTS_UNIT_TEST_PLANT_COMPARE_H

#include "plant/plant.h"
#include "test_plant_reference.h"

/* The largest differences seen, relative to the rated peak current (the angle in rad, the speed relative). */
typedef struct comparison {
    double current, mean, mean_dq, angle, speed, seen;
} comparison;

/* The 2019 paper's laboratory drive at a given speed, its L_q scaled, the rotor at 0.3 rad. */
plant_config compare_drive(double L_q_ratio, double omega_e_rad_s);

/* The same machine and shaft, written in phase variables. */
reference compare_reference(const plant_config *c);

/*
 * Duties that roughly hold i_q: the steady state's voltage at the rotor's middle angle, and a little wobble.
 */
void compare_duties(const plant *p, int cycle, double i_q, double duty[3]);

void compare_note(comparison *w, const plant *p, const reference *r);

/* So many cycles with ideal legs; prints what it saw. */
comparison compare_run(const char *name, const plant_config *c, double i_q, int cycles);

void compare_check(const comparison *w, double bound);

#endif
