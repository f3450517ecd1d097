/* Which currents of a recording are measured (current_sensors.h). */
#include "current_sensors.h"

#include "../base/vector.h"

sensor_set current_sensors_of(const recording *rec, const pwm_updates *pwm)
{
    if (recording_three_sensors(rec)) {
        return SENSORS_THREE;
    }
    return pwm->two_lowest ? SENSORS_TWO_LOWEST : SENSORS_TWO;
}

/* The phase whose leg has the highest duty when row k is sampled: by the command of the row before, if there is one. */
static missing_phase highest_at(const recording *rec, const pwm_updates *pwm, size_t k, size_t history)
{
    const size_t acts = history > 0 ? k - 1 : k;
    double command[3];
    recording_voltage(rec, acts, command);
    const vec_ab last = pwm_updates_last(pwm, vec_from_phases(command), rec->omega_e_rad_s[acts] * rec->T_s);
    int highest = 0;
    for (int x = 1; x < 3; x++) {
        highest = vec_phase(last, x) > vec_phase(last, highest) ? x : highest;
    }
    return (missing_phase)((int)MISSING_A + highest);
}

missing_phase current_sensors_missing(const recording *rec, const pwm_updates *pwm, sensor_set sensors,
                                      size_t k, size_t history)
{
    switch (sensors) {
    case SENSORS_TWO:
        return MISSING_C;
    case SENSORS_TWO_LOWEST:
        return highest_at(rec, pwm, k, history);
    case SENSORS_THREE:
    default:
        return MISSING_NONE;
    }
}
