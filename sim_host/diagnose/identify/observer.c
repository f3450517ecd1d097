/* The averaged drive as an observer of a recording (observer.h). */
#include "observer.h"

#include "model/sensor_bend.h"
#include "model/sensor_lag.h"

#include <math.h>
#include <string.h>

static bool sensors_change(const averaged_drive *drive)
{
    return averaged_drive_sensors_drift(drive) || drive->sensor_lag_s != 0.0;
}

/* The sensors at a row, where they are not the same at all; `steady` at the recording's beginning. */
static sensor_map sensors_at(const diagnose_rows *r, const averaged_drive *drive, const sensor_map *steady,
                             const cycle_row *row)
{
    const sensor_map map = averaged_drive_sensors_drift(drive)
                               ? averaged_drive_sensors(drive, r->two_sensors, row->elapsed_s)
                               : *steady;
    return drive->sensor_lag_s == 0.0 ? map : sensor_lag_map(drive, row, r->T_s, &map);
}

/* What the sensors show of a true current; *zero: the mean of the three. */
static vec_ab shown(const averaged_drive *drive, const sensor_map *map, vec_ab x, double *zero)
{
    vec_ab y = sensor_map_measure(map, x);
    *zero = map->zero[0] * x.alpha + map->zero[1] * x.beta + map->zero_offset_A;
    if (sensor_bend_is_there(drive)) {
        double more_zero;
        const vec_ab more = sensor_bend_more(drive, y, &more_zero);
        y = (vec_ab){y.alpha + more.alpha, y.beta + more.beta};
        *zero += more_zero;
    }
    return y;
}

static vec_ab unshown(const averaged_drive *drive, const sensor_map *map, vec_ab recorded)
{
    const bool bent = sensor_bend_is_there(drive);
    return sensor_map_unmeasure(map, bent ? sensor_bend_undo(drive, recorded) : recorded);
}

void observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                    const row_block *block, double gain, double gate, double *innovation, unsigned char *seen)
{
    const sensor_map steady = averaged_drive_sensors(drive, r->two_sensors, 0.0);
    sensor_map sensors = steady;
    const bool change = sensors_change(drive);
    vec_ab x = {0.0, 0.0};
    size_t age = 0; /* rows since the filter started */
    memset(innovation, 0, OBSERVER_OUTPUTS * block->count * sizeof *innovation);
    if (seen != NULL) {
        memset(seen, 0, block->count);
    }
    for (size_t j = 0; j < block->count; j++) {
        size_t k = block->first + j;
        const cycle_row *row = &r->row[k];
        if (change) {
            sensors = sensors_at(r, drive, &steady, row);
        }
        if (age == 0 || r->outlier[k]) {
            x = unshown(drive, &sensors, row->i_A);
            age = 1;
        } else {
            double zero;
            vec_ab seen_A = shown(drive, &sensors, x, &zero);
            vec_ab wrong = {row->i_A.alpha - seen_A.alpha, row->i_A.beta - seen_A.beta};
            if (gate > 0.0 && age >= OBSERVER_START &&
                wrong.alpha * wrong.alpha + wrong.beta * wrong.beta > gate * gate) {
                r->outlier[k] = 1;
                x = unshown(drive, &sensors, row->i_A);
                age = 1;
            } else {
                if (age >= OBSERVER_START) {
                    double *out = innovation + OBSERVER_OUTPUTS * j;
                    if (seen != NULL) {
                        seen[j] = 1;
                    }
                    out[0] = wrong.alpha;
                    out[1] = wrong.beta;
                    if (!r->two_sensors) {
                        out[2] = row->i_zero_A - zero;
                    }
                }
                /* As if every sample so far counted alike, until the steady gain is reached. */
                double share = 1.0 / (double)(age + 1);
                double g = share > gain ? share : gain;
                x.alpha += g * (sensors.back[0][0] * wrong.alpha + sensors.back[0][1] * wrong.beta);
                x.beta += g * (sensors.back[1][0] * wrong.alpha + sensors.back[1][1] * wrong.beta);
                age++;
            }
        }
        x = averaged_drive_advance(drive, nodes, row, x);
    }
}

void observer_one_cycle(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                        size_t first, size_t count, vec_ab *wrong)
{
    const sensor_map steady = averaged_drive_sensors(drive, r->two_sensors, 0.0);
    sensor_map sensors = steady;
    const bool change = sensors_change(drive);
    wrong[0] = (vec_ab){0.0, 0.0};
    for (size_t j = 1; j < count; j++) {
        const cycle_row *before = &r->row[first + j - 1];
        if (change) {
            sensors = sensors_at(r, drive, &steady, before);
        }
        vec_ab x = unshown(drive, &sensors, before->i_A);
        if (change) {
            sensors = sensors_at(r, drive, &steady, before + 1);
        }
        double zero;
        vec_ab seen = shown(drive, &sensors, averaged_drive_advance(drive, nodes, before, x), &zero);
        wrong[j].alpha = before[1].i_A.alpha - seen.alpha;
        wrong[j].beta = before[1].i_A.beta - seen.beta;
    }
}

void observer_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       size_t first, size_t count, vec_ab *current)
{
    const bool change = sensors_change(drive);
    const sensor_map steady = averaged_drive_sensors(drive, r->two_sensors, 0.0);
    sensor_map sensors = sensors_at(r, drive, &steady, &r->row[first]);
    vec_ab x = unshown(drive, &sensors, r->row[first].i_A);
    for (size_t j = 0; j < count; j++) {
        if (change) {
            sensors = sensors_at(r, drive, &steady, &r->row[first + j]);
        }
        double zero;
        current[j] = shown(drive, &sensors, x, &zero);
        x = averaged_drive_advance(drive, nodes, &r->row[first + j], x);
    }
}
