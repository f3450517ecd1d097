/* A motor's flux map for the firmware (firmware_map.h). */
#include "firmware_map.h"

#include "model/flux_parts.h"

#include "iqfoc/extension_params.h"

#include <math.h>

/* A second part stays if it takes this share of the error. */
static const double SECOND_TAKES = 0.1;

/* Limits lie within the library's ranges by this share, so that no rounding leaves them. */
static const double INSIDE = 1.0 - 1e-3;

static flux_parts_limits limits_of(const per_unit *b)
{
    const double flux_Wb = b->T_s * b->U_V;
    return (flux_parts_limits){.L_low_H = IQFOC_MIN_MAP_L / INSIDE * flux_Wb / b->I_A,
                               .L_high_H = IQFOC_MAX_FLUX_L * INSIDE * flux_Wb / b->I_A,
                               .E_high_J = IQFOC_MAX_MAP_E * INSIDE * flux_Wb * b->I_A,
                               .I_low_A = b->I_A / (IQFOC_MAX_MAP_K * INSIDE),
                               .I_high_A = b->I_A / IQFOC_MIN_MAP_K * INSIDE,
                               .I_c_high_A = b->I_A * IQFOC_MAX_MAP_X / IQFOC_MAX_MAP_K * INSIDE};
}

/* Some of the recorded currents, in the rotor frame, and how many. */
static size_t currents_of(const recording *rec, const motor *m, vec_dq i[FLUX_PARTS_CURRENTS])
{
    const size_t count = rec->rows < FLUX_PARTS_CURRENTS ? rec->rows : FLUX_PARTS_CURRENTS;
    for (size_t k = 0; k < count; k++) {
        const size_t row = k * rec->rows / count;
        i[k] = vec_to_dq(recording_current(rec, row), rotor_at(rec->theta_e_rad[row] - m->ext.theta_0_rad));
    }
    return count;
}

/* Takes the parts of a drive if the library holds them. */
static bool hold(const motor *m, const averaged_drive *parts, double off, firmware_map *f)
{
    error e = {0};
    const motor other = averaged_drive_motor(parts, m);
    f->fitted = true;
    f->off = off;
    f->values = flux_map_values_of(&other);
    f->there = isfinite(off) && flux_map_from_motor(&other, &f->map, &e);
    return f->there;
}

firmware_map firmware_map_of(const recording *rec, const motor *m)
{
    const firmware_map none = {.there = false};
    firmware_map f = none;
    error e = {0};
    if (!m->ext.has[CAUSE_SATURATION_DQ]) {
        return none;
    }
    f.values = flux_map_values_of(m);
    f.there = motor_has_parts_alone(m) && flux_map_from_motor(m, &f.map, &e);
    if (f.there) {
        return f;
    }
    vec_dq i[FLUX_PARTS_CURRENTS];
    averaged_drive one;
    averaged_drive two;
    const size_t count = currents_of(rec, m, i);
    const averaged_drive drive = averaged_drive_of(m);
    const per_unit b = per_unit_of(m);
    const flux_parts_limits limits = limits_of(&b);
    const double by_one = flux_parts_closest(&drive, i, count, &limits, 1, &one);
    const double by_two = flux_parts_closest(&drive, i, count, &limits, 2, &two);
    return (by_two < (1.0 - SECOND_TAKES) * by_one && hold(m, &two, by_two, &f)) || hold(m, &one, by_one, &f)
               ? f
               : none;
}

cause_firmware firmware_correction(const firmware_map *map, cause_id id)
{
    return id == CAUSE_SATURATION_DQ && map->there ? FIRMWARE_HOLDS : cause_table[id].firmware;
}
