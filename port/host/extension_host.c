/* A motor file's extensions to fixed point (extension_host.h). */
#include "extension_host.h"

#include "iqfoc/extension_params.h"

#include <math.h>

/* In IQ24. */
static bool constant(const motor *m, const char *key, const char *name, double value, double low, double high,
                     iq24_t *out, error *e)
{
    return constant_from_motor(m, key, name, value, low, high, 24, out, e);
}

bool extension_from_motor(const motor *m, iqfoc_extension_t *extension, error *e)
{
    const per_unit b = per_unit_of(m);
    iqfoc_extension_t made = IQFOC_EXTENSION_NONE;
    bool good = true;
#define FIRMWARE(ID, field, key, member, name, raw, low, high)                                               \
    if (good && m->ext.has[CAUSE_##ID]) {                                                                    \
        const double x = m->ext.field;                                                                       \
        good = constant(m, key, name, raw, low, high, &made.member, e);                                      \
    }
#include "data/causes.def"
    if (good) {
        *extension = made;
    }
    return good;
}

static bool inductance(const motor *m, const char *key, const char *name, double L_H, iq24_t *l, iq24_t *k,
                       error *e)
{
    const per_unit base = per_unit_of(m);
    const double value = IQFOC_RAW_FLUX_L(L_H, base.T_s, base.I_A, base.U_V);
    *k = iq24_from_double(1.0 / value);
    return constant(m, key, name, value, IQFOC_MIN_FLUX_L, IQFOC_MAX_FLUX_L, l, e);
}

bool flux_predictor_from_motor(const motor *m, iqfoc_flux_predictor_t *predictor, error *e)
{
    const per_unit base = per_unit_of(m);
    double L_d_H;
    double L_q_H;
    iqfoc_flux_predictor_t made;
    motor_inductances(m, &L_d_H, &L_q_H);
    if (!inductance(m, "L_d_H", "l_d = L_d I_b/(T U_b)", L_d_H, &made.l_d, &made.k_d, e) ||
        !inductance(m, "L_q_H", "l_q = L_q I_b/(T U_b)", L_q_H, &made.l_q, &made.k_q, e) ||
        !constant(m, "R_ohm", "R I_b/U_b", IQFOC_RAW_FLUX_R(m->R_ohm, base.I_A, base.U_V), 0.0,
                  IQFOC_MAX_FLUX_R, &made.r, e) ||
        !constant(m, "psi_f_Wb", "psi/(T U_b)", IQFOC_RAW_FLUX_PSI(m->psi_f_Wb, base.T_s, base.U_V), 0.0,
                  IQFOC_MAX_FLUX_PSI, &made.psi, e) ||
        !constant(m, "L_q_H", "(L_d - L_q)/(L_d + L_q)", IQFOC_RAW_FLUX_SKEW(L_d_H, L_q_H),
                  -IQFOC_MAX_FLUX_SKEW, IQFOC_MAX_FLUX_SKEW, &made.skew, e)) {
        return false;
    }
    *predictor = made;
    return true;
}

flux_map_values flux_map_values_of(const motor *m)
{
    const motor_extension *x = &m->ext;
    flux_map_values v = {
        .psi_Wb = m->psi_f_Wb,
        .part = {{x->E_1_J, x->I_d1_A, x->I_q1_A, x->I_c1_A}, {x->E_2_J, x->I_d2_A, x->I_q2_A, x->I_c2_A}}};
    motor_inductances(m, &v.L_d_H, &v.L_q_H);
    for (size_t k = 0; k < IQFOC_FLUX_MAP_PARTS; k++) {
        if (!x->has[CAUSE_SATURATION_DQ] || !(v.part[k].E_J > 0.0)) {
            v.part[k].E_J = 0.0;
            continue;
        }
        const double I_d_A = v.part[k].I_d_A;
        const double I_q_A = v.part[k].I_q_A;
        const double x_0 = v.part[k].I_c_A / I_d_A;
        const double root = sqrt(1.0 + x_0 * x_0);
        v.L_d_H -= v.part[k].E_J / (I_d_A * I_d_A * root * root * root);
        v.L_q_H -= v.part[k].E_J / (I_q_A * I_q_A * root);
        v.psi_Wb += v.part[k].E_J / I_d_A * x_0 / root;
    }
    return v;
}

/* Part k of a map, if it has one. */
static bool part(const motor *m, const flux_map_values *v, size_t k, iqfoc_flux_map_part_t *to, error *e)
{
    static const char *const key[IQFOC_FLUX_MAP_PARTS][4] = {{"E_1_J", "I_d1_A", "I_q1_A", "I_c1_A"},
                                                             {"E_2_J", "I_d2_A", "I_q2_A", "I_c2_A"}};
    const per_unit b = per_unit_of(m);
    *to = (iqfoc_flux_map_part_t)IQFOC_FLUX_MAP_NO_PART;
    return v->part[k].E_J == 0.0 ||
           (constant(m, key[k][0], "E/(T U_b I_b)", IQFOC_RAW_MAP_E(v->part[k].E_J, b.T_s, b.I_A, b.U_V), 0.0,
                     IQFOC_MAX_MAP_E, &to->e, e) &&
            constant(m, key[k][1], "I_b/I_d", IQFOC_RAW_MAP_K(v->part[k].I_d_A, b.I_A), IQFOC_MIN_MAP_K,
                     IQFOC_MAX_MAP_K, &to->k_d, e) &&
            constant(m, key[k][2], "I_b/I_q", IQFOC_RAW_MAP_K(v->part[k].I_q_A, b.I_A), IQFOC_MIN_MAP_K,
                     IQFOC_MAX_MAP_K, &to->k_q, e) &&
            constant(m, key[k][3], "I_c/I_d", IQFOC_RAW_MAP_X(v->part[k].I_c_A, v->part[k].I_d_A),
                     -IQFOC_MAX_MAP_X, IQFOC_MAX_MAP_X, &to->x_0, e));
}

bool flux_map_from_motor(const motor *m, iqfoc_flux_map_t *map, error *e)
{
    const per_unit b = per_unit_of(m);
    const flux_map_values v = flux_map_values_of(m);
    iqfoc_flux_map_t made;
    if (!constant(m, "L_d_H", "l_d = L_d I_b/(T U_b) of straight iron",
                  IQFOC_RAW_FLUX_L(v.L_d_H, b.T_s, b.I_A, b.U_V), IQFOC_MIN_MAP_L, IQFOC_MAX_FLUX_L,
                  &made.l_d, e) ||
        !constant(m, "L_q_H", "l_q = L_q I_b/(T U_b) of straight iron",
                  IQFOC_RAW_FLUX_L(v.L_q_H, b.T_s, b.I_A, b.U_V), IQFOC_MIN_MAP_L, IQFOC_MAX_FLUX_L,
                  &made.l_q, e) ||
        !constant(m, "R_ohm", "R I_b/U_b", IQFOC_RAW_FLUX_R(m->R_ohm, b.I_A, b.U_V), 0.0, IQFOC_MAX_FLUX_R,
                  &made.r, e) ||
        !constant(m, "psi_f_Wb", "psi/(T U_b)", IQFOC_RAW_FLUX_PSI(v.psi_Wb, b.T_s, b.U_V),
                  -IQFOC_MAX_FLUX_PSI, IQFOC_MAX_FLUX_PSI, &made.psi, e) ||
        !part(m, &v, 0, &made.part[0], e) || !part(m, &v, 1, &made.part[1], e)) {
        return false;
    }
    *map = made;
    return iqfoc_flux_map_check(map) == IQFOC_OK ||
           motor_refuse(
               m->path, "E_1_J", e,
               "the parts' flux is above 16 U_b T, or an inductance at a part's centre above 64 U_b T/I_b");
}

/* Turns per cycle. */
static double top_speed(const motor *m)
{
    return motor_speed_rad_s(m, m->n_max_rpm) * per_unit_of(m).T_s / VEC_TWO_PI;
}

double observer_loop_rad(const motor *m)
{
    return fmax(0.01, fmin(0.16, 0.65 * pow(top_speed(m), 2.0 / 3.0)));
}

void observer_set_loop(iqfoc_observer_config_t *config, double bandwidth_rad)
{
    const double pole = IQFOC_RAW_TRACKER_POLE(bandwidth_rad, 1.0);
    config->k1 = iq24_from_double(IQFOC_RAW_TRACKER_K1_2(pole));
    config->k2 = iq24_from_double(IQFOC_RAW_TRACKER_K2_2(pole));
}

bool observer_from_motor(const motor *m, iqfoc_observer_config_t *config, error *e)
{
    static const double least_share = 0.05; /* of the top speed */
    const iq24_t least = iq24_from_double(least_share * top_speed(m));
    iqfoc_extension_t extension;
    iqfoc_observer_config_t c = {.gain_max = IQ24(0.48),
                                 .speed_min = iq24_min(least, IQFOC_ROTOR_SPEED_MAX),
                                 .angle_max = IQ24(0.02),
                                 .lock_cycles = 8,
                                 .lost_cycles = 50,
                                 .slow_cycles = 2000};
    if (!extension_from_motor(m, &extension, e) || !flux_predictor_from_motor(m, &c.machine, e)) {
        return false;
    }
    observer_set_loop(&c, observer_loop_rad(m));
    c.saturation = extension.saturation;
    c.flux_max = c.machine.psi / 4;
    *config = c;
    return iqfoc_observer_check(config) == IQFOC_OK ||
           motor_refuse(m->path, "psi_f_Wb", e,
                        "the observer needs a magnet, psi_f/(T U_b) of 1/64 or more (here %g), and "
                        "|L_d - L_q| I_b/(T U_b) of 4 or less (here %g)",
                        iq24_to_double(c.machine.psi), iq24_to_double(c.machine.l_d - c.machine.l_q));
}
