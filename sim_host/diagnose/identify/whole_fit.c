/* Gauss-Newton steps under heavy-tailed priors (whole_fit.h). */
#include "whole_fit.h"

#include "base/solve.h"
#include "base/sort.h"
#include "fit.h"
#include "fit_step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 20, REWEIGHTED = 12, LINKS = 3, LINK_OF_RESISTANCE = 1 };

static const double DEGREES = 2.0; /* of Student's t */
/* Its 95 % interval is so much wider than that of a normal distribution of its scale. */
static const double WIDER = 4.303 / 1.960;
/* Tolerance of a parameter for which the catalogue has none, as a share of its reporting threshold. */
static const double SHARE_OF_LEAST = 0.3;
static const double roughness_tried[] = {1.0, 2.0, 4.0, 8.0};
/* Prior of a shape parameter such as a knee current: its standard deviation is a factor e. And the largest change in a step. */
static const double SHAPE_WIDTH = 1.0;
static const double SHAPE_STEP = 0.7;
/* Of the common factor's logarithm, between two values at which its prior is weighed: a quarter of the narrowest prior's width. */
static const double SCALE_STEP = 2.5e-4;
/* A step that reduces -2 log posterior by less than this is the last one. */
static const double LITTLE = 0.5;
/* Added to the diagonal, as a share of it, so that a step can be solved if only a prior determines a direction. */
static const double DAMPING = 5e-6;

/*
 * Parameters of three phases whose mean is equivalent to other parameters of the drive: the scale of resistance and inductance, a
 * resistance, an inductance. The mean has a prior of this width.
 */
static const struct {
    coordinate_id of[3];
    double width;
} links[LINKS] = {{{P_GAIN_A, P_GAIN_B, P_GAIN_C}, 0.002},
                  {{P_DR_A, P_DR_B, P_DR_C}, 1e-3},
                  {{P_DL_A, P_DL_B, P_DL_C}, 2e-4}};

/* The places of those of a link that are fitted, in `column`. */
typedef struct link_places {
    size_t n, at[3];
} link_places;

typedef struct whole {
    size_t n;
    int column[COLUMN_COUNT];
    double width[COLUMN_COUNT]; /* of the prior at roughness 1 */
    double about[COLUMN_COUNT];
    bool shape[COLUMN_COUNT];
    bool positive[COLUMN_COUNT];
    link_places link[LINKS];
    double inflation;
    gram sum;
    double prior[COLUMN_COUNT][COLUMN_COUNT];
    double a[COLUMN_COUNT][COLUMN_COUNT]; /* the sums and the prior */
    double low[COLUMN_COUNT], high[COLUMN_COUNT];
    double block[COLUMN_COUNT]; /* scatter of the blocks' scores */
    gain_line line[ROWS_MAX_GROUPS];
    fit_state ended; /* at the end of the last step; before the first its objective is infinite */
} whole;

static bool is_fitted(const whole *w, int column)
{
    bool found = false;
    for (size_t k = 0; k < w->n; k++) {
        found = found || w->column[k] == column;
    }
    return found;
}

static void add_column(whole *w, int column, double width, double about, bool shape)
{
    for (size_t k = 0; k < w->n; k++) {
        if (w->column[k] == column) {
            w->width[k] = fmin(w->width[k], width);
            return;
        }
    }
    if (w->n < SOLVE_ORDER_MOST) {
        w->column[w->n] = column;
        w->width[w->n] = width;
        w->about[w->n] = about;
        w->shape[w->n] = shape;
        w->positive[w->n++] = column == P_FE || column == P_COMPENSATION;
    }
}

static void choose_columns(whole *w, const fit_data *d, const fit_state *s, hypothesis_set parts)
{
    w->n = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *hypo = &hypothesis_table[h];
        bool moved[P_COUNT] = {false};
        bool acts = false;
        if (!hypothesis_in(parts, h)) {
            continue;
        }
        hypothesis_mark(h, moved);
        for (size_t k = 0; k < hypo->fixed; k++) {
            moved[hypo->column[k]] = false;
        }
        for (int k = 0; k < P_COUNT; k++) {
            if (moved[k] && column_shows(k, d->rows)) {
                const double digits = coordinate_table[k].digits;
                add_column(w, k, digits > 0.0 ? digits : SHARE_OF_LEAST * hypo->least, 0.0, false);
            }
            acts = acts || (moved[k] && s->z[k] != 0.0);
        }
        for (size_t k = 0; acts && k < hypo->shapes; k++) {
            add_column(w, (int)hypo->shape[k], SHAPE_WIDTH, s->z[hypo->shape[k]], true);
        }
    }
    if (rows_show_three(d->rows)) {
        add_column(w, P_OFFSET_ZERO, 1.0, 0.0, true);
    }
    if (column_shows(P_U_NOISE, d->rows)) {
        add_column(w, P_U_NOISE, 1.0, 0.0, true);
    }
    for (size_t l = 0; l < LINKS; l++) {
        link_places *p = &w->link[l];
        p->n = 0;
        for (size_t k = 0; k < 3; k++) {
            for (size_t at = 0; at < w->n; at++) {
                if (w->column[at] == (int)links[l].of[k]) {
                    p->at[p->n++] = at;
                }
            }
        }
    }
}

/* Two sensors' gains have no mean that is known: the third one may be the one that makes up for them. */
static bool link_holds(const whole *w, size_t l)
{
    return w->link[l].n == 3;
}

/* Distance of a parameter from the middle of its prior, after a step. */
static double off(const whole *w, const fit_state *s, const double *step, size_t k)
{
    return s->z[w->column[k]] + (step ? step[k] : 0.0) - w->about[k];
}

static double link_off(const whole *w, const fit_state *s, const double *step, size_t l)
{
    const link_places *p = &w->link[l];
    double sum = 0.0;
    for (size_t k = 0; k < p->n; k++) {
        sum += off(w, s, step, p->at[k]);
    }
    return sum / (double)p->n;
}

/* 1 over the square of what drives usually differ by; 0: not known. */
static double rare(const whole *w, size_t k)
{
    const double usual = w->shape[k] ? 0.0 : coordinate_table[w->column[k]].usual;
    return usual > 0.0 ? 1.0 / (usual * usual) : 0.0;
}

/* The part of one parameter in -2 log prior, at a distance from its middle. */
static double prior_part(const whole *w, size_t k, double is, double roughness)
{
    const double x = is / w->width[k];
    return rare(w, k) * is * is +
           (w->shape[k]
                ? x * x
                : (DEGREES + 1.0) * log1p(x * x / (DEGREES * roughness * roughness)) + 2.0 * log(roughness));
}

/* The part of what the links hold in -2 log prior, after a step. */
static double links_part(const whole *w, const fit_state *s, const double *step)
{
    double sum = 0.0;
    for (size_t l = 0; l < LINKS; l++) {
        const double x = link_holds(w, l) ? link_off(w, s, step, l) / links[l].width : 0.0;
        sum += x * x;
    }
    return sum;
}

/* -2 log prior after a step, with the terms that depend on the roughness. */
static double prior_of(const whole *w, const fit_state *s, const double *step, double roughness)
{
    double sum = links_part(w, s, step);
    for (size_t k = 0; k < w->n; k++) {
        sum += prior_part(w, k, off(w, s, step, k), roughness);
    }
    return sum;
}

/* The precision of a parameter's prior in the reweighted least squares, after a step. */
static double pull(const whole *w, const fit_state *s, const double *step, size_t k, double roughness)
{
    const double x = off(w, s, step, k);
    const double width = roughness * w->width[k];
    return rare(w, k) + (w->shape[k] ? 1.0 / (w->width[k] * w->width[k])
                                     : (DEGREES + 1.0) / (DEGREES * width * width + x * x));
}

/* The precision of the prior, in the scale of the data, weighted at the step given. */
static void find_prior(whole *w, const fit_state *s, const double *step, double roughness)
{
    for (size_t i = 0; i < w->n; i++) {
        memset(w->prior[i], 0, w->n * sizeof *w->prior[i]);
        w->prior[i][i] = w->inflation * pull(w, s, step, i, roughness);
    }
    for (size_t l = 0; l < LINKS; l++) {
        const link_places *p = &w->link[l];
        const double by = w->inflation / (links[l].width * links[l].width * (double)(p->n * p->n));
        for (size_t i = 0; link_holds(w, l) && i < p->n; i++) {
            for (size_t j = 0; j < p->n; j++) {
                w->prior[p->at[i]][p->at[j]] += by;
            }
        }
    }
}

/* Adds the prior to the sums: to w->a, and to the right-hand side for the way from s. Weighted at the step given. */
static void with_prior(whole *w, const fit_state *s, const double *step, double roughness, double *right)
{
    find_prior(w, s, step, roughness);
    for (size_t i = 0; i < w->n; i++) {
        right[i] = -w->sum.g[i];
        for (size_t j = 0; j < w->n; j++) {
            w->a[i][j] = w->sum.h[i][j] + w->prior[i][j];
            right[i] -= w->prior[i][j] * off(w, s, NULL, j);
        }
    }
}

/* The log of the determinant of w->a over the inflation. */
static double log_determinant(const whole *w)
{
    double l[SOLVE_ORDER_MOST][SOLVE_ORDER_MOST];
    double sum = 0.0;
    for (size_t i = 0; i < w->n; i++) {
        for (size_t j = 0; j <= i; j++) {
            double x = w->a[i][j] / w->inflation;
            for (size_t k = 0; k < j; k++) {
                x -= l[i][k] * l[j][k];
            }
            l[i][j] = i == j ? sqrt(fmax(x, 1e-12 * w->a[i][i] / w->inflation)) : x / l[j][j];
        }
        sum += 2.0 * log(l[i][i]);
    }
    return sum;
}

/* -2 log posterior after a step, as the sums predict it, up to a constant. */
static double promised(const whole *w, const fit_state *s, const double *step, double roughness)
{
    double sum = 0.0;
    for (size_t i = 0; i < w->n; i++) {
        double row = 2.0 * w->sum.g[i];
        for (size_t j = 0; j < w->n; j++) {
            row += w->sum.h[i][j] * step[j];
        }
        sum += step[i] * row;
    }
    return sum / w->inflation + prior_of(w, s, step, roughness);
}

/* The step to the maximum of the posterior on the sums, improved from the step given. False: it cannot be solved. */
static bool find_step(whole *w, const fit_state *s, double roughness, double *step)
{
    double right[COLUMN_COUNT];
    for (int round = 0; round < REWEIGHTED; round++) {
        double before[COLUMN_COUNT];
        memcpy(before, step, sizeof before);
        with_prior(w, s, step, roughness, right);
        for (size_t i = 0; i < w->n; i++) {
            w->a[i][i] *= 1.0 + DAMPING;
        }
        if (!solve_within(w->n, COLUMN_COUNT, &w->a[0][0], right, w->low, w->high, step)) {
            return false;
        }
        double moved = 0.0;
        for (size_t i = 0; i < w->n; i++) {
            moved = fmax(moved, fabs(step[i] - before[i]) / w->width[i]);
        }
        if (moved < 0.02) {
            break;
        }
    }
    return true;
}

/* The roughness with the most evidence, and its step. False: no step can be solved. */
static bool choose_step(whole *w, const fit_state *s, double *roughness, double *step)
{
    double best = INFINITY;
    double trial[COLUMN_COUNT] = {0.0};
    for (size_t r = 0; r < sizeof roughness_tried / sizeof *roughness_tried; r++) {
        double right[COLUMN_COUNT];
        if (!find_step(w, s, roughness_tried[r], trial)) {
            continue;
        }
        with_prior(w, s, trial, roughness_tried[r], right);
        const double evidence = promised(w, s, trial, roughness_tried[r]) + log_determinant(w);
        if (evidence < best) {
            best = evidence;
            *roughness = roughness_tried[r];
            memcpy(step, trial, sizeof trial);
        }
    }
    return isfinite(best);
}

/* Variance of the blocks' scores at the end of the step over that of white noise: the median over the parameters, at least 1. */
static double scatter_of(const whole *w, const fit_data *d, const gram *grams, const double *step)
{
    double ratio[COLUMN_COUNT] = {0.0};
    for (size_t b = 0; b < d->blocks; b++) {
        for (size_t i = 0; i < w->n; i++) {
            double score = grams[b].g[i];
            for (size_t j = 0; j < w->n; j++) {
                score += grams[b].h[i][j] * step[j];
            }
            ratio[i] += w->sum.h[i][i] > 0.0 ? score * score / w->sum.h[i][i] : 0.0;
        }
    }
    sort_ascending(ratio, w->n);
    return fmax(1.0, ratio[w->n / 2]);
}

static void bound_step(whole *w, const fit_data *d, const fit_state *s)
{
    fit_step_room(d, s, w->column, w->n, w->low, w->high);
    for (size_t k = 0; k < w->n; k++) {
        if (w->positive[k]) {
            w->low[k] = fmax(w->low[k], -s->z[w->column[k]]);
        }
        if (w->shape[k] && w->column[k] != P_OFFSET_ZERO) {
            w->low[k] = fmax(w->low[k], -SHAPE_STEP);
            w->high[k] = fmin(w->high[k], SHAPE_STEP);
        }
    }
}

static double goal_of(const whole *w, const fit_state *s, double roughness)
{
    return s->objective / w->inflation + prior_of(w, s, NULL, roughness);
}

static bool is_within(const coordinate_frame *f, const double z[P_COUNT])
{
    double bounded[P_COUNT];
    bool within = true;
    memcpy(bounded, z, sizeof bounded);
    coordinates_bound(f, bounded);
    for (int k = 0; k < P_COUNT; k++) {
        within = within && bounded[k] >= z[k] && bounded[k] <= z[k];
    }
    return within;
}

/*
 * The same where drives that one factor makes of another compare: there the likelihood says nothing, so the prior must be right about
 * large deviations too. A parameter is as in the file, or off by what drives usually differ by: Student's t falls too fast for the latter.
 * No winding has the data sheet's temperature, so R is always off.
 */
static double scale_part(const whole *w, size_t k, double is, double roughness)
{
    const double usual = w->shape[k] ? 0.0 : coordinate_table[w->column[k]].usual;
    const double width = roughness * w->width[k];
    if (!(usual > 0.0)) {
        return prior_part(w, k, is, roughness);
    }
    const double far = exp(-0.5 * is * is / (usual * usual)) / (2.50662827463 * usual);
    const double near = w->column[k] == P_R
                            ? far
                            : pow(1.0 + is * is / (DEGREES * width * width), -1.5) / (sqrt(8.0) * width);
    return -2.0 * log(0.5 * near + 0.5 * far);
}

/*
 * The prior by which drives that one factor makes of another compare. The factor moves both axes' inductances alike: that is one
 * deviation, not two.
 */
static double scale_prior(const whole *w, const fit_state *s, double roughness)
{
    double sum = links_part(w, s, NULL);
    double both = 0.0;
    size_t axes = 0;
    size_t axis = 0;
    for (size_t k = 0; k < w->n; k++) {
        const double is = off(w, s, NULL, k);
        if (w->column[k] == P_L_D || w->column[k] == P_L_Q) {
            both += is;
            axes++;
            axis = k;
        } else {
            sum += scale_part(w, k, is, roughness);
        }
    }
    return axes > 0 ? sum + scale_part(w, axis, both / (double)axes, roughness) : sum;
}

/* Of states that no recording distinguishes the one with the likelier prior; *least: of the best one. */
static void keep_likelier(const fit_data *d, const fit_state *trial, double prior, fit_state *best,
                          double *least)
{
    if (prior < *least && is_within(d->frame, trial->z)) {
        *least = prior;
        *best = *trial;
    }
}

/* A drive that one factor on all voltages, and one on all currents, makes of another. */
typedef struct scaled {
    double voltages, currents;
} scaled;

static const coordinate_id gain_of_sensor[] = {P_GAIN_A, P_GAIN_B, P_GAIN_C};

/* Those in which a parameter has the motor file's value, or a current sensor's gain; returns how many. */
static size_t scales_to_file(const whole *w, const averaged_drive *file, const averaged_drive *is, scaled *to)
{
    const double R = file->R_ohm / is->R_ohm;
    const double L = (file->L_d_H + file->L_q_H) / (is->L_d_H + is->L_q_H);
    size_t n = 0;
    if (is_fitted(w, P_K_U)) {
        const double factor[] = {file->k_u / is->k_u, R, L, file->psi_f_Wb / is->psi_f_Wb};
        for (size_t k = 0; k < sizeof factor / sizeof *factor; k++) {
            to[n++] = (scaled){factor[k], 1.0};
        }
    }
    if (is_fitted(w, P_GAIN_A)) {
        to[n++] = (scaled){1.0, 1.0 / R};
        to[n++] = (scaled){1.0, 1.0 / L};
    }
    for (size_t x = 0; x < 3; x++) {
        if (is_fitted(w, (int)gain_of_sensor[x])) {
            to[n++] = (scaled){1.0, is->g[x] / file->g[x]};
        }
    }
    return n;
}

static bool is_a_change(double factor)
{
    return factor > 0.3 && factor < 3.0 && fabs(factor - 1.0) > 1e-4;
}

/*
 * Only the prior determines the common scale of R, L and the gains of the current sensors, and, if the voltages' gain is fitted, that of
 * R, L, psi_f and all voltages. Tries the scales at which one of them has the motor file's value, and takes the most likely one. Steps
 * would be slow here, as heavy tails have many maxima.
 */
static void choose_scale(const whole *w, fit_data *d, whole_fit *out)
{
    const averaged_drive is = fit_drive(d, &out->state);
    scaled to[9];
    const size_t n = scales_to_file(w, &d->frame->nominal, &is, to);
    fit_state best = out->state;
    double least = scale_prior(w, &out->state, out->roughness);
    for (size_t k = 0; k < n; k++) {
        fit_state trial = out->state;
        if (is_a_change(to[k].voltages * to[k].currents)) {
            coordinates_scale(d->frame, to[k].voltages, to[k].currents, trial.z);
            trial.z[P_GAIN_C] = is_fitted(w, P_GAIN_C) ? trial.z[P_GAIN_C] : out->state.z[P_GAIN_C];
            keep_likelier(d, &trial, scale_prior(w, &trial, out->roughness), &best, &least);
        }
    }
    if (n > 0) {
        fit_noise(d, &best);
        out->state = best;
    }
}

static const coordinate_id phase_resistances[] = {P_DR_A, P_DR_B, P_DR_C};

/* The same drive with a part of each phase's resistance counted as the machine's. */
static void divide_resistance(double z[P_COUNT], double common)
{
    z[P_R] += common;
    for (size_t x = 0; x < 3; x++) {
        z[phase_resistances[x]] -= common;
    }
}

/* The part of -2 log prior in which the divisions differ. */
static double division_prior(const whole *w, const fit_state *s, double roughness)
{
    double sum = 0.0;
    for (size_t k = 0; k < w->n; k++) {
        const int column = w->column[k];
        const bool divided = column == P_R || column == P_DR_A || column == P_DR_B || column == P_DR_C;
        sum += divided ? scale_part(w, k, off(w, s, NULL, k), roughness) : 0.0;
    }
    return sum;
}

/*
 * What three resistances have in common is one of the machine, to any share. Tries the divisions in which one phase has the machine's
 * alone, as a single bad joint leaves two of them, and takes the most likely one. By the prior alone: the model's step is a little less
 * exact for a phase's own part, which is no evidence.
 */
static void choose_division(const whole *w, fit_data *d, whole_fit *out)
{
    if (!link_holds(w, LINK_OF_RESISTANCE) || !is_fitted(w, P_R)) {
        return;
    }
    fit_state best = out->state;
    double least = division_prior(w, &best, out->roughness);
    for (size_t own = 0; own < 3; own++) {
        fit_state trial = out->state;
        divide_resistance(trial.z, trial.z[phase_resistances[own]]);
        keep_likelier(d, &trial, division_prior(w, &trial, out->roughness), &best, &least);
    }
    fit_noise(d, &best);
    out->state = best;
}

/* Sums the prior over the factor that only the prior determines, from -26 to +35 %. */
static void weigh_scales(const whole *w, const fit_data *d, whole_fit *out)
{
    enum { NODES = 1200 }; /* to either side */
    const double own = scale_prior(w, &out->state, out->roughness);
    double least[DRIVE_SCALES];
    double sum = 0.0;
    if (!is_fitted(w, P_K_U)) {
        return;
    }
    for (int k = -NODES; k <= NODES; k++) {
        const double factor = exp(k * SCALE_STEP);
        fit_state at = out->state;
        coordinates_scale(d->frame, factor, 1.0, at.z);
        if (!is_within(d->frame, at.z)) {
            continue;
        }
        const double prior = scale_prior(w, &at, out->roughness);
        size_t which = 0;
        for (size_t n = 0; n < HYPOTHESES_SCALED; n++) {
            const hypothesis_id h = hypotheses_scaled[n];
            which |= hypothesis_size(h, at.z) > d->frame->of_least * hypothesis_table[h].least ? 1U << n : 0U;
        }
        drive_scale *scale = &out->scale[which];
        if (scale->share == 0.0 || prior < least[which]) {
            least[which] = prior;
            scale->factor = factor;
        }
        const double weight = exp(0.5 * (own - prior));
        scale->share += weight;
        sum += weight;
    }
    for (size_t k = 0; k < DRIVE_SCALES && sum > 0.0; k++) {
        out->scale[k].share /= sum;
    }
}

/* By how much a prior is more curved in the middle than its 95 % interval says. */
static double too_sure(const whole *w, const fit_state *s, size_t k, double roughness)
{
    const double width = WIDER * roughness * w->width[k];
    return w->shape[k] ? 0.0
                       : fmax(0.0, pull(w, s, NULL, k, roughness) - (rare(w, k) + 1.0 / (width * width)));
}

/* Writes the posterior about the fit, from the sums of the last step. */
static void tell_covariance(whole *w, whole_fit *out)
{
    for (size_t i = 0; i < w->n; i++) {
        for (size_t j = 0; j < w->n; j++) {
            w->a[i][j] /= w->inflation;
        }
        out->column[i] = w->column[i];
        memcpy(out->prior[i], w->prior[i], sizeof w->prior[i]);
        out->prior[i][i] -= w->inflation * too_sure(w, &out->state, i, out->roughness);
        memcpy(out->precision[i], w->a[i], sizeof w->a[i]);
    }
    out->columns = solve_covariance(w->n, COLUMN_COUNT, &w->a[0][0], &out->covariance[0][0]) ? w->n : 0;
}

/*
 * One step; *fell: the reduction of the goal, from before it or from the end of the last step. A choice of the scale lies between these:
 * each may move the drive back along the factor that only their priors determine, and these differ. False: out of memory.
 */
static bool improve(whole *w, fit_data *d, hypothesis_set parts, whole_fit *out, double *fell)
{
    fit_state *s = &out->state;
    double step[COLUMN_COUNT] = {0.0};
    *fell = 0.0;
    choose_columns(w, d, s, parts);
    w->column[w->n] = COLUMN_GAIN;
    gram *grams = gram_blocks(d, s, w->column, w->n + 1);
    if (!grams) {
        return false;
    }
    gram_free_scale(d, s, w->column, w->n + 1, grams);
    memset(&w->sum, 0, sizeof w->sum);
    memset(w->line, 0, sizeof w->line);
    fit_step_sums(d, s, grams, w->n, w->line, &w->sum);
    bound_step(w, d, s);
    if (choose_step(w, s, &out->roughness, step)) {
        w->inflation = scatter_of(w, d, grams, step);
        const double before = goal_of(w, s, out->roughness);
        for (double share = 1.0; share > 0.02; share *= 0.4) {
            const fit_state trial = fit_step_taken(d, s, w->column, step, w->n, w->line, share);
            const double after = goal_of(w, &trial, out->roughness);
            if (after < before) {
                *fell = fmin(before, goal_of(w, &w->ended, out->roughness)) - after;
                *s = trial;
                break;
            }
        }
    }
    w->ended = *s;
    choose_scale(w, d, out);
    out->inflation = w->inflation;
    out->goal = goal_of(w, s, out->roughness);
    double right[COLUMN_COUNT];
    with_prior(w, s, NULL, out->roughness, right);
    tell_covariance(w, out);
    free(grams);
    return true;
}

/* What no part moves has the motor file's value, where a search may have strained its tolerance. */
static void leave_tolerances(hypothesis_set parts, double z[P_COUNT])
{
    bool moved[P_COUNT] = {false};
    hypotheses_mark(parts, moved);
    for (size_t k = 0; k < P_COUNT; k++) {
        z[k] = coordinate_table[k].digits > 0.0 && !moved[k] ? 0.0 : z[k];
    }
}

bool whole_fit_find(fit_data *d, const fit_state *start, hypothesis_set parts, double inflation,
                    whole_fit *out, FILE *trace)
{
    whole *w = calloc(1, sizeof *w);
    bool ok = w != NULL;
    *out = (whole_fit){.state = *start, .roughness = 1.0};
    leave_tolerances(parts, out->state.z);
    if (hypothesis_in(parts, H_RESISTANCE) && hypothesis_in(parts, H_ASYMMETRY)) {
        double *z = out->state.z;
        divide_resistance(z, (z[P_DR_A] + z[P_DR_B] + z[P_DR_C]) / 3.0);
    }
    fit_noise(d, &out->state);
    if (ok) {
        w->inflation = inflation;
        w->ended.objective = INFINITY;
    }
    for (int k = 0; ok && k < STEPS; k++) {
        double fell;
        ok = improve(w, d, parts, out, &fell);
        if (trace && ok) {
            fprintf(trace,
                    "  whole drive, step %d: roughness %g, scatter %.2g, objective %.1f, posterior %.1f "
                    "(%.1f)\n",
                    k, out->roughness, out->inflation, out->state.objective, out->goal, -fell);
        }
        /* The first step's scatter is that about the start, which may be bad: it must not end the fit. */
        if (k > 0 && fell < LITTLE) {
            break;
        }
    }
    if (ok) {
        weigh_scales(w, d, out);
        choose_division(w, d, out);
    }
    free(w);
    return ok;
}

/* The places of a hypothesis' parameters in the fit; returns how many. */
static size_t places_of(const whole_fit *f, hypothesis_id h, size_t at[HYPOTHESIS_COLUMNS])
{
    bool moved[P_COUNT] = {false};
    size_t n = 0;
    hypothesis_mark(h, moved);
    for (size_t k = 0; k < f->columns; k++) {
        if (f->column[k] < P_COUNT && moved[f->column[k]] && n < HYPOTHESIS_COLUMNS) {
            at[n++] = k;
        }
    }
    return n;
}

double whole_fit_certain(const whole_fit *f, hypothesis_id h)
{
    size_t at[HYPOTHESIS_COLUMNS];
    double part[HYPOTHESIS_COLUMNS][HYPOTHESIS_COLUMNS];
    double z[HYPOTHESIS_COLUMNS];
    double x[HYPOTHESIS_COLUMNS];
    double sum = 0.0;
    const size_t n = places_of(f, h, at);
    for (size_t i = 0; i < n; i++) {
        z[i] = f->state.z[f->column[at[i]]];
        for (size_t j = 0; j < n; j++) {
            part[i][j] = f->covariance[at[i]][at[j]];
        }
        part[i][i] *= 1.0 + 1e-5;
    }
    if (n == 0 || !solve_positive(n, HYPOTHESIS_COLUMNS, &part[0][0], z, x)) {
        return 0.0;
    }
    for (size_t i = 0; i < n; i++) {
        sum += z[i] * x[i];
    }
    return sum;
}

double whole_fit_needed(const whole_fit *f, hypothesis_id h)
{
    size_t at[HYPOTHESIS_COLUMNS];
    double sum = 0.0;
    const size_t n = places_of(f, h, at);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            sum += f->state.z[f->column[at[i]]] * f->precision[at[i]][at[j]] * f->state.z[f->column[at[j]]];
        }
    }
    return sum;
}
