/* Prepares a recording: angles, voltages, edges, nodes, blocks (rows.h). */
#include "rows.h"

#include "row_clips.h"
#include "row_edges.h"
#include "row_noise.h"
#include "row_speeds.h"

#include <math.h>
#include <stdlib.h>

enum {
    BLOCK_ROWS_MIN = 80,   /* the observer's start costs a few rows of each block */
    BLOCK_ROWS_SHORT = 40, /* if no block could be held out otherwise */
    BLOCK_ROWS_MAX = 300,  /* long enough for effects that act over L/R, short enough for many blocks */
    BLOCKS_PER_STRETCH = 8,
    GROUPS_WANTED = 6 /* a recording of fewer runs is cut in time: robust intervals need groups */
};

static const double WARMER_K = 5.0;

static bool angle_is_wrapped(const recording *rec)
{
    for (size_t k = 0; k < rec->rows; k++) {
        if (fabs(rec->theta_e_rad[k]) > VEC_TWO_PI + 0.01) {
            return false;
        }
    }
    return true;
}

/*
 * Two angles that differ by less than this, rms, come from one sensor. The reporting threshold of an angle error is 1.5 times as
 * large.
 */
static const double ONE_SENSOR_RAD = 2e-3;

/* Whether the mechanical angle has the errors of the electrical one. True if it is counted from the electrical angle. */
static bool one_sensor(const recording *rec, int pole_pairs)
{
    double along = 0.0;
    double across = 0.0;
    for (size_t k = 0; rec->theta_mech_rad && k < rec->rows; k++) {
        const double apart = pole_pairs * rec->theta_mech_rad[k] - rec->theta_e_rad[k];
        along += cos(apart) / (double)rec->rows;
        across += sin(apart) / (double)rec->rows;
    }
    /* For small angles about their mean, the length of the mean vector is 1 - (mean square)/2. */
    return !rec->theta_mech_rad || 1.0 - hypot(along, across) < 0.5 * ONE_SENSOR_RAD * ONE_SENSOR_RAD;
}

static void fill_angles(diagnose_rows *r, const motor *m)
{
    const recording *rec = r->recording;
    const double mech_moves = one_sensor(rec, m->pole_pairs) ? 1.0 / m->pole_pairs : 0.0;
    for (size_t n = 0; n < rec->stretches; n++) {
        const stretch *s = &rec->stretch[n];
        double turns = 0.0;
        for (size_t j = 0; j < s->count; j++) {
            size_t k = s->first + j;
            cycle_row *row = &r->row[k];
            double theta = rec->theta_e_rad[k];
            row->omega_rad_s = rec->omega_e_rad_s[k];
            row->cos_theta = cos(theta);
            row->sin_theta = sin(theta);
            row->cos_turn = cos(row->omega_rad_s * r->T_s);
            row->sin_turn = sin(row->omega_rad_s * r->T_s);
            if (j > 0) {
                turns -= VEC_TWO_PI *
                         round((theta - rec->theta_e_rad[k - 1] - row->omega_rad_s * r->T_s) / VEC_TWO_PI);
            }
            double mech = rec->theta_mech_rad ? rec->theta_mech_rad[k] : (theta + turns) / m->pole_pairs;
            row->cos_mech = cos(mech);
            row->sin_mech = sin(mech);
            row->mech_moves = mech_moves;
            row->per_pole = 1.0 / m->pole_pairs;
            r->omega_max_rad_s = fmax(r->omega_max_rad_s, fabs(row->omega_rad_s));
        }
    }
}

/* The time of each row, from the mean of all. A value that drifts is reported for that mean time. */
static void fill_times(diagnose_rows *r)
{
    const recording *rec = r->recording;
    double sum = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const double since_first = rec->t_s[k] - rec->t_s[0];
        sum += since_first / (double)r->rows;
        r->row[k].elapsed_s = since_first;
        r->span_s = fmax(r->span_s, fabs(since_first));
    }
    for (size_t k = 0; k < r->rows; k++) {
        r->row[k].elapsed_s -= sum;
    }
    r->span_s = fmax(r->span_s, r->T_s);
}

static void fill_electrical(diagnose_rows *r)
{
    const recording *rec = r->recording;
    double temperature = 0.0;
    double u2 = 0.0;
    for (size_t k = 0; rec->temp_C && k < rec->rows; k++) {
        temperature += rec->temp_C[k] / (double)rec->rows;
    }
    for (size_t n = 0; n < rec->stretches; n++) {
        const stretch *s = &rec->stretch[n];
        vec_ab command = {0.0, 0.0};
        vec_ab before = {0.0, 0.0};
        for (size_t j = 0; j < s->count; j++) {
            size_t k = s->first + j;
            cycle_row *row = &r->row[k];
            double u[3];
            recording_voltage(rec, k, u);
            command = vec_from_phases(u);
            before = j > 0 ? before : command;
            row->u_V[0] = pwm_updates_is_plain(&r->pwm)
                              ? command
                              : pwm_updates_mean(&r->pwm, command, before, row->omega_rad_s * r->T_s);
            before = command;
            row->u_V[1] = j > 0 ? row[-1].u_V[0] : row->u_V[0];
            row->u_V[2] = j > 0 ? row[-1].u_V[1] : row->u_V[0];
            row->i_A = recording_current(rec, k);
            row->history = j;
            row->T_s = r->T_s;
            row->i_zero_A = (rec->i_A[0][k] + rec->i_A[1][k] + rec->i_A[2][k]) / 3.0;
            row->temperature_K = rec->temp_C ? rec->temp_C[k] - temperature : 0.0;
            r->i_peak_A = fmax(r->i_peak_A, hypot(row->i_A.alpha, row->i_A.beta));
            u2 += row->u_V[0].alpha * row->u_V[0].alpha + row->u_V[0].beta * row->u_V[0].beta;
        }
    }
    r->u_rms_V = sqrt(u2 / (double)rec->rows);
}

void rows_find_missing(diagnose_rows *r)
{
    for (size_t k = 0; k < r->rows; k++) {
        cycle_row *row = &r->row[k];
        row->missing = current_sensors_missing(r->recording, &r->pwm, r->sensors, k, row->history);
    }
}

enum { NOISE_ROWS = 30 };

/* Variance of the noise of a phase's current in a stretch: third differences of the current seen from the rotor. */
static double noise_variance(const diagnose_rows *r, const stretch *s)
{
    double sum = 0.0;
    for (size_t k = s->first + 3; k < s->first + s->count; k++) {
        vec_dq i[4];
        for (size_t n = 0; n < 4; n++) {
            const cycle_row *row = &r->row[k - n];
            i[n] = vec_to_dq(row->i_A, (vec_rotor){row->cos_theta, row->sin_theta});
        }
        const double d = i[0].d - 3.0 * i[1].d + 3.0 * i[2].d - i[3].d;
        const double q = i[0].q - 3.0 * i[1].q + 3.0 * i[2].q - i[3].q;
        sum += 0.5 * (d * d + q * q);
    }
    return sum / (20.0 * (double)(s->count - 3));
}

/* By the quietest stretch: sensors are as noisy at one operating point as at another. */
static void find_noise(diagnose_rows *r)
{
    double least = INFINITY;
    for (size_t n = 0; n < r->recording->stretches; n++) {
        const stretch *s = &r->recording->stretch[n];
        least = s->count > NOISE_ROWS ? fmin(least, noise_variance(r, s)) : least;
    }
    r->noise_A = sqrt(least);
}

static size_t blocks_of(const stretch *s, size_t least)
{
    const size_t usable = s->count > ROWS_HISTORY ? s->count - ROWS_HISTORY : 0;
    size_t length = usable / BLOCKS_PER_STRETCH;
    length = length < least ? least : (length > BLOCK_ROWS_MAX ? BLOCK_ROWS_MAX : length);
    size_t n = usable / length;
    return n > 0 ? n : (usable >= BLOCK_ROWS_MIN / 4 ? 1 : 0);
}

static size_t blocks_in_all(const recording *rec, size_t least)
{
    size_t total = 0;
    for (size_t s = 0; s < rec->stretches; s++) {
        total += blocks_of(&rec->stretch[s], least);
    }
    return total;
}

/* Three of ten, and one of the first three. */
static bool is_held_out(size_t block)
{
    return block % 10 == 2 || block % 10 == 5 || block % 10 == 8;
}

static size_t distinct_runs(const recording *rec)
{
    size_t n = rec->stretches > 0 ? 1 : 0;
    for (size_t s = 1; s < rec->stretches; s++) {
        n += rec->stretch[s].run != rec->stretch[s - 1].run;
    }
    return n;
}

/* Whether the temperature changes by enough to show its effects: by 2 % of a copper winding's resistance. */
static bool warms(const recording *rec)
{
    double least = INFINITY;
    double most = -INFINITY;
    for (size_t k = 0; rec->temp_C && k < rec->rows; k++) {
        least = fmin(least, rec->temp_C[k]);
        most = fmax(most, rec->temp_C[k]);
    }
    return most - least >= WARMER_K;
}

/* Whether a sensor is at the end of its range in a block, which makes the block useless. Counts such rows. */
static bool is_clipped(diagnose_rows *r, const row_block *b, double end_A)
{
    size_t rows = 0;
    for (size_t k = b->first; k < b->first + b->count; k++) {
        rows += row_clips_at(r->recording, k, end_A);
    }
    r->clipped += rows;
    return rows > 0;
}

static bool cut_blocks(diagnose_rows *r)
{
    const recording *rec = r->recording;
    const size_t least = blocks_in_all(rec, BLOCK_ROWS_MIN) > 2 ? BLOCK_ROWS_MIN : BLOCK_ROWS_SHORT;
    const size_t total = blocks_in_all(rec, least);
    r->block = calloc(total + 1, sizeof *r->block);
    if (!r->block) {
        return false;
    }
    const bool by_run = distinct_runs(rec) >= GROUPS_WANTED && distinct_runs(rec) <= ROWS_MAX_GROUPS;
    const size_t wanted = total < 12 ? GROUPS_WANTED : 12;
    const size_t in_time = total < wanted ? total : wanted;
    const double end_A = row_clips_end_A(rec);
    for (size_t s = 0; s < rec->stretches; s++) {
        const stretch *st = &rec->stretch[s];
        const size_t n = blocks_of(st, least);
        for (size_t j = 0; j < n; j++) {
            const size_t usable = st->count - ROWS_HISTORY;
            row_block *b = &r->block[r->blocks];
            b->first = st->first + ROWS_HISTORY + j * usable / n;
            b->count = st->first + ROWS_HISTORY + (j + 1) * usable / n - b->first;
            b->stretch = s;
            if (is_clipped(r, b, end_A)) {
                continue;
            }
            if (by_run) {
                const bool same = r->groups > 0 && r->group_run[r->groups - 1] == st->run;
                b->group = same ? r->groups - 1 : r->groups;
            } else {
                /* There is a block, so that total is not 0. NOLINTNEXTLINE(clang-analyzer-core.DivideZero) */
                b->group = r->blocks * in_time / total;
            }
            r->group_run[b->group] = st->run;
            r->groups = b->group + 1;
            b->held_out = is_held_out(r->blocks);
            r->blocks++;
        }
    }
    return true;
}

bool rows_prepare(diagnose_rows *r, const recording *rec, const motor *m, error *e)
{
    *r = (diagnose_rows){.recording = rec, .T_s = rec->T_s, .rows = rec->rows};
    r->row = calloc(rec->rows, sizeof *r->row);
    r->outlier = calloc(rec->rows, 1);
    if (!r->row || !r->outlier) {
        rows_free(r);
        return error_failure(e, 0, "out of memory for %zu rows", rec->rows);
    }
    r->pwm = rec->pwm_stated ? rec->pwm : m->pwm;
    r->sensors = current_sensors_of(rec, &r->pwm);
    r->mech_known = rec->theta_mech_rad != NULL || !angle_is_wrapped(rec) || m->pole_pairs == 1;
    r->temperature_known = warms(rec);
    fill_times(r);
    fill_angles(r, m);
    rows_correct_speed(r);
    fill_electrical(r);
    find_noise(r);
    rows_find_missing(r);
    rows_fill_edges(r, m, MODULATOR_MIN_MAX);
    if (!rows_find_voltage_noise(r) || !rows_place_nodes(r) || !cut_blocks(r)) {
        rows_free(r);
        return error_failure(e, 0, "out of memory for %zu rows", rec->rows);
    }
    if (r->blocks < 3 && r->clipped > 0) {
        const size_t clipped = r->clipped;
        rows_free(r);
        return error_input(
            e, rec->path, 0, 0,
            "the current sensors are at the end of their range in %zu of %zu rows: too few are left", clipped,
            rec->rows);
    }
    if (r->blocks < 3) {
        rows_free(r);
        return error_input(e, rec->path, 0, 0,
                           "%zu rows in %zu stretches are too few to hold some out and fit the others",
                           rec->rows, rec->stretches);
    }
    return true;
}

void rows_free(diagnose_rows *r)
{
    free(r->row);
    for (size_t n = 0; n < r->corrections; n++) {
        free(r->correction[n].before);
    }
    free(r->rough);
    free(r->outlier);
    free(r->node_omega_rad_s);
    free(r->block);
    *r = (diagnose_rows){0};
}

void rows_nodes_fill(const diagnose_rows *r, const averaged_drive *drive, averaged_node *nodes)
{
    for (size_t n = 0; n < r->nodes; n++) {
        nodes[n] = averaged_node_at(drive->R_ohm, drive->L_d_H, drive->L_q_H, r->T_s, r->node_omega_rad_s[n]);
    }
}

averaged_node *rows_nodes(const diagnose_rows *r, const averaged_drive *drive)
{
    averaged_node *nodes = calloc(r->nodes, sizeof *nodes);
    if (nodes) {
        rows_nodes_fill(r, drive, nodes);
    }
    return nodes;
}

void rows_turn_mechanical(diagnose_rows *r, size_t stretch_index, double angle_rad)
{
    const stretch *s = &r->recording->stretch[stretch_index];
    double c = cos(angle_rad);
    double f = sin(angle_rad);
    for (size_t k = s->first; k < s->first + s->count; k++) {
        cycle_row *row = &r->row[k];
        double a = row->cos_mech;
        double b = row->sin_mech;
        row->cos_mech = a * c - b * f;
        row->sin_mech = a * f + b * c;
    }
}
