/* Gains and offsets of current sensors, and their drift (sensor_chain.h). */
#include "sensor_chain.h"

static bool sensors_drift(const averaged_drive *d)
{
    return d->offset_rate_ab_A_s[0] != 0.0 || d->offset_rate_ab_A_s[1] != 0.0 || d->g_rate_s[0] != 0.0 ||
           d->g_rate_s[1] != 0.0 || d->g_rate_s[2] != 0.0;
}

/* What gains make of a true current and of the three's mean. */
static void chain_of(const double g[3], bool two_sensors, double forward[2][2], double zero[2])
{
    for (size_t column = 0; column < 2; column++) {
        double i[3];
        vec_to_phases((vec_ab){column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0}, i);
        for (size_t x = 0; x < 3; x++) {
            i[x] *= g[x];
        }
        zero[column] = (i[0] + i[1] + i[2]) / 3.0;
        if (two_sensors) {
            i[2] = -i[0] - i[1];
        }
        const vec_ab v = vec_from_phases(i);
        forward[0][column] = v.alpha;
        forward[1][column] = v.beta;
    }
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

sensor_course sensor_course_of(const averaged_drive *d, bool two_sensors)
{
    sensor_course c = {.drifts = sensors_drift(d)};
    c.middle.offset = (vec_ab){d->offset_ab_A[0], d->offset_ab_A[1]};
    c.middle.zero_offset_A = d->offset_zero_A;
    chain_of(d->g, two_sensors, c.middle.forward, c.middle.zero);
    find_back(&c.middle);
    c.offset_rate = (vec_ab){d->offset_rate_ab_A_s[0], d->offset_rate_ab_A_s[1]};
    chain_of(d->g_rate_s, two_sensors, c.forward_rate, c.zero_rate);
    return c;
}

sensor_map sensor_course_at(const sensor_course *c, double elapsed_s)
{
    sensor_map map = c->middle;
    if (!c->drifts) {
        return map;
    }
    for (size_t column = 0; column < 2; column++) {
        map.zero[column] += c->zero_rate[column] * elapsed_s;
        map.forward[0][column] += c->forward_rate[0][column] * elapsed_s;
        map.forward[1][column] += c->forward_rate[1][column] * elapsed_s;
    }
    map.offset.alpha += c->offset_rate.alpha * elapsed_s;
    map.offset.beta += c->offset_rate.beta * elapsed_s;
    find_back(&map);
    return map;
}

sensor_map sensor_map_of(const averaged_drive *d, bool two_sensors, double elapsed_s)
{
    const sensor_course c = sensor_course_of(d, two_sensors);
    return sensor_course_at(&c, elapsed_s);
}
