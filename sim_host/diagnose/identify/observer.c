/* Runs the averaged drive as an observer along a recording (observer.h). */
#include "observer.h"

#include "model/iron_branch.h"
#include "model/sensor_chain.h"
#include "model/sensor_lag.h"
#include "model/sensor_nonlinearity.h"

#include <math.h>
#include <stddef.h>

static bool sensors_change(const averaged_drive *drive, const sensor_course *course)
{
    return course->changes || drive->sensor_lag_s != 0.0;
}

/*
 * The sensors at a row, if they change from row to row. `x`: the true current that a run has there; NULL at its start. `turn` and `before`:
 * the row's and that of the row before it; NULL where they are found.
 */
static sensor_map sensors_at(const diagnose_rows *r, const averaged_drive *drive, const sensor_course *course,
                             const cycle_row *row, const cycle_turn *turn, const cycle_turn *before,
                             const vec_ab *x, lag_memory *memory)
{
    const sensor_map map = sensor_course_at(course, row);
    if (drive->sensor_lag_s == 0.0) {
        return map;
    }
    const vec_ab about = x ? *x : sensor_map_unmeasure(&map, row->i_A);
    const vec_rotor rotor = turn ? turn->start : averaged_drive_rotor(drive, row);
    return sensor_lag_map(drive, row, r->T_s, &map, rotor, before, about, memory);
}

/* The measured current of a row's true current; *zero: mean of the three sensors. */
static vec_ab shown(const averaged_drive *drive, const sensor_map *map, const cycle_row *row, vec_ab x,
                    double *zero)
{
    vec_ab y = sensor_map_measure(map, x);
    *zero = map->zero[0] * x.alpha + map->zero[1] * x.beta + map->zero_offset_A;
    if (sensor_nonlinearity_present(drive)) {
        double more_zero;
        const vec_ab more = sensor_nonlinearity_error(drive, row, y, &more_zero);
        y = (vec_ab){y.alpha + more.alpha, y.beta + more.beta};
        *zero += more_zero;
    }
    return y;
}

static vec_ab unshown(const averaged_drive *drive, const sensor_map *map, const cycle_row *row)
{
    const bool bent = sensor_nonlinearity_present(drive);
    return sensor_map_unmeasure(map, bent ? sensor_nonlinearity_remove(drive, row, row->i_A) : row->i_A);
}

/* In deviations of a phase's noise: a sign is as good as unknown up to here. */
static const double SIGN_UNKNOWN = 2.5;

/* What is in doubt of a vector: shares along the axis of the phase nearest to zero, and across it. */
typedef struct sign_doubt {
    vec_ab axis;
    double along, across;
} sign_doubt;

/* Of the current at a cycle's end, by the one that decides a compensation at its start. */
static sign_doubt sign_doubt_of(const diagnose_rows *r, missing_phase missing, vec_ab i)
{
    sign_doubt doubt = {.along = 0.0};
    for (int x = 0; x < 3 && r->noise_A > 0.0; x++) {
        const double at = fabs(vec_phase(i, x)) / rows_phase_noise(r->noise_A, missing, x);
        const double rest =
            fmin(1.0, fmax(0.0, (OBSERVER_SIGN_KNOWN - at) / (OBSERVER_SIGN_KNOWN - SIGN_UNKNOWN)));
        const double share = rest * rest * (3.0 - 2.0 * rest);
        if (share > doubt.along) {
            doubt = (sign_doubt){.axis = vec_phase_axis[x], .along = share, .across = doubt.along};
        } else {
            doubt.across = fmax(doubt.across, share);
        }
    }
    return doubt;
}

bool observer_sign_is_unsure(const diagnose_rows *r, const averaged_drive *drive, missing_phase missing,
                             vec_ab i)
{
    return drive->sign_is_doubted && sign_doubt_of(r, missing, i).along > 0.0;
}

static vec_ab doubted(const sign_doubt *doubt, vec_ab v)
{
    const double by =
        (doubt->along - doubt->across) * (doubt->axis.alpha * v.alpha + doubt->axis.beta * v.beta);
    return (vec_ab){doubt->across * v.alpha + by * doubt->axis.alpha,
                    doubt->across * v.beta + by * doubt->axis.beta};
}

/* A drive's run through a block. */
typedef struct walker {
    diagnose_rows *r;
    const averaged_drive *drive;
    double gain;
    sensor_course course;
    bool change; /* the sensors change from row to row */
    lag_memory memory;
    const cycle_turn *before; /* the last row's */
    vec_ab x;                 /* true current, estimated from all rows so far */
    vec_ab seen;              /* the last row's current, if signs are doubted */
    sign_doubt doubt;         /* of the last row's cycle */
    size_t age;               /* rows since the start */
} walker;

static walker walker_of(diagnose_rows *r, const averaged_drive *drive, double gain)
{
    walker w = {.r = r, .drive = drive, .gain = gain, .course = sensor_course_of(drive, r->sensors)};
    w.change = sensors_change(drive, &w.course);
    return w;
}

/*
 * Corrects the run by the measured current of row k, whose turn is `turn`. Writes the innovations to `out`, zeros if the run starts again.
 * Returns the share that is counted.
 */
static double take_in(walker *w, size_t k, const cycle_turn *turn, double gate, double *out)
{
    const cycle_row *row = &w->r->row[k];
    const bool start = w->age == 0 || w->r->outlier[k];
    sensor_map changed;
    const sensor_map *sensors = &w->course.of[row->missing].middle;
    out[0] = out[1] = out[2] = 0.0;
    if (w->change) {
        changed =
            sensors_at(w->r, w->drive, &w->course, row, turn, w->before, start ? NULL : &w->x, &w->memory);
        sensors = &changed;
    }
    w->before = turn;
    double zero;
    const vec_ab seen_A = shown(w->drive, sensors, row, w->x, &zero);
    const vec_ab wrong = {row->i_A.alpha - seen_A.alpha, row->i_A.beta - seen_A.beta};
    const bool seen = !start && w->age >= OBSERVER_START;
    const sign_doubt doubt = w->doubt;
    if (w->drive->sign_is_doubted) {
        w->seen = unshown(w->drive, sensors, row);
        w->doubt = sign_doubt_of(w->r, row->missing, w->seen);
    }
    const bool out_of_gate =
        gate > 0.0 && seen && wrong.alpha * wrong.alpha + wrong.beta * wrong.beta > gate * gate;
    if (start || out_of_gate) {
        w->r->outlier[k] = out_of_gate ? 1 : w->r->outlier[k];
        w->x = unshown(w->drive, sensors, row);
        w->age = 1;
        return 0.0;
    }
    if (seen) {
        const vec_ab no = doubted(&doubt, wrong);
        out[0] = wrong.alpha - no.alpha;
        out[1] = wrong.beta - no.beta;
        out[2] = w->r->sensors == SENSORS_THREE ? row->i_zero_A - zero : 0.0;
    }
    /* After a start all samples so far have equal weight, until the steady gain is reached. */
    const double share = 1.0 / (double)(w->age + 1);
    const double g = share > w->gain ? share : w->gain;
    const vec_ab off = {sensors->back[0][0] * wrong.alpha + sensors->back[0][1] * wrong.beta,
                        sensors->back[1][0] * wrong.alpha + sensors->back[1][1] * wrong.beta};
    const vec_ab no = doubted(&doubt, off);
    w->x.alpha += g * off.alpha + (1.0 - g) * no.alpha;
    w->x.beta += g * off.beta + (1.0 - g) * no.beta;
    w->age++;
    return seen ? 1.0 - 0.5 * (doubt.along + doubt.across) : 0.0;
}

/* The current that decides a compensation in the cycle that begins. */
static vec_ab deciding(const walker *w)
{
    return w->drive->sign_is_doubted ? w->seen : w->x;
}

void observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                    const row_block *block, double gain, double gate, double *innovation, double *seen)
{
    walker w = walker_of(r, drive, gain);
    averaged_cycle cycle[2]; /* this row's, and that of the one before */
    for (size_t j = 0; j < block->count; j++) {
        const cycle_row *row = &r->row[block->first + j];
        averaged_cycle *own = &cycle[j % 2];
        *own = averaged_drive_cycle(drive, nodes, row, averaged_drive_rotor(drive, row));
        const double share =
            take_in(&w, block->first + j, &own->turn, gate, innovation + OBSERVER_OUTPUTS * j);
        if (seen != NULL) {
            seen[j] = share;
        }
        w.x = averaged_drive_pass(drive, own, row, w.x, deciding(&w), &w.memory.own);
    }
}

void observer_cycles(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                     const row_block *block, const averaged_cycle *same_rotor, averaged_cycle *cycle)
{
    for (size_t j = 0; j < block->count; j++) {
        const cycle_row *row = &r->row[block->first + j];
        const vec_rotor start = same_rotor ? same_rotor[j].turn.start : averaged_drive_rotor(drive, row);
        cycle[j] = averaged_drive_cycle(drive, nodes, row, start);
    }
}

void observer_through(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                      const row_block *block, double gain, double *innovation)
{
    walker w = walker_of(r, drive, gain);
    for (size_t j = 0; j < block->count; j++) {
        take_in(&w, block->first + j, &cycle[j].turn, 0.0, innovation + OBSERVER_OUTPUTS * j);
        w.x = averaged_drive_pass(drive, &cycle[j], &r->row[block->first + j], w.x, deciding(&w),
                                  &w.memory.own);
    }
}

/* Derivative of a cycle's end by its start, in the direction of `aside`. `sign`: the current that decides a compensation, or NULL. */
static vec_ab slope(const averaged_drive *drive, const averaged_cycle *cycle, const cycle_row *row,
                    const observer_step *s, vec_ab aside, const vec_ab *sign, const iron_memory *before)
{
    iron_memory memory = *before;
    const vec_ab from = {s->from_A.alpha + aside.alpha, s->from_A.beta + aside.beta};
    const vec_ab to = averaged_drive_pass(drive, cycle, row, from, sign ? *sign : from, &memory);
    const double by = aside.alpha + aside.beta;
    return (vec_ab){(to.alpha - s->to_A.alpha) / by, (to.beta - s->to_A.beta) / by};
}

void observer_way(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                  const row_block *block, double gain, double *innovation, observer_step *way)
{
    const double aside = 1e-5 * r->i_peak_A;
    walker w = walker_of(r, drive, gain);
    for (size_t j = 0; j < block->count; j++) {
        const cycle_row *row = &r->row[block->first + j];
        observer_step *s = &way[j];
        const vec_ab *sign = drive->sign_is_doubted ? &w.seen : NULL;
        take_in(&w, block->first + j, &cycle[j].turn, 0.0, innovation + OBSERVER_OUTPUTS * j);
        const iron_memory before = w.memory.own;
        s->from_A = w.x;
        s->to_A = w.x = averaged_drive_pass(drive, &cycle[j], row, w.x, deciding(&w), &w.memory.own);
        s->by_alpha = slope(drive, &cycle[j], row, s, (vec_ab){aside, 0.0}, sign, &before);
        s->by_beta = slope(drive, &cycle[j], row, s, (vec_ab){0.0, aside}, sign, &before);
    }
}

void observer_beside(diagnose_rows *r, const averaged_drive *drive, const averaged_cycle *cycle,
                     const row_block *block, double gain, const observer_step *way, double *innovation)
{
    walker w = walker_of(r, drive, gain);
    for (size_t j = 0; j < block->count; j++) {
        const observer_step *s = &way[j];
        take_in(&w, block->first + j, &cycle[j].turn, 0.0, innovation + OBSERVER_OUTPUTS * j);
        const vec_ab beside = {w.x.alpha - s->from_A.alpha, w.x.beta - s->from_A.beta};
        w.x.alpha = s->to_A.alpha + s->by_alpha.alpha * beside.alpha + s->by_beta.alpha * beside.beta;
        w.x.beta = s->to_A.beta + s->by_alpha.beta * beside.alpha + s->by_beta.beta * beside.beta;
    }
}

void observer_one_cycle(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                        size_t first, size_t count, vec_ab *wrong)
{
    const sensor_course course = sensor_course_of(drive, r->sensors);
    const bool change = sensors_change(drive, &course);
    lag_memory lag = {.own = {.row = NULL}};
    sensor_map sensors = sensors_at(r, drive, &course, &r->row[first], NULL, NULL, NULL, &lag);
    iron_memory memory = {.row = NULL};
    wrong[0] = (vec_ab){0.0, 0.0};
    for (size_t j = 1; j < count; j++) {
        const cycle_row *before = &r->row[first + j - 1];
        vec_ab x = unshown(drive, &sensors, before);
        double zero;
        x = averaged_drive_advance(drive, nodes, before, x, &memory);
        if (change) {
            sensors = sensors_at(r, drive, &course, before + 1, NULL, NULL, &x, &lag);
        }
        vec_ab seen = shown(drive, &sensors, before + 1, x, &zero);
        wrong[j].alpha = before[1].i_A.alpha - seen.alpha;
        wrong[j].beta = before[1].i_A.beta - seen.beta;
    }
}

void observer_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       size_t first, size_t count, vec_ab *current)
{
    const sensor_course course = sensor_course_of(drive, r->sensors);
    const bool change = sensors_change(drive, &course);
    lag_memory lag = {.own = {.row = NULL}};
    sensor_map sensors = sensors_at(r, drive, &course, &r->row[first], NULL, NULL, NULL, &lag);
    vec_ab x = unshown(drive, &sensors, &r->row[first]);
    iron_memory memory = {.row = NULL};
    for (size_t j = 0; j < count; j++) {
        if (change && j > 0) {
            sensors = sensors_at(r, drive, &course, &r->row[first + j], NULL, NULL, &x, &lag);
        }
        double zero;
        current[j] = shown(drive, &sensors, &r->row[first + j], x, &zero);
        x = averaged_drive_advance(drive, nodes, &r->row[first + j], x, &memory);
    }
}
