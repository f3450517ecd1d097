/* A flux map beyond its terms, by trial (map_choice.h). */
#include "map_choice.h"

#include "diagnose/identify/fit.h"
#include "search.h"

#include <math.h>

/* By what the fall must reduce -2 log likelihood: more than its own and the odd terms' parameters cost. */
static const double WORTH_IT = 60.0;

/* Where the trial begins, in (rated peak / I_sat)^2: iron at work falls by about a third at the rated current. */
static const double FALL_START = 0.5;

/* Share of the flux that is lost at a recorded current, from which on parts are tried. */
static const double MUCH = 0.15;

/* Where a part begins, in z: the first alike in both axes, a second one small and off the centre. */
static const double FIRST_START = 0.3;
static const double SECOND_START = 0.1;
static const double SECOND_CENTRE = 0.3;

/* Shapes lean on one another: their fit takes more steps than others. */
enum { STEPS = 80 };

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

/* A map of terms becomes the whole one if that is worth its parameters. False: out of memory. */
static bool try_whole(fit_data *d, fit_state *s, hypothesis_set allowed, int refine_steps)
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

/* One part with some of the state's members. */
static fit_state first_part(const fit_state *s, hypothesis_set kept)
{
    fit_state one = *s;
    hypotheses_leave(s->set & ~kept, one.z);
    one.set = kept | HYPOTHESIS_BIT(H_IRON_1);
    one.z[P_IRON_1] = FIRST_START;
    one.z[P_IRON_1_D] = one.z[P_IRON_1_Q] = one.z[P_IRON_1_C] = 0.0;
    return one;
}

/* A second part in addition to the first. */
static fit_state second_part(const fit_state *one)
{
    fit_state two = *one;
    two.set = (one->set & ~HYPOTHESIS_BIT(H_IRON_1)) | HYPOTHESIS_BIT(H_IRON_2);
    two.z[P_IRON_2] = SECOND_START;
    two.z[P_IRON_2_D] = two.z[P_IRON_2_Q] = 0.0;
    two.z[P_IRON_2_C] = SECOND_CENTRE;
    return two;
}

/* Two parts that have the state's flux, and some of its members. */
static fit_state close_parts(const fit_data *d, const fit_state *s, hypothesis_set kept)
{
    fit_state two = *s;
    hypotheses_leave(s->set & ~kept, two.z);
    two.set = kept | HYPOTHESIS_BIT(H_IRON_2);
    coordinates_take_parts(d->frame, s->z, two.z);
    return two;
}

/* The first of two parts alone, from where both ended. */
static fit_state without_second(const fit_state *two)
{
    fit_state one = *two;
    one.set = (two->set & ~HYPOTHESIS_BIT(H_IRON_2)) | HYPOTHESIS_BIT(H_IRON_1);
    one.z[P_IRON_2] = one.z[P_IRON_2_D] = one.z[P_IRON_2_Q] = one.z[P_IRON_2_C] = 0.0;
    return one;
}

/* Fits a trial, which takes the state's place if its score is better. *its: the trial's score. False: out of memory. */
static bool try_parts(fit_data *d, fit_state *s, fit_state *trial, double *score, double *its)
{
    const fit_aim ranked = fit_ranked(INFINITY);
    double alone;
    *its = INFINITY;
    coordinates_bound(d->frame, trial->z);
    if (!fit_refine_within(d, trial, STEPS, &ranked, &alone)) {
        return false;
    }
    if (!isfinite(trial->objective) || !hypotheses_physical(trial->set, trial->z)) {
        return true;
    }
    if (!search_score(d, trial, its)) {
        return false;
    }
    if (*its < *score) {
        *score = *its;
        *s = *trial;
    }
    return true;
}

/* Members that are no shape of the flux. */
static hypothesis_set others_of(hypothesis_set set)
{
    hypothesis_set others = set;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        others &=
            (hypothesis_table[h].holds & HOLDS_INDUCTANCE) != 0 ? ~HYPOTHESIS_BIT(h) : ~(hypothesis_set)0;
    }
    return others;
}

/*
 * One part in place of what bends, in *one. The other members may have been misled by that, or explain what no part does: it is fitted
 * without them and with them, and the better one is taken. False: out of memory.
 */
static bool find_first(fit_data *d, fit_state *s, fit_state *one, double *score)
{
    const hypothesis_set others = others_of(s->set);
    fit_state with = first_part(s, others);
    double alone = INFINITY;
    double together = INFINITY;
    *one = first_part(s, 0);
    if (!try_parts(d, s, one, score, &alone) || (others != 0 && !try_parts(d, s, &with, score, &together))) {
        return false;
    }
    *one = together < alone ? with : *one;
    return true;
}

/* Whether a saturation or a map of the state takes so much flux that a few terms do not follow it further. */
static bool bends_much(const fit_data *d, const fit_state *s)
{
    return (hypotheses_hold(s->set, CAUSE_SATURATION) || hypotheses_hold(s->set, CAUSE_SATURATION_DQ)) &&
           coordinates_flux_lost(d->frame, s->z) > MUCH;
}

/* One part, and then a second one in addition to it. False: out of memory. */
static bool find_parts(fit_data *d, fit_state *s, double *score)
{
    fit_state one = *s;
    double its;
    if (!hypothesis_in(s->set, H_IRON_1) && !find_first(d, s, &one, score)) {
        return false;
    }
    fit_state two = second_part(&one);
    return try_parts(d, s, &two, score, &its);
}

/*
 * Parts in place of what bends much in a state: one after the other, each small at first, and two that begin at the state's flux. These
 * two, which need one fit, are tried even if much has been. False: out of memory.
 */
static bool choose_parts(fit_data *d, fit_state *s, hypothesis_set allowed)
{
    const fit_state before = *s;
    double score = INFINITY;
    double its;
    if (!hypothesis_in(allowed, H_MAP_TERMS) || hypothesis_in(s->set, H_IRON_2) || !bends_much(d, s)) {
        return true;
    }
    if (!search_score(d, s, &score) || (!fit_has_spent(d) && !find_parts(d, s, &score))) {
        return false;
    }
    fit_state close = close_parts(d, &before, others_of(s->set));
    if (!hypothesis_in(before.set, H_IRON_1) && !try_parts(d, s, &close, &score, &its)) {
        return false;
    }
    /* A second part may only have led the first one on. */
    fit_state again = without_second(s);
    return !hypothesis_in(s->set, H_IRON_2) || try_parts(d, s, &again, &score, &its);
}

bool map_choose(fit_data *d, fit_state *s, hypothesis_set allowed, int refine_steps)
{
    return try_whole(d, s, allowed, refine_steps) && choose_parts(d, s, allowed);
}
