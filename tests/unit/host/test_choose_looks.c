/*
 * The decisions of the diagnosis (sim_host/diagnose/choose) on a few short recordings of diagnose_bench.h: as many as
 * tell a wrong decision from a right one within some seconds. test_diagnose*.c go through the causes.
 */
#include "base/solve.h"
#include "diagnose/identify/fit.h"
#include "diagnose/identify/gram.h"
#include "diagnose/identify/last_digits.h"
#include "diagnose/identify/whole_fit.h"
#include "diagnose/session.h"
#include "diagnose_look.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static bench good;

void setUp(void)
{
    good = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20261122};
}

void tearDown(void)
{
}

/* ---- How sure: certainty.h in another order of sums ---- */

enum { MOST = 24 };

typedef struct fitted {
    motor m;
    recording r;
    diagnose_rows rows;
    coordinate_frame frame;
    fit_data data;
    fit_state state;
    certainty sure;
} fitted;

/* The bench fitted with a set, by all its rows that are not held out. */
static void fit_it(fitted *f, hypothesis_set set)
{
    error e = {0};
    f->m = bench_motor();
    f->r = bench_record(&good);
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&f->rows, &f->r, &f->m, &e), e.text);
    f->frame = coordinates_of(&f->m, &f->rows);
    TEST_ASSERT_TRUE_MESSAGE(fit_data_make(&f->data, &f->rows, &f->frame, 100000, &e), e.text);
    TEST_ASSERT_TRUE(fit_of_nominal(&f->data, &f->state));
    f->state.set = set;
    TEST_ASSERT_TRUE(fit_refine(&f->data, &f->state, 12));
    TEST_ASSERT_TRUE(certainty_of(&f->data, &f->state, &f->sure));
}

static void fit_end(fitted *f)
{
    fit_data_free(&f->data);
    rows_free(&f->rows);
    recording_free(&f->r);
}

/* One of the inverse's rows times the sums of a block or of a group: the step that it alone asks for. */
static double asked_by(double inverse[MOST][MOST], size_t row, const double g[COLUMN_COUNT], size_t n)
{
    double step = 0.0;
    for (size_t j = 0; j < n; j++) {
        step += inverse[row][j] * g[j];
    }
    return step;
}

/* Student's t of 97.5 %: of six operating points less one, and by its expansion about the normal quantile. */
#define T_OF_5 2.571

static double student_of_more_than_ten(double degrees)
{
    const double z = 1.959964;
    TEST_ASSERT_TRUE(degrees > 10.0);
    return z + (pow(z, 3.0) + z) / (4.0 * degrees) +
           (5.0 * pow(z, 5.0) + 16.0 * pow(z, 3.0) + 3.0 * z) / (96.0 * degrees * degrees);
}

/* Sums of the whitened squares of each block, with every gain moved by `more`. */
static double squares_with(fitted *f, double more)
{
    fit_state moved = f->state;
    for (size_t g = 0; g < f->rows.groups; g++) {
        moved.noise[g].gain += more;
    }
    gram *grams = gram_blocks(&f->data, &moved, NULL, 0);
    TEST_ASSERT_NOT_NULL(grams);
    double sum = 0.0;
    for (size_t b = 0; b < f->data.blocks; b++) {
        sum += grams[b].c;
    }
    free(grams);
    return sum;
}

static void a_gain_is_a_column_as_any_other(void)
{
    static fitted f;
    good.m.R_ohm = 1.2;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    for (size_t g = 0; g < f.rows.groups; g++) {
        f.state.noise[g].gain = 0.4; /* where there is a slope */
    }
    const int column[] = {P_R, COLUMN_GAIN};
    gram *grams = gram_blocks(&f.data, &f.state, column, 2);
    TEST_ASSERT_NOT_NULL(grams);
    double slope = 0.0;
    double curve = 0.0;
    for (size_t b = 0; b < f.data.blocks; b++) {
        slope += 2.0 * grams[b].g[1];
        curve += grams[b].h[1][1];
        TEST_ASSERT_EQUAL_DOUBLE(grams[b].h[0][1], grams[b].h[1][0]);
    }
    const double h = 0.01;
    const double by_difference = (squares_with(&f, h) - squares_with(&f, -h)) / (2.0 * h);
    TEST_ASSERT_TRUE(fabs(by_difference) > 100.0 && curve > 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(by_difference), by_difference, slope);
    free(grams);
    fit_end(&f);
}

/* Rows times ways, with the additional cost of a law. */
static void what_a_fit_spends_is_counted(void)
{
    static fitted f;
    good.m.R_ohm = 1.2;
    fit_it(&f, 0);
    double rows = 0.0;
    for (size_t b = 0; b < f.data.blocks; b++) {
        rows += (double)f.rows.block[f.data.block[b]].count;
    }
    const int column[] = {P_R, P_PSI};
    f.data.effort = 0.0;
    free(gram_blocks(&f.data, &f.state, column, 2));
    TEST_ASSERT_EQUAL_DOUBLE(3.0 * rows, f.data.effort);
    fit_noise(&f.data, &f.state);
    TEST_ASSERT_EQUAL_DOUBLE(4.0 * rows, f.data.effort);
    TEST_ASSERT_FALSE(fit_has_spent(&f.data));
    averaged_drive dear = f.frame.nominal;
    dear.edge = EDGE_CLIPPED;
    dear.v_dead_V = -1.0;
    dear.fe_S = 0.01;
    dear.saturation = 1e-3;
    f.data.effort = 0.0;
    fit_spend(&f.data, &dear, 2);
    TEST_ASSERT_EQUAL_DOUBLE(7.0 * rows, f.data.effort);
    dear = f.frame.nominal;
    dear.edge = EDGE_CLIPPED; /* no dead time by it */
    dear.w_dqq = 1e-6;
    fit_spend(&f.data, &dear, 1);
    TEST_ASSERT_EQUAL_DOUBLE(8.5 * rows, f.data.effort);
    dear = f.frame.nominal;
    dear.sensor_lag_s = -1e-5;
    fit_spend(&f.data, &dear, 1);
    TEST_ASSERT_EQUAL_DOUBLE(10.5 * rows, f.data.effort);
    f.data.effort = 1e9;
    TEST_ASSERT_TRUE(fit_has_spent(&f.data));
    fit_end(&f);
}

/* Rows that count several times take the place of others: by how much R lowers the objective, and how sure it is, stay. */
static void a_few_rows_count_for_all(void)
{
    static fitted f;
    good.m.R_ohm = 1.2;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    const fit_state nominal = fit_nominal();
    const int column[] = {P_R};
    const size_t all = f.data.rows_fitted;
    double by_R[4];
    double curve[4];
    for (size_t part = 1; part <= 4; part++) {
        fit_data_select(&f.data, part == 1 ? f.data.rows_max : all / part);
        bool has[ROWS_MAX_GROUPS] = {false};
        size_t rows = 0;
        for (size_t b = 0; b < f.data.blocks; b++) {
            const row_block *block = &f.rows.block[f.data.block[b]];
            TEST_ASSERT_FALSE(block->held_out);
            has[block->group] = true;
            rows += block->count;
        }
        for (size_t g = 0; g < f.rows.groups; g++) {
            TEST_ASSERT_TRUE(has[g]);
        }
        TEST_ASSERT_EQUAL_size_t(f.data.rows_fitted, rows);
        TEST_ASSERT_TRUE(rows <= all / part + f.rows.groups * f.data.longest);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (double)all, (double)all, f.data.weight * (double)rows);
        fit_state without = f.state;
        fit_state with = f.state;
        memcpy(without.z, nominal.z, sizeof without.z);
        fit_noise(&f.data, &without);
        fit_noise(&f.data, &with);
        by_R[part - 1] = without.objective - with.objective;
        gram *grams = gram_blocks(&f.data, &f.state, column, 1);
        TEST_ASSERT_NOT_NULL(grams);
        curve[part - 1] = 0.0;
        for (size_t b = 0; b < f.data.blocks; b++) {
            curve[part - 1] += grams[b].h[0][0];
        }
        free(grams);
        TEST_ASSERT_DOUBLE_WITHIN(0.2 * by_R[0], by_R[0], by_R[part - 1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.2 * curve[0], curve[0], curve[part - 1]);
    }
    fit_data_select(&f.data, f.data.rows_max);
    TEST_ASSERT_EQUAL_size_t(all, f.data.rows_fitted);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, f.data.weight);
    const double objective = f.state.objective;
    fit_noise(&f.data, &f.state);
    TEST_ASSERT_EQUAL_DOUBLE(objective, f.state.objective);
    fit_end(&f);
}

/* How much a search may spend that begins now. */
static double left_to_spend(const fit_data *d)
{
    fit_data spent = *d;
    double low = 0.0;
    double high = 1e9;
    for (int k = 0; k < 60; k++) {
        const double middle = 0.5 * (low + high);
        spent.effort = d->effort + middle;
        *(fit_has_spent(&spent) ? &high : &low) = middle;
    }
    return low;
}

/* A repeated search has half of the effort of the one before it, or the rest of that, if it is more. */
static void a_new_beginning_has_half(void)
{
    fit_data d = {.effort = 0.0};
    fit_grant(&d);
    const double first = left_to_spend(&d);
    TEST_ASSERT_TRUE(first > 1e6);
    d.effort = 1.5 * first;
    TEST_ASSERT_TRUE(fit_has_spent(&d));
    fit_grant(&d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * first, 0.5 * first, left_to_spend(&d));
    d.effort += 0.1 * first;
    fit_grant(&d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * first, 0.4 * first, left_to_spend(&d));
    d.effort += first;
    fit_grant(&d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * first, 0.125 * first, left_to_spend(&d));
}

/* From a file's values and gains of a half: no coordinate and no point's gain has a better place near by. */
static void a_fit_ends_where_nothing_is_better(void)
{
    static fitted f;
    good.m.R_ohm = 1.2;
    good.m.psi_f_Wb *= 1.02;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_FLUX));
    for (int side = -1; side <= 1; side += 2) {
        for (size_t g = 0; g < f.rows.groups; g++) {
            fit_state trial = f.state;
            trial.noise[g].gain = fmin(fmax(trial.noise[g].gain + side * 0.05, 0.03), 0.98);
            fit_noise(&f.data, &trial);
            TEST_ASSERT_TRUE(trial.objective > f.state.objective - 0.5);
        }
        const coordinate_id of[] = {P_R, P_PSI};
        for (size_t k = 0; k < 2; k++) {
            fit_state trial = f.state;
            trial.z[of[k]] += side * 0.01;
            fit_noise(&f.data, &trial);
            TEST_ASSERT_TRUE(trial.objective > f.state.objective - 0.5);
        }
    }
    fit_end(&f);
}

/* A map that bends back before the current that flows: no step leads out of there. */
static void without_a_number_nothing_is_moved(void)
{
    static fitted f;
    fit_it(&f, HYPOTHESIS_BIT(H_MAP_TERMS));
    f.state.z[P_W_DQQ] = 1e3;
    f.state.z[P_W_DDD] = -1e3;
    f.state.z[P_W_DDDD] = -1e6;
    const fit_state before = f.state;
    const fit_aim ranked = fit_ranked(INFINITY);
    double alone = 0.0;
    TEST_ASSERT_TRUE(fit_refine_within(&f.data, &f.state, 12, &ranked, &alone));
    TEST_ASSERT_TRUE(isnan(alone) && !isfinite(f.state.objective));
    TEST_ASSERT_EQUAL_MEMORY(before.z, f.state.z, sizeof before.z);
    fit_end(&f);
}

/* What all sums of the fit say along a direction and another. */
static double along(const fitted *f, const gram *grams, size_t n, const double *v, const double *w)
{
    double sum = 0.0;
    for (size_t b = 0; b < f->data.blocks; b++) {
        for (size_t i = 0; i < n; i++) {
            for (size_t j = 0; j < n; j++) {
                sum += v[i] * grams[b].h[i][j] * w[j];
            }
        }
    }
    return sum;
}

/* How the columns move if R, L, psi_f, the voltages and what a dead time loses grow by one factor, in the file's values. */
static double grows(const fitted *f, int column)
{
    const averaged_drive is = coordinates_drive(&f->frame, f->state.z, f->state.edge);
    switch (column) {
    case P_R:
        return is.R_ohm / f->m.R_ohm;
    case P_L_D:
    case P_L_Q:
        return 1.0;
    case P_PSI:
        return is.psi_f_Wb / f->m.psi_f_Wb;
    case P_K_U:
        return is.k_u;
    case P_V_DEAD:
    case P_COMPENSATION:
        return f->state.z[column];
    default:
        return 0.0;
    }
}

/* x, without what it shares with v in the measure of the sums' diagonal. */
static void without(const fitted *f, const gram *grams, size_t n, const double *v, double *x)
{
    double shared = 0.0;
    double square = 0.0;
    for (size_t b = 0; b < f->data.blocks; b++) {
        for (size_t i = 0; i < n; i++) {
            shared += v[i] * grams[b].h[i][i] * x[i];
            square += v[i] * grams[b].h[i][i] * v[i];
        }
    }
    for (size_t i = 0; i < n; i++) {
        x[i] -= shared / square * v[i];
    }
}

/*
 * No recording tells a factor of all voltages. Difference quotients do, by what they miss at the knees of a compensated dead time: that is
 * taken out of the sums, and along all that shares nothing with it they stay.
 */
static void a_factor_of_all_voltages_has_no_curvature(void)
{
    static fitted f;
    good.m.ext.has[CAUSE_DEAD_TIME] = true;
    good.m.ext.v_dead_V = 0.2;
    good.m.ext.compensation_V = 2.0;
    good.m.ext.i_knee_A = 0.05;
    good.m.ext.compensation_knee_A = 0.02;
    fit_it(&f, HYPOTHESIS_BIT(H_COMPENSATED) | HYPOTHESIS_BIT(H_VOLTAGE_GAIN));
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT] = {0.0};
    double v[MOST];
    double x[MOST];
    size_t n = gram_columns(&f.data, &f.state, f.state.set, column);
    n = last_digits_append(&f.data, &f.state, n, column, prior);
    TEST_ASSERT_TRUE(n <= MOST);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (column[i] != P_GAIN_A) { /* one of them fewer, and no factor on all currents is followed */
            column[kept++] = column[i];
        }
    }
    TEST_ASSERT_EQUAL_size_t(n - 1, kept);
    n = kept;
    gram *own = gram_blocks(&f.data, &f.state, column, n);
    gram *freed = gram_blocks(&f.data, &f.state, column, n);
    TEST_ASSERT_TRUE(own && freed);
    gram_free_scale(&f.data, &f.state, column, n, freed);
    double slope = 0.0;
    for (size_t i = 0; i < n; i++) {
        v[i] = grows(&f, column[i]);
        x[i] = 1.0 + (double)(i % 5);
        for (size_t b = 0; b < f.data.blocks; b++) {
            slope += v[i] * freed[b].g[i];
        }
    }
    const double told = along(&f, own, n, v, v);
    TEST_ASSERT_TRUE(told > 0.0 && along(&f, freed, n, v, v) < 1e-6 * told);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * sqrt(told), 0.0, slope);
    without(&f, own, n, v, x);
    const double rest = along(&f, own, n, x, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * rest, rest, along(&f, freed, n, x, x));
    free(freed);
    free(own);
    fit_end(&f);
}

/* Where a column is missing that the factor moves, it would show. */
static void a_factor_that_the_columns_cannot_follow_stays(void)
{
    static fitted f;
    good.m.R_ohm = 1.2;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    static const int column[] = {P_R, P_L_D, P_L_Q, P_PSI}; /* without the voltages' gain */
    gram *own = gram_blocks(&f.data, &f.state, column, 4);
    gram *freed = gram_blocks(&f.data, &f.state, column, 4);
    TEST_ASSERT_TRUE(own && freed);
    gram_free_scale(&f.data, &f.state, column, 4, freed);
    TEST_ASSERT_EQUAL_MEMORY(own, freed, f.data.blocks * sizeof *own);
    /* The knee of a dead time that acts is one, too. */
    f.state.z[P_V_DEAD] = 0.01;
    static const int without_knee[] = {P_R, P_L_D, P_L_Q, P_GAIN_A, P_GAIN_B, P_GAIN_C};
    free(freed);
    free(own);
    own = gram_blocks(&f.data, &f.state, without_knee, 6);
    freed = gram_blocks(&f.data, &f.state, without_knee, 6);
    TEST_ASSERT_TRUE(own && freed);
    gram_free_scale(&f.data, &f.state, without_knee, 6, freed);
    TEST_ASSERT_EQUAL_MEMORY(own, freed, f.data.blocks * sizeof *own);
    f.state.z[P_V_DEAD] = 0.0;
    gram_free_scale(&f.data, &f.state, without_knee, 6, freed);
    TEST_ASSERT_TRUE(memcmp(own, freed, f.data.blocks * sizeof *own) != 0);
    free(freed);
    free(own);
    fit_end(&f);
}

static void widths_are_of_the_steps_that_blocks_and_points_ask_for(void)
{
    static fitted f;
    good.m.R_ohm = 1.2;
    good.m.psi_f_Wb *= 1.02;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_FLUX));
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT] = {0.0};
    const size_t members = gram_columns(&f.data, &f.state, f.state.set, column);
    const size_t n = last_digits_append(&f.data, &f.state, members, column, prior);
    TEST_ASSERT_TRUE(n <= MOST && n == f.sure.columns);
    gram *grams = gram_blocks(&f.data, &f.state, column, n);
    gram_free_scale(&f.data, &f.state, column, n, grams);
    double information[MOST][MOST] = {{0.0}};
    double inverse[MOST][MOST];
    static double of_point[ROWS_MAX_GROUPS][COLUMN_COUNT];
    memset(of_point, 0, sizeof of_point);
    for (size_t i = 0; i < n; i++) {
        information[i][i] = prior[i];
        for (size_t b = 0; b < f.data.blocks; b++) {
            of_point[grams[b].group][i] += grams[b].g[i];
            for (size_t j = 0; j < n; j++) {
                information[i][j] += grams[b].h[i][j];
            }
        }
    }
    TEST_ASSERT_TRUE(solve_inverse(n, MOST, &information[0][0], &inverse[0][0]));
    TEST_ASSERT_EQUAL_size_t(BENCH_RUNS, f.rows.groups);
    const double blocks = (double)f.data.blocks;
    const double t_blocks = student_of_more_than_ten(blocks - (double)members);
    double ratio = 0.0;
    for (size_t i = 0; i < n; i++) {
        double by_blocks = 0.0;
        double by_points = 0.0;
        for (size_t b = 0; b < f.data.blocks; b++) {
            const double step = asked_by(inverse, i, grams[b].g, n);
            by_blocks += step * step;
        }
        for (size_t g = 0; g < BENCH_RUNS; g++) {
            const double step = asked_by(inverse, i, of_point[g], n);
            by_points += step * step;
        }
        for (size_t j = 0; j < n; j++) { /* and what is known beforehand */
            by_blocks += prior[j] * inverse[i][j] * inverse[i][j];
            by_points += prior[j] * inverse[i][j] * inverse[i][j];
        }
        by_blocks *= blocks / (blocks - (double)members);
        by_points *= (double)BENCH_RUNS / (BENCH_RUNS - 1);
        const double wanted =
            fmax(1.96 * sqrt(inverse[i][i]), fmax(t_blocks * sqrt(by_blocks), T_OF_5 * sqrt(by_points)));
        TEST_ASSERT_DOUBLE_WITHIN(0.001 * wanted, wanted, f.sure.half_width[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * by_blocks, by_blocks, f.sure.covariance[i][i]);
        ratio += i < members ? by_blocks / inverse[i][i] / (double)members : 0.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * ratio, fmax(1.0, ratio), f.sure.inflation);
    free(grams);
    fit_end(&f);
}

/* Two columns that do the same: nothing is known of either. */
static void indistinguishable_columns_are_not_known(void)
{
    static fitted f;
    good.two_sensors = true;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    TEST_ASSERT_TRUE(certainty_half_width(&f.sure, P_R) < 0.05);
    f.state.set = HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_RESISTANCE_DRIFTS); /* its column twice */
    TEST_ASSERT_TRUE(certainty_of(&f.data, &f.state, &f.sure));
    TEST_ASSERT_TRUE(certainty_half_width(&f.sure, P_R) > 1e5);
    f.state.set = 0;
    TEST_ASSERT_TRUE(certainty_of(&f.data, &f.state, &f.sure)); /* of two sensors nothing is fitted then */
    TEST_ASSERT_EQUAL_DOUBLE(1.0, f.sure.inflation);
    fit_end(&f);
}

/* ---- What is named ---- */

static void a_clean_recording_has_no_cause(void)
{
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    TEST_ASSERT_EQUAL_INT(VERDICT_CLEAN, d.verdict);
    TEST_ASSERT_EQUAL_STRING("clean", diagnosis_verdict_id(d.verdict));
    diagnosis_free(&d);
    TEST_ASSERT_NULL(d.error_nominal);
}

static bool names(const diagnosis *d, const char *id)
{
    for (size_t k = 0; k < d->causes; k++) {
        if (strcmp(d->cause[k].id, id) == 0) {
            return true;
        }
    }
    return false;
}

static void three_causes_of_unequal_size_are_found(void)
{
    good.m.ext.has[CAUSE_VOLTAGE_DELAY] = true;
    good.m.ext.voltage_delay_cycles = 0.5;
    good.m.R_ohm *= 1.6;
    good.m.L_d_H *= 0.9;
    good.m.L_q_H *= 0.9;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(3, d.causes);
    TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d.verdict);
    TEST_ASSERT_TRUE(names(&d, "voltage_delay") && names(&d, "resistance") && names(&d, "inductance"));
    for (size_t k = 0; k < d.causes; k++) {
        TEST_ASSERT_TRUE(d.cause[k].probability > 0.99 && d.cause[k].certainty > 25.0);
    }
    diagnosis_free(&d);
}

/* What a dead time's law leaves near zero current is not given a name of its own. */
static void a_dead_time_takes_nothing_with_it(void)
{
    good.m.ext.has[CAUSE_DEAD_TIME] = true;
    good.m.ext.v_dead_V = 4.0;
    good.m.ext.i_knee_A = 0.2;
    good.m.R_ohm *= 1.08;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_STRING("dead_time", d.cause[0].id);
    holds(&d.cause[0], "v_dead", 4.0);
    TEST_ASSERT_TRUE(d.causes == 1 || (d.causes == 2 && names(&d, "resistance")));
    diagnosis_free(&d);
}

/* An effect that no cause has: nothing is made up for it, alone or next to a flux that is named. */
static void nothing_is_named_for_what_has_no_name(void)
{
    good.cogging_V = 1.0;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    TEST_ASSERT_EQUAL_INT(VERDICT_UNEXPLAINED, d.verdict);
    TEST_ASSERT_EQUAL_STRING("unexplained", diagnosis_verdict_id(d.verdict));
    diagnosis_free(&d);
    good.m.psi_f_Wb *= 0.93;
    d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(1, d.causes);
    TEST_ASSERT_EQUAL_STRING("flux_linkage", d.cause[0].id);
    TEST_ASSERT_EQUAL_INT(VERDICT_PARTLY, d.verdict);
    TEST_ASSERT_EQUAL_STRING("partly", diagnosis_verdict_id(d.verdict));
    diagnosis_free(&d);
}

/* ---- The fit of the whole drive ---- */

/* What the rows show of a drive at z that one factor on all voltages, or on all currents, makes of another. */
static void same_by(fitted *f, const fit_state *one, double voltages, double currents)
{
    fit_state other = *one;
    coordinates_scale(&f->frame, voltages, currents, other.z);
    fit_noise(&f->data, &other);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, one->objective, other.objective);
}

/*
 * R, inductances, magnet and all voltages by one factor change no current, with all effects that hold a voltage or an inductance. Neither
 * do R, inductances and the current sensors' gains.
 */
static void one_factor_on_the_drive_changes_nothing(void)
{
    static fitted f;
    static const struct {
        coordinate_id of;
        double z;
    } off[] = {{P_R, 0.1},           {P_L_D, -0.1},    {P_L_Q, 0.05},    {P_PSI, -0.03},
               {P_SATURATION, 0.02}, {P_V_DEAD, 1.0},  {P_RIPPLE, 0.9},  {P_COMPENSATION, 1.0},
               {P_K_U, 0.04},        {P_PSI_5, 0.01},  {P_DR_A, 0.02},   {P_DL_B, 0.01},
               {P_FE, 0.3},          {P_T_DELAY, 0.1}, {P_GAIN_A, 0.01}, {P_KNEE, 0.3},
               {P_IRON_1, 0.1},      {P_W_DDD, 0.05},  {P_W_QQQQ, 0.02}};
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    fit_state one = f.state;
    for (size_t k = 0; k < sizeof off / sizeof *off; k++) {
        one.z[off[k].of] += off[k].z;
    }
    fit_noise(&f.data, &one);
    TEST_ASSERT_TRUE(one.objective - f.state.objective > 1000.0); /* they act */
    /* Noise decides the sign of a large compensation, and keeps its size in amperes. */
    fit_state small = one;
    small.z[P_COMPENSATION] = 0.05;
    fit_noise(&f.data, &small);
    for (int percent = -20; percent <= 20; percent += 10) {
        same_by(&f, &one, 1.0 + 0.01 * percent, 1.0);
        same_by(&f, &small, 1.0, 1.0 + 0.01 * percent);
        same_by(&f, &small, 1.1, 1.0 + 0.01 * percent);
    }
    fit_end(&f);
}

/* If the voltages' gain is not fitted, a machine that is off by one factor is not scaled back to the motor file. */
static void the_whole_drive_keeps_a_scale_that_is_known(void)
{
    static fitted f;
    static whole_fit w;
    const hypothesis_set parts =
        HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_BOTH_AXES) | HYPOTHESIS_BIT(H_FLUX);
    good.m.R_ohm *= 1.06;
    good.m.L_d_H *= 1.06;
    good.m.L_q_H *= 1.06;
    good.m.psi_f_Wb *= 1.06;
    fit_it(&f, parts);
    /* A search may have strained the tolerances along that factor. */
    fit_state start = f.state;
    start.z[P_K_U] = -0.05;
    TEST_ASSERT_TRUE(whole_fit_find(&f.data, &start, parts, 1.0, &w, NULL));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, w.state.z[P_K_U]);
    const averaged_drive is = fit_drive(&f.data, &w.state);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, f.frame.nominal.k_u, is.k_u);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.06, is.psi_f_Wb / f.m.psi_f_Wb);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.06, is.L_d_H / f.m.L_d_H);
    fit_end(&f);
}

/* At its sharpest an edge stays so by any factor: a drive beyond a bound would not be compared. */
static void one_factor_on_the_drive_keeps_the_edges_bounds(void)
{
    static fitted f;
    static const coordinate_id knees[] = {P_KNEE, P_COMPENSATION_KNEE};
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    for (size_t k = 0; k < 2; k++) {
        double low;
        double high;
        fit_state s = f.state;
        coordinate_range(&f.frame, knees[k], &low, &high);
        s.z[knees[k]] = low;
        coordinates_scale(&f.frame, 1.0, 0.95, s.z);
        TEST_ASSERT_EQUAL_DOUBLE(low, s.z[knees[k]]);
        coordinates_scale(&f.frame, 1.0, 1.25, s.z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, low + log(1.25), s.z[knees[k]]);
        s.z[knees[k]] = high;
        coordinates_scale(&f.frame, 1.0, 1.05, s.z);
        TEST_ASSERT_EQUAL_DOUBLE(high, s.z[knees[k]]);
    }
    fit_end(&f);
}

static const hypothesis_set OF_SCALE = HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_BOTH_AXES) |
                                       HYPOTHESIS_BIT(H_FLUX) | HYPOTHESIS_BIT(H_VOLTAGE_GAIN);

/* Of the recorded drive: the shares of its common factor. */
static void weigh_scales(fitted *f, whole_fit *w)
{
    fit_it(f, OF_SCALE & ~HYPOTHESIS_BIT(H_VOLTAGE_GAIN));
    TEST_ASSERT_TRUE(whole_fit_find(&f->data, &f->state, OF_SCALE, 1.0, w, NULL));
    double sum = 0.0;
    for (size_t k = 0; k < DRIVE_SCALES; k++) {
        TEST_ASSERT_TRUE(w->scale[k].share >= 0.0);
        sum += w->scale[k].share;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, sum);
}

/* R, L, psi_f and voltages by one factor: the most probable one is found, and what another would say has its share. */
static void drives_by_another_factor_have_their_shares(void)
{
    enum { R = 1, L = 2, PSI = 4, U = 8 };
    static fitted f;
    static whole_fit w;
    static session s;
    /* All alike by 6 %: the voltages. */
    good.m.R_ohm *= 1.06;
    good.m.L_d_H *= 1.06;
    good.m.L_q_H *= 1.06;
    good.m.psi_f_Wb *= 1.06;
    weigh_scales(&f, &w);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.0 / 1.06, fit_drive(&f.data, &w.state).k_u);
    TEST_ASSERT_TRUE(w.scale[U].share > 0.9);
    memcpy(s.scale, w.scale, sizeof s.scale);
    TEST_ASSERT_TRUE(session_scale_doubt(&s, H_VOLTAGE_GAIN) < 0.05);
    fit_end(&f);
    /* R alone: no other factor is as probable. */
    good.m = bench_motor();
    good.m.R_ohm *= 1.06;
    weigh_scales(&f, &w);
    memcpy(s.scale, w.scale, sizeof s.scale);
    TEST_ASSERT_TRUE(session_scale_doubt(&s, H_RESISTANCE) < 0.05);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, session_scale_doubt(&s, H_DEAD_TIME));
    fit_end(&f);
    /* R by 7 %, the inductances by -6 % and psi_f by 2 %: that may be the voltages by -2 %, and R by 5 % and the inductances by -8 %. */
    good.m.R_ohm *= 1.07 / 1.06;
    good.m.L_d_H *= 0.94;
    good.m.L_q_H *= 0.94;
    good.m.psi_f_Wb *= 1.02;
    weigh_scales(&f, &w);
    memcpy(s.scale, w.scale, sizeof s.scale);
    TEST_ASSERT_TRUE(session_scale_doubt(&s, H_RESISTANCE) < 0.05);
    TEST_ASSERT_TRUE(session_scale_doubt(&s, H_FLUX) > 0.05);
    TEST_ASSERT_TRUE(session_scale_doubt(&s, H_VOLTAGE_GAIN) > 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.02, w.scale[R | L | PSI].factor / w.scale[R | L | U].factor);
    fit_end(&f);
}

/* A warm machine with one bad joint: of all divisions between the machine's resistance and the phases' the one with a single phase. */
static void a_bad_joint_is_one_phase(void)
{
    static fitted f;
    static whole_fit w;
    const hypothesis_set parts = HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_ASYMMETRY);
    good.m.R_ohm *= 1.06;
    good.m.ext.has[CAUSE_PHASE_ASYMMETRY] = true;
    good.m.ext.dR_ohm[1] = 0.3 * bench_motor().R_ohm;
    fit_it(&f, parts);
    TEST_ASSERT_TRUE(whole_fit_find(&f.data, &f.state, parts, 1.0, &w, NULL));
    const averaged_drive is = fit_drive(&f.data, &w.state);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.06, is.R_ohm / f.m.R_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, is.dR_ohm[0] / f.m.R_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.3, is.dR_ohm[1] / f.m.R_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, is.dR_ohm[2] / f.m.R_ohm);
    fit_end(&f);
}

/* The place of a column in a whole fit. */
static size_t place(const whole_fit *w, int column)
{
    size_t k = 0;
    while (k < w->columns && w->column[k] != column) {
        k++;
    }
    TEST_ASSERT_TRUE(k < w->columns);
    return k;
}

/* Shared by two gains: the precision of the prior of three sensors' mean. */
static double shared_by_gains(bool two_sensors)
{
    static fitted f;
    static whole_fit w;
    const hypothesis_set parts = HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_CURRENT_GAIN);
    good.two_sensors = two_sensors;
    fit_it(&f, HYPOTHESIS_BIT(H_RESISTANCE));
    TEST_ASSERT_TRUE(whole_fit_find(&f.data, &f.state, parts, 1.0, &w, NULL));
    const double shared = w.prior[place(&w, P_GAIN_A)][place(&w, P_GAIN_B)] / w.inflation;
    fit_end(&f);
    return shared;
}

static void the_mean_of_three_gains_is_known_and_that_of_two_is_not(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 1.0 / (0.002 * 0.002 * 9.0), shared_by_gains(false));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, shared_by_gains(true));
}

/* What only a prior tells has the 95 % interval of that prior: Student's t of two degrees, and what drives usually differ by. */
static void an_interval_holds_as_much_of_the_prior(void)
{
    static fitted f;
    static whole_fit w;
    good.m.R_ohm = 1.2;
    fit_it(&f, OF_SCALE & ~HYPOTHESIS_BIT(H_VOLTAGE_GAIN));
    TEST_ASSERT_TRUE(whole_fit_find(&f.data, &f.state, OF_SCALE, 1.0, &w, NULL));
    const double width = 4.303 / 1.960 * w.roughness * coordinate_table[P_PSI].digits;
    const double usual = coordinate_table[P_PSI].usual;
    const size_t psi = place(&w, P_PSI);
    TEST_ASSERT_DOUBLE_WITHIN(0.5 * coordinate_table[P_PSI].digits, 0.0,
                              w.state.z[P_PSI]); /* in the middle */
    const double wanted = w.inflation * (1.0 / (width * width) + 1.0 / (usual * usual));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * wanted, wanted, w.prior[psi][psi]);
    /* Far from there the prior's own curvature is less. */
    const double R = w.state.z[P_R];
    const double tolerance = w.roughness * coordinate_table[P_R].digits;
    const double usual_R = coordinate_table[P_R].usual;
    const double tail =
        w.inflation * (3.0 / (2.0 * tolerance * tolerance + R * R) + 1.0 / (usual_R * usual_R));
    TEST_ASSERT_TRUE(R > 5.0 * tolerance);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * tail, tail, w.prior[place(&w, P_R)][place(&w, P_R)]);
    fit_end(&f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_interval_holds_as_much_of_the_prior);
    RUN_TEST(the_mean_of_three_gains_is_known_and_that_of_two_is_not);
    RUN_TEST(a_gain_is_a_column_as_any_other);
    RUN_TEST(what_a_fit_spends_is_counted);
    RUN_TEST(a_few_rows_count_for_all);
    RUN_TEST(a_new_beginning_has_half);
    RUN_TEST(a_fit_ends_where_nothing_is_better);
    RUN_TEST(without_a_number_nothing_is_moved);
    RUN_TEST(a_factor_of_all_voltages_has_no_curvature);
    RUN_TEST(a_factor_that_the_columns_cannot_follow_stays);
    RUN_TEST(widths_are_of_the_steps_that_blocks_and_points_ask_for);
    RUN_TEST(indistinguishable_columns_are_not_known);
    RUN_TEST(a_clean_recording_has_no_cause);
    RUN_TEST(three_causes_of_unequal_size_are_found);
    RUN_TEST(a_dead_time_takes_nothing_with_it);
    RUN_TEST(nothing_is_named_for_what_has_no_name);
    RUN_TEST(one_factor_on_the_drive_changes_nothing);
    RUN_TEST(one_factor_on_the_drive_keeps_the_edges_bounds);
    RUN_TEST(drives_by_another_factor_have_their_shares);
    RUN_TEST(the_whole_drive_keeps_a_scale_that_is_known);
    RUN_TEST(a_bad_joint_is_one_phase);
    return UNITY_END();
}
