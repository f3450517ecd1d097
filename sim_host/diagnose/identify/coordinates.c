/* Coordinates around the motor file (coordinates.h). */
#include "coordinates.h"

#include "model/flux_map.h"
#include "model/flux_parts.h"

#include <math.h>
#include <string.h>

const coordinate coordinate_table[P_COUNT] = {
#define COORDINATE(P, member, ...) [P] = {.offset = offsetof(averaged_drive, member), __VA_ARGS__},
#include "data/causes.def"
};

double coordinate_value(const averaged_drive *d, coordinate_id id)
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

static void find_reach(coordinate_frame *f, const diagnose_rows *r)
{
    for (size_t b = 0; b < r->blocks; b++) {
        for (size_t k = r->block[b].first; k < r->block[b].first + r->block[b].count; k++) {
            const vec_dq i = vec_to_dq(r->row[k].i_A, (vec_rotor){r->row[k].cos_theta, r->row[k].sin_theta});
            const double turn = atan2(i.q, i.d) / VEC_TWO_PI + 0.5;
            vec_dq *most = &f->reach_A[(size_t)(turn * COORDINATE_DIRECTIONS) % COORDINATE_DIRECTIONS];
            if (i.d * i.d + i.q * i.q > most->d * most->d + most->q * most->q) {
                *most = i;
            }
        }
    }
}

/* In deviations of the noise: what a compensation of the wrong sign must move its phase's current by in a cycle. */
static const double SEEN_THROUGH_NOISE = 2.0;

void coordinates_doubt(coordinate_frame *f, const diagnose_rows *r)
{
    /* Twice the compensation is wrong, and a phase sees two thirds of its leg. */
    f->doubted_V_H = SEEN_THROUGH_NOISE * 0.75 * r->noise_A / r->T_s;
}

coordinate_frame coordinates_of(const motor *m, const diagnose_rows *r)
{
    coordinate_frame f = {
        .motor = m, .nominal = averaged_drive_of(m), .pole_pairs = m->pole_pairs, .of_least = 1.0};
    const averaged_drive *d = &f.nominal;
    coordinates_doubt(&f, r);
    const double L = 0.5 * (d->L_d_H + d->L_q_H);
    const double I = motor_rated_peak_A(m);
    const double psi = d->psi_f_Wb > 0.0 ? d->psi_f_Wb : L * I;
    /* The motor file may have R = 0: the unit is at least 1 % of L/T. */
    const double R = fmax(d->R_ohm, 0.01 * L / r->T_s);
    const double iron = 0.01 * I / (fmax(r->omega_max_rad_s, 1.0) * psi);
    const double fe = 0.01 * I / fmax(fmax(r->omega_max_rad_s * psi, r->u_rms_V), 1e-3 * m->u_dc_V);
    const double scale[SCALE_COUNT] = {[SCALE_ONE] = 1.0,
                                       [SCALE_R] = R,
                                       [SCALE_L] = L,
                                       [SCALE_PSI] = psi,
                                       [SCALE_CURRENT] = I,
                                       [SCALE_PER_SQUARE] = 1.0 / (I * I),
                                       [SCALE_MAP_THIRD] = L / (3.0 * I),
                                       [SCALE_MAP_FOURTH] = L / (4.0 * I * I),
                                       [SCALE_MAP_ENERGY] = L * I * I,
                                       [SCALE_LINK] = 0.01 * m->u_dc_V,
                                       [SCALE_CYCLE] = r->T_s,
                                       [SCALE_IRON] = iron,
                                       [SCALE_FE] = fe,
                                       [SCALE_IRON_LATE] = iron * r->T_s,
                                       [SCALE_PERCENT] = 0.01,
                                       [SCALE_RATE] = 1.0 / r->span_s,
                                       [SCALE_R_RATE] = R / r->span_s,
                                       [SCALE_PSI_RATE] = psi / r->span_s,
                                       [SCALE_CURRENT_RATE] = I / r->span_s};
    memcpy(f.scale, scale, sizeof scale);
    f.i_rated_peak_A = I;
    find_reach(&f, r);
    return f;
}

averaged_drive coordinates_drive(const coordinate_frame *f, const double z[P_COUNT], edge_law edge)
{
    averaged_drive d = f->nominal;
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        if (z[id] != 0.0) {
            const double nominal = coordinate_value(&f->nominal, id);
            set_value(&d, id,
                      coordinate_table[id].logarithmic ? nominal * exp(z[id])
                                                       : nominal + z[id] * scale_of(f, id));
        }
    }
    /* A dead time that only the motor file states keeps the file's edge model. */
    if (!averaged_drive_loses(&f->nominal) || z[P_V_DEAD] != 0.0 || z[P_COMPENSATION] != 0.0) {
        d.edge = edge;
    }
    d.sign_is_doubted = fabs(d.compensation_V) > f->doubted_V_H * 0.5 * (d.L_d_H + d.L_q_H);
    return d;
}

/* As wide as the tolerance of a parameter: a dead time's edges have kinks, which a narrow difference takes for slopes. */
double coordinate_step(coordinate_id id)
{
    const coordinate *c = &coordinate_table[id];
    return c->step > 0.0 ? c->step : c->digits > 0.0 ? c->digits : COORDINATE_STEP;
}

double coordinate_look(coordinate_id id, double z)
{
    const double first = coordinate_table[id].first_step;
    return z == 0.0 && first > 0.0 ? first : coordinate_step(id);
}

/* The z of a value. */
static double z_of(const coordinate_frame *f, coordinate_id id, double value)
{
    const double nominal = coordinate_value(&f->nominal, id);
    if (coordinate_table[id].logarithmic) {
        return log(value / nominal);
    }
    return (value - nominal) / scale_of(f, id);
}

double coordinates_to_file(const coordinate_frame *f, coordinate_id id, const double z[P_COUNT])
{
    const averaged_drive d = coordinates_drive(f, z, EDGE_CHARGED);
    return coordinate_value(&f->nominal, id) / coordinate_value(&d, id);
}

/* Least incremental inductance of a flux map at the recorded currents, as a share of the smaller inductance at zero current. */
static const double LEAST_INCREMENTAL = 0.02;

static bool map_is_physical(const coordinate_frame *f, const double z[P_COUNT])
{
    const averaged_drive d = coordinates_drive(f, z, EDGE_CHARGED);
    bool physical = flux_map_is_convex(&d, LEAST_INCREMENTAL);
    for (size_t n = 0; n < COORDINATE_DIRECTIONS; n++) {
        const vec_dq i = f->reach_A[n];
        physical = physical && flux_map_is_physical(&d, i, LEAST_INCREMENTAL) &&
                   flux_map_is_physical(&d, (vec_dq){0.5 * i.d, 0.5 * i.q}, LEAST_INCREMENTAL);
    }
    return physical;
}

double coordinates_flux_lost(const coordinate_frame *f, const double z[P_COUNT])
{
    const averaged_drive d = coordinates_drive(f, z, EDGE_CHARGED);
    double most = 0.0;
    for (size_t n = 0; n < COORDINATE_DIRECTIONS; n++) {
        const vec_dq i = f->reach_A[n];
        const vec_dq straight = {d.L_d_H * i.d, d.L_q_H * i.q};
        const vec_dq flux = flux_map_flux(&d, i);
        const double lost = hypot(flux.d - straight.d, flux.q - straight.q);
        most = lost > 0.0 ? fmax(most, lost / hypot(straight.d, straight.q)) : most;
    }
    return most;
}

/* Of parts that take a flux: the most energy in L I^2, and by how much a current at which one saturates differs from the rated one. */
static const double MOST_ENERGY = 30.0;
static const double MOST_WIDTH = 9.0;

void coordinates_take_parts(const coordinate_frame *f, const double from[P_COUNT], double to[P_COUNT])
{
    enum { SHARES = 3 };
    static const coordinate_id of[] = {P_L_D,      P_L_Q,    P_IRON_1,   P_IRON_1_D, P_IRON_1_Q,
                                       P_IRON_1_C, P_IRON_2, P_IRON_2_D, P_IRON_2_Q, P_IRON_2_C};
    const averaged_drive drive = coordinates_drive(f, from, EDGE_CHARGED);
    const double I_A = f->i_rated_peak_A;
    const double L_H = fmax(drive.L_d_H, drive.L_q_H);
    const flux_parts_limits limits = {.L_low_H = LEAST_INCREMENTAL * fmin(drive.L_d_H, drive.L_q_H),
                                      .L_high_H = L_H,
                                      .E_high_J = MOST_ENERGY * L_H * I_A * I_A,
                                      .I_low_A = I_A / MOST_WIDTH,
                                      .I_high_A = I_A * MOST_WIDTH,
                                      .I_c_high_A = drive.psi_f_Wb > 0.0 ? I_A : 0.0};
    vec_dq i[SHARES * COORDINATE_DIRECTIONS];
    size_t count = 0;
    for (size_t n = 0; n < COORDINATE_DIRECTIONS; n++) {
        const vec_dq most = f->reach_A[n];
        for (int k = 1; k <= SHARES && (most.d != 0.0 || most.q != 0.0); k++) {
            i[count++] = (vec_dq){most.d * k / SHARES, most.q * k / SHARES};
        }
    }
    averaged_drive other;
    (void)flux_parts_closest(&drive, i, count, &limits, IRON_PARTS, &other);
    for (size_t n = 0; n < sizeof of / sizeof *of; n++) {
        to[of[n]] = z_of(f, of[n], coordinate_value(&other, of[n]));
    }
}

/* Reduces the terms of a flux map, by as little as possible, until it is physical. Without them it is. */
static void bound_map(const coordinate_frame *f, double z[P_COUNT])
{
    static const coordinate_id term[] = {P_W_DDD,  P_W_DQQ,      P_W_DDDD, P_W_DDQQ,
                                         P_W_QQQQ, P_SATURATION, P_IRON_1, P_IRON_2};
    enum { TERMS = sizeof term / sizeof *term, HALVINGS = 12 };
    double moved[TERMS];
    double low = 0.0;
    double high = 1.0;
    bool any = false;
    for (size_t t = 0; t < TERMS; t++) {
        moved[t] = z[term[t]];
        any = any || (moved[t] != 0.0 && term[t] != P_SATURATION);
    }
    if (!any || map_is_physical(f, z)) {
        return;
    }
    for (int n = 0; n <= HALVINGS; n++) {
        const double share = n == HALVINGS ? low : 0.5 * (low + high);
        for (size_t t = 0; t < TERMS; t++) {
            z[term[t]] = share * moved[t];
        }
        if (map_is_physical(f, z)) {
            low = share;
        } else {
            high = share;
        }
    }
}

void coordinate_range(const coordinate_frame *f, coordinate_id id, double *low, double *high)
{
    const coordinate *c = &coordinate_table[id];
    *low = c->bound == BOUND_NONE ? -INFINITY : c->low;
    *high = c->bound == BOUND_NONE ? INFINITY : c->high;
    if (c->bound == BOUND_OF_RATED || c->bound == BOUND_OF_NOMINAL) {
        const double of = c->bound == BOUND_OF_RATED ? f->i_rated_peak_A : coordinate_value(&f->nominal, id);
        *low = z_of(f, id, *low * of);
        *high = isinf(*high) ? INFINITY : z_of(f, id, *high * of);
    }
    if (c->of_magnet && f->nominal.psi_f_Wb == 0.0) {
        *low = *high = 0.0;
    }
    if (c->not_negative) {
        *low = fmax(*low, z_of(f, id, 0.0));
    }
}

static double within_range(const coordinate_frame *f, coordinate_id id, double z)
{
    double low;
    double high;
    coordinate_range(f, id, &low, &high);
    return fmin(fmax(z, low), high);
}

/* The least of the machine's resistance and inductance that a phase has. */
static const double LEAST_RESISTANCE = 0.1;
static const double LEAST_INDUCTANCE = 0.2;

/* The range of what a phase has alone depends on what all have. */
static void bound_phases(const coordinate_frame *f, double z[P_COUNT])
{
    static const coordinate_id resistance[] = {P_DR_A, P_DR_B, P_DR_C};
    static const coordinate_id inductance[] = {P_DL_A, P_DL_B, P_DL_C};
    const averaged_drive d = coordinates_drive(f, z, EDGE_CHARGED);
    const double R = (LEAST_RESISTANCE - 1.0) * d.R_ohm;
    const double L = (LEAST_INDUCTANCE - 1.0) * fmin(d.L_d_H, d.L_q_H);
    for (size_t x = 0; x < 3; x++) {
        z[resistance[x]] = fmax(z[resistance[x]], z_of(f, resistance[x], R));
        z[inductance[x]] = fmax(z[inductance[x]], z_of(f, inductance[x], L));
    }
}

void coordinates_bound(const coordinate_frame *f, double z[P_COUNT])
{
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        z[id] = within_range(f, id, z[id]);
    }
    bound_phases(f, z);
    bound_map(f, z);
}

void coordinates_scale(const coordinate_frame *f, double voltages, double currents, double z[P_COUNT])
{
    const averaged_drive d = coordinates_drive(f, z, EDGE_CHARGED);
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        const coordinate *c = &coordinate_table[id];
        if (c->volts != 0 || c->amperes != 0) {
            z[id] =
                z_of(f, id, coordinate_value(&d, id) * pow(voltages, c->volts) * pow(currents, c->amperes));
        }
        if (c->wanders > 0.0) {
            z[id] = within_range(f, id, z[id]);
        }
    }
}
