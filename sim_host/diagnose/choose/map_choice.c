/* The fall of both axes in addition to the terms of a flux map, by trial (map_choice.h). */
#include "map_choice.h"

#include "diagnose/identify/fit.h"

/* By what the fall must reduce -2 log likelihood: more than its own and the odd terms' parameters cost. */
static const double WORTH_IT = 60.0;

/* Where the trial begins, in (rated peak / I_sat)^2: iron at work falls by about a third at the rated current. */
static const double FALL_START = 0.5;

/*
 * The state with a fall of s more, and the terms of fourth order that take back what it adds of that order:
 * W = ... - s (L_d d^2 + L_q q^2)^2 / (2 (L_d + L_q)) + ...
 */
static void begin_fall(const fit_data *d, fit_state *s)
{
    const averaged_drive drive = fit_drive(d, s);
    const coordinate_frame *f = d->frame;
    const double per_term = FALL_START * f->scale[SCALE_PER_SQUARE] /
                            (2.0 * (drive.L_d_H + drive.L_q_H) * f->scale[SCALE_MAP_FOURTH]);
    s->z[P_SATURATION] += FALL_START;
    s->z[P_W_DDDD] += per_term * drive.L_d_H * drive.L_d_H;
    s->z[P_W_DDQQ] += per_term * 2.0 * drive.L_d_H * drive.L_q_H;
    s->z[P_W_QQQQ] += per_term * drive.L_q_H * drive.L_q_H;
}

bool map_choose(fit_data *d, fit_state *s, hypothesis_set allowed, int refine_steps)
{
    const hypothesis_set terms =
        HYPOTHESIS_BIT(H_MAP_TERMS) | HYPOTHESIS_BIT(H_MAP_EVEN) | HYPOTHESIS_BIT(H_MAP_Q);
    if ((s->set & terms) == 0 || !hypothesis_in(allowed, H_MAP)) {
        return true;
    }
    fit_state trial = *s;
    trial.set = (s->set & ~terms) | HYPOTHESIS_BIT(H_MAP);
    begin_fall(d, &trial);
    coordinates_bound(d->frame, trial.z);
    double alone;
    const fit_aim aim = fit_kept(s->objective);
    if (!fit_refine_within(d, &trial, refine_steps, &aim, &alone)) {
        return false;
    }
    if (alone <= aim.most && trial.objective < s->objective - WORTH_IT &&
        hypotheses_physical(trial.set, trial.z)) {
        *s = trial;
    }
    return true;
}
