/* Gains and offsets of current sensors, and their drift (sensor_chain.h). */
#include "sensor_chain.h"

static bool sensors_drift(const averaged_drive *d)
{
    return d->offset_rate_ab_A_s[0] != 0.0 || d->offset_rate_ab_A_s[1] != 0.0 || d->g_rate_s[0] != 0.0 ||
           d->g_rate_s[1] != 0.0 || d->g_rate_s[2] != 0.0;
}

/* What gains and crosstalk make of a true current and of the three's mean. */
static void chain_of(const double g[3], const double crosstalk[3], missing_phase missing,
                     double forward[2][2], double zero[2])
{
    for (size_t column = 0; column < 2; column++) {
        double is[3];
        double i[3];
        vec_to_phases((vec_ab){column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0}, is);
        for (size_t x = 0; x < 3; x++) {
            i[x] = g[x] * is[x] + crosstalk[(x + 2) % 3] * is[(x + 2) % 3];
        }
        zero[column] = (i[0] + i[1] + i[2]) / 3.0;
        current_sensors_leave_out(missing, i);
        const vec_ab v = vec_from_phases(i);
        forward[0][column] = v.alpha;
        forward[1][column] = v.beta;
    }
}

/* What offsets of the phases make of the vector. */
static vec_ab offset_of(const double ab[2], double mean, missing_phase missing)
{
    double o[3];
    if (missing == MISSING_NONE) {
        return (vec_ab){ab[0], ab[1]}; /* what they have in common adds nothing */
    }
    vec_to_phases((vec_ab){ab[0], ab[1]}, o);
    for (size_t x = 0; x < 3; x++) {
        o[x] += mean;
    }
    current_sensors_leave_out(missing, o);
    return vec_from_phases(o);
}

static void find_back(sensor_map *map)
{
    const double per_det =
        1.0 / (map->forward[0][0] * map->forward[1][1] - map->forward[0][1] * map->forward[1][0]);
    map->back[0][0] = map->forward[1][1] * per_det;
    map->back[0][1] = -map->forward[0][1] * per_det;
    map->back[1][0] = -map->forward[1][0] * per_det;
    map->back[1][1] = map->forward[0][0] * per_det;
}

sensor_map sensor_map_of(const averaged_drive *d, missing_phase missing)
{
    sensor_map map;
    map.offset = offset_of(d->offset_ab_A, d->offset_zero_A, missing);
    map.zero_offset_A = d->offset_zero_A;
    chain_of(d->g, d->crosstalk, missing, map.forward, map.zero);
    find_back(&map);
    return map;
}

sensor_course sensor_course_of(const averaged_drive *d, sensor_set sensors)
{
    static const missing_phase first[] = {
        [SENSORS_THREE] = MISSING_NONE, [SENSORS_TWO] = MISSING_C, [SENSORS_TWO_LOWEST] = MISSING_A};
    const int last = sensors == SENSORS_THREE ? MISSING_NONE : MISSING_C;
    static const double none[3] = {0.0, 0.0, 0.0};
    sensor_course c;
    c.drifts = sensors_drift(d);
    c.changes = c.drifts || sensors == SENSORS_TWO_LOWEST;
    for (int x = (int)first[sensors]; x <= last; x++) {
        const missing_phase missing = (missing_phase)x;
        sensor_drift *of = &c.of[x];
        of->middle = sensor_map_of(d, missing);
        if (c.drifts) {
            of->offset_rate = offset_of(d->offset_rate_ab_A_s, 0.0, missing);
            chain_of(d->g_rate_s, none, missing, of->forward_rate, of->zero_rate);
        }
    }
    return c;
}

sensor_map sensor_course_at(const sensor_course *c, const cycle_row *row)
{
    const sensor_drift *of = &c->of[row->missing];
    sensor_map map = of->middle;
    if (!c->drifts) {
        return map;
    }
    for (size_t column = 0; column < 2; column++) {
        map.zero[column] += of->zero_rate[column] * row->elapsed_s;
        map.forward[0][column] += of->forward_rate[0][column] * row->elapsed_s;
        map.forward[1][column] += of->forward_rate[1][column] * row->elapsed_s;
    }
    map.offset.alpha += of->offset_rate.alpha * row->elapsed_s;
    map.offset.beta += of->offset_rate.beta * row->elapsed_s;
    find_back(&map);
    return map;
}
