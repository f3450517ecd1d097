/* The averaged drive as an observer of a recording (observer.h). */
#include "observer.h"

#include "model/sensor_lag.h"

#include <math.h>
#include <string.h>

static bool sensors_change(const averaged_drive *drive)
{
    return averaged_drive_sensors_drift(drive) || drive->sensor_lag_s != 0.0;
}

/* The sensors at a row, where they are not the same at all. */
static sensor_map sensors_at(const diagnose_rows *r, const averaged_drive *drive, const cycle_row *row)
{
    const sensor_map map = averaged_drive_sensors(drive, r->two_sensors, row->elapsed_s);
    return drive->sensor_lag_s == 0.0 ? map : sensor_lag_map(drive, row, r->T_s, &map);
}

void observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                    const row_block *block, double gain, double gate, double *innovation, unsigned char *seen)
{
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors, 0.0);
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
            sensors = sensors_at(r, drive, row);
        }
        if (age == 0 || r->outlier[k]) {
            x = sensor_map_unmeasure(&sensors, row->i_A);
            age = 1;
        } else {
            vec_ab shown = sensor_map_measure(&sensors, x);
            vec_ab wrong = {row->i_A.alpha - shown.alpha, row->i_A.beta - shown.beta};
            if (gate > 0.0 && age >= OBSERVER_START &&
                wrong.alpha * wrong.alpha + wrong.beta * wrong.beta > gate * gate) {
                r->outlier[k] = 1;
                x = sensor_map_unmeasure(&sensors, row->i_A);
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
                        out[2] = row->i_zero_A - sensors.zero[0] * x.alpha - sensors.zero[1] * x.beta -
                                 sensors.zero_offset_A;
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
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors, 0.0);
    const bool change = sensors_change(drive);
    wrong[0] = (vec_ab){0.0, 0.0};
    for (size_t j = 1; j < count; j++) {
        const cycle_row *before = &r->row[first + j - 1];
        if (change) {
            sensors = sensors_at(r, drive, before);
        }
        vec_ab x = sensor_map_unmeasure(&sensors, before->i_A);
        if (change) {
            sensors = sensors_at(r, drive, before + 1);
        }
        vec_ab shown = sensor_map_measure(&sensors, averaged_drive_advance(drive, nodes, before, x));
        wrong[j].alpha = before[1].i_A.alpha - shown.alpha;
        wrong[j].beta = before[1].i_A.beta - shown.beta;
    }
}

void observer_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       size_t first, size_t count, vec_ab *current)
{
    const bool change = sensors_change(drive);
    sensor_map sensors = sensors_at(r, drive, &r->row[first]);
    vec_ab x = sensor_map_unmeasure(&sensors, r->row[first].i_A);
    for (size_t j = 0; j < count; j++) {
        if (change) {
            sensors = sensors_at(r, drive, &r->row[first + j]);
        }
        current[j] = sensor_map_measure(&sensors, x);
        x = averaged_drive_advance(drive, nodes, &r->row[first + j], x);
    }
}
