/* The averaged drive as an observer of a recording (observer.h). */
#include "observer.h"

#include <math.h>
#include <string.h>

void observer_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                    const row_block *block, double gain, double gate, double *innovation, unsigned char *seen)
{
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors, 0.0);
    const bool drift = averaged_drive_sensors_drift(drive);
    vec_ab x = {0.0, 0.0};
    size_t age = 0; /* rows since the filter started */
    memset(innovation, 0, OBSERVER_OUTPUTS * block->count * sizeof *innovation);
    if (seen != NULL) {
        memset(seen, 0, block->count);
    }
    for (size_t j = 0; j < block->count; j++) {
        size_t k = block->first + j;
        const cycle_row *row = &r->row[k];
        if (drift) {
            sensors = averaged_drive_sensors(drive, r->two_sensors, row->elapsed_s);
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
    const bool drift = averaged_drive_sensors_drift(drive);
    wrong[0] = (vec_ab){0.0, 0.0};
    for (size_t j = 1; j < count; j++) {
        const cycle_row *before = &r->row[first + j - 1];
        if (drift) {
            sensors = averaged_drive_sensors(drive, r->two_sensors, before->elapsed_s);
        }
        vec_ab x = sensor_map_unmeasure(&sensors, before->i_A);
        vec_ab shown = sensor_map_measure(&sensors, averaged_drive_advance(drive, nodes, before, x));
        wrong[j].alpha = before[1].i_A.alpha - shown.alpha;
        wrong[j].beta = before[1].i_A.beta - shown.beta;
    }
}

void observer_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                       size_t first, size_t count, vec_ab *current)
{
    const bool drift = averaged_drive_sensors_drift(drive);
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors, r->row[first].elapsed_s);
    vec_ab x = sensor_map_unmeasure(&sensors, r->row[first].i_A);
    for (size_t j = 0; j < count; j++) {
        if (drift) {
            sensors = averaged_drive_sensors(drive, r->two_sensors, r->row[first + j].elapsed_s);
        }
        current[j] = sensor_map_measure(&sensors, x);
        x = averaged_drive_advance(drive, nodes, &r->row[first + j], x);
    }
}
