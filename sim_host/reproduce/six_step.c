/* The drive of the 2016 paper's Section 5 (six_step.h). */
#include "six_step.h"

#include "../model/papers.h"

#include <math.h>
#include <stdlib.h>

static double complex final_current(const six_step_run *run, int vector)
{
    return run->u_over_R * vec_turn(vector * VEC_PI / 3.0);
}

double complex six_step_current(const six_step_run *run, const six_step_interval *at, double t_s)
{
    const double tau_s = run->scenario.L_H / run->scenario.R_ohm;
    const double complex target = final_current(run, at->vector);
    return target + (at->i_start - target) * exp(-t_s / tau_s);
}

/* Mean of e^{-a t} over 0 ... 1; |a| is never small here. */
static double complex mean_of_decay(double complex a)
{
    return (1.0 - cexp(-a)) / a;
}

static void solve_interval(const six_step_run *run, six_step_interval *at)
{
    const double decay = at->duration_s * run->scenario.R_ohm / run->scenario.L_H;
    const double complex target = final_current(run, at->vector);
    const double complex rest = at->i_start - target;
    const double complex turning = I * at->Theta_rad;
    at->i_end = target + rest * exp(-decay);
    at->i_mean = target + rest * mean_of_decay(decay);
    at->i_mean_dq =
        vec_turn(-at->theta_rad) * (target * mean_of_decay(turning) + rest * mean_of_decay(turning + decay));
}

/*
 * Angles of the sectors: active vector n is the nearest while the reference is within pi/6 of it. With
 * the reference at angle r in the rotor frame that is theta in n pi/3 - pi/6 - r ... n pi/3 + pi/6 - r.
 */
static double sector_end_rad(int vector, double reference_rad)
{
    return vector * VEC_PI / 3.0 + VEC_PI / 6.0 - reference_rad;
}

static int nearest_vector(double theta_rad, double reference_rad)
{
    return (int)floor((theta_rad + reference_rad) / (VEC_PI / 3.0) + 0.5);
}

/* Lays out the intervals in time; currents come after. Returns where the step falls, as a rotor angle. */
static double lay_out(const six_step_scenario *s, six_step_run *run)
{
    const double omega = VEC_TWO_PI * s->f_Hz;
    const int steady = s->intervals_before;
    const double theta_step = sector_end_rad(steady - 1, 0.0) + s->step_at * VEC_PI / 3.0;
    double theta = sector_end_rad(-1, 0.0);
    for (size_t n = 0; n < run->count; n++) {
        six_step_interval *at = &run->interval[n];
        const bool before = n <= run->step_index;
        /* A reference that jumps past a sector's end takes the next vector at once. */
        at->vector = before ? (int)n : nearest_vector(theta + 1e-9, s->reference_step_rad);
        double end = sector_end_rad(at->vector, before ? 0.0 : s->reference_step_rad);
        if (n == run->step_index) {
            end = theta_step;
        }
        at->theta_rad = theta;
        at->Theta_rad = end - theta;
        at->duration_s = at->Theta_rad / omega;
        at->t_s = (theta - run->interval[0].theta_rad) / omega;
        theta = end;
    }
    return theta_step;
}

bool six_step_solve(const six_step_scenario *scenario, six_step_run *run, error *e)
{
    *run = (six_step_run){.scenario = *scenario, .u_over_R = 1.0};
    run->step_index = (size_t)scenario->intervals_before;
    run->count = run->step_index + 1 + (size_t)scenario->intervals_after;
    run->interval = calloc(run->count, sizeof *run->interval);
    if (run->interval == NULL) {
        return error_failure(e, 0, "six-step run: out of memory");
    }
    const double theta_step = lay_out(scenario, run);
    run->t_step_s = (theta_step - run->interval[0].theta_rad) / (VEC_TWO_PI * scenario->f_Hz);

    /* Steady state: after one interval the current has turned by pi/3 with the voltage. */
    six_step_interval *first = &run->interval[0];
    const double decay = exp(-first->duration_s * scenario->R_ohm / scenario->L_H);
    first->i_start = final_current(run, 0) * (1.0 - decay) / (vec_turn(VEC_PI / 3.0) - decay);
    solve_interval(run, first);

    const double unit = cabs(first->i_mean);
    run->u_over_R /= unit;
    first->i_start /= unit;
    for (size_t n = 0; n < run->count; n++) {
        if (n > 0) {
            run->interval[n].i_start = run->interval[n - 1].i_end;
        }
        solve_interval(run, &run->interval[n]);
    }
    return true;
}

void six_step_free(six_step_run *run)
{
    free(run->interval);
    run->interval = NULL;
    run->count = 0;
}
