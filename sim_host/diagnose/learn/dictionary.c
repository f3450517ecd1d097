/* The stated dictionary: its entries, their names and their words (dictionary.h). */
#include "dictionary.h"

#include <stdio.h>

/* Those that are no orders of an angle. */
static const struct {
    const char *name, *unit, *words;
} plain[ENTRY_MECHANICAL] = {
    [ENTRY_ONE] = {"1", "V", "the rotor frame alone (a constant)"},
    [ENTRY_I_D] = {"i_d", "V/A", "i_d"},
    [ENTRY_I_Q] = {"i_q", "V/A", "i_q"},
    [ENTRY_I_D_I_D] = {"i_d^2", "V/A^2", "i_d^2"},
    [ENTRY_I_D_I_Q] = {"i_d i_q", "V/A^2", "i_d i_q"},
    [ENTRY_I_Q_I_Q] = {"i_q^2", "V/A^2", "i_q^2"},
    [ENTRY_OMEGA] = {"omega", "V s", "the speed"},
    [ENTRY_OMEGA_I_D] = {"omega i_d", "V s/A", "the speed times i_d"},
    [ENTRY_OMEGA_I_Q] = {"omega i_q", "V s/A", "the speed times i_q"},
    [ENTRY_OMEGA_I_D_I_D] = {"omega i_d^2", "V s/A^2", "the speed times i_d^2"},
    [ENTRY_OMEGA_I_D_I_Q] = {"omega i_d i_q", "V s/A^2", "the speed times i_d i_q"},
    [ENTRY_OMEGA_I_Q_I_Q] = {"omega i_q^2", "V s/A^2", "the speed times i_q^2"},
    [ENTRY_U_D] = {"u_d", "1", "u_d"},
    [ENTRY_U_Q] = {"u_q", "1", "u_q"},
    [ENTRY_U_D_BEFORE] = {"u_d before", "1", "u_d of the cycle before"},
    [ENTRY_U_Q_BEFORE] = {"u_q before", "1", "u_q of the cycle before"},
    [ENTRY_SIGN_D] = {"sign_d", "V", "the signs of the phase currents"},
    [ENTRY_SIGN_Q] = {"sign_q", "V", "the signs of the phase currents"},
    [ENTRY_TIME] = {"t", "V/s", "time"},
    [ENTRY_TEMPERATURE] = {"temp", "V/K", "the temperature"},
};

/* sin(x)/x; the mean of cos(a + x') over |x'| < x is cos(a) times that. */
static double mean_factor(double x)
{
    return fabs(x) < 1e-4 ? 1.0 - x * x / 6.0 : sin(x) / x;
}

static void orders_of(vec_rotor angle, double half_turn_rad, double size, int most, double *entry)
{
    vec_rotor at = {1.0, 0.0};
    for (int n = 1; n <= most; n++) {
        const double factor = size * mean_factor(n * half_turn_rad);
        at = rotor_turned(at, angle);
        entry[2 * (n - 1)] = factor * at.cos;
        entry[2 * (n - 1) + 1] = factor * at.sin;
    }
}

static vec_dq signs_of(const learn_cycle *c)
{
    double phase[3];
    vec_to_phases(vec_to_ab(c->i_A, c->middle), phase);
    for (int x = 0; x < 3; x++) {
        phase[x] = phase[x] > 0.0 ? 1.0 : (phase[x] < 0.0 ? -1.0 : 0.0);
    }
    return vec_to_dq(vec_from_phases(phase), c->middle);
}

void dictionary_at(const learn_cycle *c, double entry[ENTRIES])
{
    const vec_dq i = c->i_A;
    const vec_dq sign = signs_of(c);
    entry[ENTRY_ONE] = 1.0;
    entry[ENTRY_I_D] = i.d;
    entry[ENTRY_I_Q] = i.q;
    entry[ENTRY_I_D_I_D] = i.d * i.d;
    entry[ENTRY_I_D_I_Q] = i.d * i.q;
    entry[ENTRY_I_Q_I_Q] = i.q * i.q;
    for (int n = 0; n < 6; n++) {
        entry[ENTRY_OMEGA + n] = c->omega_rad_s * entry[ENTRY_ONE + n];
    }
    entry[ENTRY_U_D] = c->u_V.d;
    entry[ENTRY_U_Q] = c->u_V.q;
    entry[ENTRY_U_D_BEFORE] = c->u_before_V.d;
    entry[ENTRY_U_Q_BEFORE] = c->u_before_V.q;
    entry[ENTRY_SIGN_D] = sign.d;
    entry[ENTRY_SIGN_Q] = sign.q;
    entry[ENTRY_TIME] = c->elapsed_s;
    entry[ENTRY_TEMPERATURE] = c->temperature_K;
    /* A revolution that is not known is no reason for anything; a mechanical turn is slow, and needs no mean. */
    orders_of(c->mechanical, 0.0, c->mech_known ? 1.0 : 0.0, DICTIONARY_MECHANICAL, entry + ENTRY_MECHANICAL);
    orders_of(c->middle, c->half_turn_rad, 1.0, DICTIONARY_ORDERS, entry + ENTRY_ANGLE);
    for (int n = 0; n < 2 * DICTIONARY_ORDERS; n++) {
        entry[ENTRY_SPEED_ANGLE + n] = c->omega_rad_s * entry[ENTRY_ANGLE + n];
    }
}

static size_t order_of_entry(size_t entry)
{
    const size_t from = entry >= ENTRY_SPEED_ANGLE ? (size_t)ENTRY_SPEED_ANGLE
                        : entry >= ENTRY_ANGLE     ? (size_t)ENTRY_ANGLE
                                                   : (size_t)ENTRY_MECHANICAL;
    return (entry - from) / 2 + 1;
}

/* Each set of orders starts at an even number, so that sines are odd. */
static bool is_sine(size_t entry)
{
    return ((entry - ENTRY_MECHANICAL) & 1U) != 0;
}

void dictionary_name(size_t entry, char *out, size_t size)
{
    if (entry < ENTRY_MECHANICAL) {
        snprintf(out, size, "%s", plain[entry].name);
        return;
    }
    snprintf(out, size, "%s%s(%zu %s)", entry >= ENTRY_SPEED_ANGLE ? "omega " : "",
             is_sine(entry) ? "sin" : "cos", order_of_entry(entry),
             entry < ENTRY_ANGLE ? "theta_mech" : "theta_e");
}

const char *dictionary_unit(size_t entry)
{
    if (entry < ENTRY_MECHANICAL) {
        return plain[entry].unit;
    }
    return entry >= ENTRY_SPEED_ANGLE ? "V s" : "V";
}

void dictionary_words(size_t entry, char *out, size_t size)
{
    if (entry < ENTRY_MECHANICAL) {
        snprintf(out, size, "%s", plain[entry].words);
        return;
    }
    snprintf(out, size, "the rotor's %s angle (order %zu%s)",
             entry < ENTRY_ANGLE ? "mechanical" : "electrical", order_of_entry(entry),
             entry >= ENTRY_SPEED_ANGLE ? ", growing with the speed" : "");
}

bool dictionary_turns(size_t entry)
{
    return entry >= ENTRY_MECHANICAL;
}

const char *dictionary_axis(size_t entry)
{
    static const char *const of[ENTRY_MECHANICAL] = {
        [ENTRY_ONE] = "time from the middle, s",
        [ENTRY_I_D] = "i_d, A",
        [ENTRY_I_Q] = "i_q, A",
        [ENTRY_I_D_I_D] = "i_d, A",
        [ENTRY_I_D_I_Q] = "i_d i_q, A^2",
        [ENTRY_I_Q_I_Q] = "i_q, A",
        [ENTRY_OMEGA] = "electrical speed, rad/s",
        [ENTRY_OMEGA_I_D] = "i_d, A",
        [ENTRY_OMEGA_I_Q] = "i_q, A",
        [ENTRY_OMEGA_I_D_I_D] = "i_d, A",
        [ENTRY_OMEGA_I_D_I_Q] = "i_d i_q, A^2",
        [ENTRY_OMEGA_I_Q_I_Q] = "i_q, A",
        [ENTRY_U_D] = "u_d, V",
        [ENTRY_U_Q] = "u_q, V",
        [ENTRY_U_D_BEFORE] = "u_d of the cycle before, V",
        [ENTRY_U_Q_BEFORE] = "u_q of the cycle before, V",
        [ENTRY_SIGN_D] = "d part of the phase currents' signs",
        [ENTRY_SIGN_Q] = "q part of the phase currents' signs",
        [ENTRY_TIME] = "time from the middle, s",
        [ENTRY_TEMPERATURE] = "temperature from its mean, K",
    };
    if (entry < ENTRY_MECHANICAL) {
        return of[entry];
    }
    return entry < ENTRY_ANGLE ? "mechanical rotor angle, degrees" : "electrical rotor angle, degrees";
}

static double degrees(vec_rotor angle)
{
    const double at = atan2(angle.sin, angle.cos) * 180.0 / VEC_PI;
    return at < 0.0 ? at + 360.0 : at;
}

double dictionary_place(size_t entry, const learn_cycle *c, double *over)
{
    const bool with_speed =
        (entry >= ENTRY_OMEGA_I_D && entry <= ENTRY_OMEGA_I_Q_I_Q) || entry >= ENTRY_SPEED_ANGLE;
    *over = with_speed ? c->omega_rad_s : 1.0;
    switch (entry) {
    case ENTRY_I_D:
    case ENTRY_I_D_I_D:
    case ENTRY_OMEGA_I_D:
    case ENTRY_OMEGA_I_D_I_D:
        return c->i_A.d;
    case ENTRY_I_Q:
    case ENTRY_I_Q_I_Q:
    case ENTRY_OMEGA_I_Q:
    case ENTRY_OMEGA_I_Q_I_Q:
        return c->i_A.q;
    case ENTRY_I_D_I_Q:
    case ENTRY_OMEGA_I_D_I_Q:
        return c->i_A.d * c->i_A.q;
    case ENTRY_OMEGA:
        return c->omega_rad_s;
    case ENTRY_U_D:
        return c->u_V.d;
    case ENTRY_U_Q:
        return c->u_V.q;
    case ENTRY_U_D_BEFORE:
        return c->u_before_V.d;
    case ENTRY_U_Q_BEFORE:
        return c->u_before_V.q;
    case ENTRY_SIGN_D:
        return signs_of(c).d;
    case ENTRY_SIGN_Q:
        return signs_of(c).q;
    case ENTRY_TEMPERATURE:
        return c->temperature_K;
    default:
        break;
    }
    if (entry < ENTRY_MECHANICAL) {
        return c->elapsed_s;
    }
    return degrees(entry < ENTRY_ANGLE ? c->mechanical : c->middle);
}
