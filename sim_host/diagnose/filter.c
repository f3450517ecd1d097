#include "filter.h"

#include <math.h>
#include <string.h>

void filter_block(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                  const row_block *block, double gain, double gate, double *innovation)
{
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors);
    vector_ab x = {0.0, 0.0};
    size_t age = 0; /* rows since the filter started */
    memset(innovation, 0, FILTER_OUTPUTS * block->count * sizeof *innovation);
    for (size_t j = 0; j < block->count; j++) {
        size_t k = block->first + j;
        const drive_row *row = &r->row[k];
        if (age == 0 || r->outlier[k]) {
            x = sensor_map_unmeasure(&sensors, row->i_A);
            age = 1;
        } else {
            vector_ab shown = sensor_map_measure(&sensors, x);
            vector_ab wrong = {row->i_A.a - shown.a, row->i_A.b - shown.b};
            if (gate > 0.0 && age >= FILTER_START && wrong.a * wrong.a + wrong.b * wrong.b > gate * gate) {
                r->outlier[k] = 1;
                x = sensor_map_unmeasure(&sensors, row->i_A);
                age = 1;
            } else {
                if (age >= FILTER_START) {
                    double *out = innovation + FILTER_OUTPUTS * j;
                    out[0] = wrong.a;
                    out[1] = wrong.b;
                    if (!r->two_sensors) {
                        out[2] = row->i_zero_A - sensors.zero[0] * x.a - sensors.zero[1] * x.b -
                                 sensors.zero_offset_A;
                    }
                }
                /* As if every sample so far counted alike, until the steady gain is reached. */
                double share = 1.0 / (double)(age + 1);
                double g = share > gain ? share : gain;
                x.a += g * (sensors.back[0][0] * wrong.a + sensors.back[0][1] * wrong.b);
                x.b += g * (sensors.back[1][0] * wrong.a + sensors.back[1][1] * wrong.b);
                age++;
            }
        }
        x = averaged_drive_advance(drive, nodes, row, x);
    }
}

void filter_one_cycle(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                      size_t first, size_t count, vector_ab *wrong)
{
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors);
    wrong[0] = (vector_ab){0.0, 0.0};
    for (size_t j = 1; j < count; j++) {
        const drive_row *before = &r->row[first + j - 1];
        vector_ab x = sensor_map_unmeasure(&sensors, before->i_A);
        vector_ab shown = sensor_map_measure(&sensors, averaged_drive_advance(drive, nodes, before, x));
        wrong[j].a = before[1].i_A.a - shown.a;
        wrong[j].b = before[1].i_A.b - shown.b;
    }
}

void filter_free_run(const diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                     size_t first, size_t count, vector_ab *current)
{
    sensor_map sensors = averaged_drive_sensors(drive, r->two_sensors);
    vector_ab x = sensor_map_unmeasure(&sensors, r->row[first].i_A);
    for (size_t j = 0; j < count; j++) {
        current[j] = sensor_map_measure(&sensors, x);
        x = averaged_drive_advance(drive, nodes, &r->row[first + j], x);
    }
}
