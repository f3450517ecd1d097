/* Coordinates around the motor file (coordinates.h). */
#include "coordinates.h"

#include <math.h>
#include <string.h>

const coordinate coordinate_table[P_COUNT] = {
#define COORDINATE(P, member, ...) [P] = {.offset = offsetof(averaged_drive, member), __VA_ARGS__},
#include "data/causes.def"
};

static double value_of(const averaged_drive *d, coordinate_id id)
{
    double value;
    memcpy(&value, (const unsigned char *)d + coordinate_table[id].offset, sizeof value);
    return value;
}

static void set_value(averaged_drive *d, coordinate_id id, double value)
{
    memcpy((unsigned char *)d + coordinate_table[id].offset, &value, sizeof value);
}

static double scale_of(const coordinate_frame *f, coordinate_id id)
{
    return f->scale[coordinate_table[id].scale];
}

coordinate_frame coordinates_of(const motor *m, const diagnose_rows *r)
{
    coordinate_frame f = {.motor = m, .nominal = averaged_drive_of(m), .pole_pairs = m->pole_pairs};
    const averaged_drive *d = &f.nominal;
    const double L = 0.5 * (d->L_d_H + d->L_q_H);
    const double I = motor_rated_peak_A(m);
    const double psi = d->psi_f_Wb > 0.0 ? d->psi_f_Wb : L * I;
    /* A file may say R = 0: then what counts as much is a hundredth of L/T. */
    const double R = fmax(d->R_ohm, 0.01 * L / r->T_s);
    const double iron = 0.01 * I / (fmax(r->omega_max_rad_s, 1.0) * psi);
    const double scale[SCALE_COUNT] = {[SCALE_ONE] = 1.0,
                                       [SCALE_R] = R,
                                       [SCALE_L] = L,
                                       [SCALE_PSI] = psi,
                                       [SCALE_CURRENT] = I,
                                       [SCALE_PER_SQUARE] = 1.0 / (I * I),
                                       [SCALE_LINK] = 0.01 * m->u_dc_V,
                                       [SCALE_CYCLE] = r->T_s,
                                       [SCALE_IRON] = iron,
                                       [SCALE_IRON_LATE] = iron * r->T_s,
                                       [SCALE_PSI_PERCENT] = 0.01 * psi,
                                       [SCALE_R_PERCENT] = 0.01 * R,
                                       [SCALE_RATE] = 1.0 / r->span_s,
                                       [SCALE_R_RATE] = R / r->span_s,
                                       [SCALE_PSI_RATE] = psi / r->span_s,
                                       [SCALE_CURRENT_RATE] = I / r->span_s};
    memcpy(f.scale, scale, sizeof scale);
    f.i_rated_peak_A = I;
    return f;
}

averaged_drive coordinates_drive(const coordinate_frame *f, const double z[P_COUNT], edge_law edge)
{
    averaged_drive d = f->nominal;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        if (z[id] != 0.0) {
            const double nominal = value_of(&f->nominal, id);
            set_value(&d, id,
                      coordinate_table[id].logarithmic ? nominal * exp(z[id])
                                                       : nominal + z[id] * scale_of(f, id));
        }
    }
    /* A dead time that the file states is that of the plain law; one that is fitted chooses. */
    if (f->nominal.v_dead_V == 0.0 || z[P_V_DEAD] != 0.0) {
        d.edge = edge;
    }
    return d;
}

double coordinate_step(coordinate_id id)
{
    return coordinate_table[id].step > 0.0 ? coordinate_table[id].step : COORDINATE_STEP;
}

/* Where in z a value lies. */
static double z_of(const coordinate_frame *f, coordinate_id id, double value)
{
    const double nominal = value_of(&f->nominal, id);
    if (coordinate_table[id].logarithmic) {
        return log(value / nominal);
    }
    return (value - nominal) / scale_of(f, id);
}

void coordinates_bound(const coordinate_frame *f, double z[P_COUNT])
{
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        const coordinate *c = &coordinate_table[id];
        double low = c->low;
        double high = c->high;
        if (c->bound == BOUND_NONE) {
            continue;
        }
        if (c->bound != BOUND_OF_Z) {
            const double of = c->bound == BOUND_OF_RATED ? f->i_rated_peak_A : value_of(&f->nominal, id);
            low = z_of(f, id, low * of);
            high = isinf(high) ? INFINITY : z_of(f, id, high * of);
        }
        z[id] = fmin(fmax(z[id], low), high);
    }
}
