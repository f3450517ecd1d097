#include "quantity.h"

#include "base/vector.h"

#include <string.h>

typedef struct entry {
    const char *key;
    dimension dimension;
} entry;

static const entry entries[QUANTITY_COUNT] = {
    [QUANTITY_T] = {"t_s", DIMENSION_TIME},
    [QUANTITY_RUN] = {"run", DIMENSION_NUMBER},
    [QUANTITY_I_A] = {"i_a_A", DIMENSION_CURRENT},
    [QUANTITY_I_B] = {"i_b_A", DIMENSION_CURRENT},
    [QUANTITY_I_C] = {"i_c_A", DIMENSION_CURRENT},
    [QUANTITY_I_D] = {"i_d_A", DIMENSION_CURRENT},
    [QUANTITY_I_Q] = {"i_q_A", DIMENSION_CURRENT},
    [QUANTITY_I_ALPHA] = {"i_alpha_A", DIMENSION_CURRENT},
    [QUANTITY_I_BETA] = {"i_beta_A", DIMENSION_CURRENT},
    [QUANTITY_U_A] = {"u_a_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_B] = {"u_b_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_C] = {"u_c_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_D] = {"u_d_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_Q] = {"u_q_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_ALPHA] = {"u_alpha_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_BETA] = {"u_beta_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_AB] = {"u_ab_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_BC] = {"u_bc_V", DIMENSION_VOLTAGE},
    [QUANTITY_U_CA] = {"u_ca_V", DIMENSION_VOLTAGE},
    [QUANTITY_D_A] = {"d_a", DIMENSION_DUTY},
    [QUANTITY_D_B] = {"d_b", DIMENSION_DUTY},
    [QUANTITY_D_C] = {"d_c", DIMENSION_DUTY},
    [QUANTITY_U_DC] = {"u_dc_V", DIMENSION_VOLTAGE},
    [QUANTITY_THETA] = {"theta_e_rad", DIMENSION_ANGLE},
    [QUANTITY_OMEGA] = {"omega_e_rad_s", DIMENSION_SPEED},
    [QUANTITY_MID_A] = {"i_a_mid_A", DIMENSION_CURRENT},
    [QUANTITY_MID_B] = {"i_b_mid_A", DIMENSION_CURRENT},
    [QUANTITY_MID_C] = {"i_c_mid_A", DIMENSION_CURRENT},
    [QUANTITY_THETA_MECH] = {"theta_mech_rad", DIMENSION_ANGLE},
    [QUANTITY_TEMP] = {"temp_C", DIMENSION_TEMPERATURE},
};

static const quantity_unit number_units[] = {{"1", 1.0}};
static const quantity_unit time_units[] = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
static const quantity_unit current_units[] = {{"A", 1.0}, {"mA", 1e-3}, {"kA", 1e3}};
static const quantity_unit voltage_units[] = {{"V", 1.0}, {"mV", 1e-3}, {"kV", 1e3}};
static const quantity_unit duty_units[] = {{"1", 1.0}, {"percent", 0.01}};
static const quantity_unit angle_units[] = {
    {"rad", 1.0}, {"deg", VEC_PI / 180.0}, {"turn", VEC_TWO_PI}, {"count", 0.0}};
static const quantity_unit speed_units[] = {
    {"rad/s", 1.0}, {"rpm", VEC_TWO_PI / 60.0}, {"Hz", VEC_TWO_PI}, {"deg/s", VEC_PI / 180.0}};
static const quantity_unit temperature_units[] = {{"C", 1.0}};

#define UNITS(array)                                                                                         \
    {                                                                                                        \
        (array), sizeof(array) / sizeof *(array)                                                             \
    }

static const struct {
    const quantity_unit *units;
    size_t count;
} units_of[] = {
    [DIMENSION_NUMBER] = UNITS(number_units),   [DIMENSION_TIME] = UNITS(time_units),
    [DIMENSION_CURRENT] = UNITS(current_units), [DIMENSION_VOLTAGE] = UNITS(voltage_units),
    [DIMENSION_DUTY] = UNITS(duty_units),       [DIMENSION_ANGLE] = UNITS(angle_units),
    [DIMENSION_SPEED] = UNITS(speed_units),     [DIMENSION_TEMPERATURE] = UNITS(temperature_units),
};

const char *quantity_key(quantity q)
{
    return entries[q].key;
}

dimension quantity_dimension(quantity q)
{
    return entries[q].dimension;
}

quantity quantity_find(const char *key)
{
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        if (strcmp(entries[q].key, key) == 0) {
            return (quantity)q;
        }
    }
    return QUANTITY_COUNT;
}

const quantity_unit *quantity_units(dimension d, size_t *count)
{
    *count = units_of[d].count;
    return units_of[d].units;
}

const quantity_unit *quantity_unit_find(dimension d, const char *word)
{
    for (size_t n = 0; n < units_of[d].count; n++) {
        if (strcmp(units_of[d].units[n].word, word) == 0) {
            return &units_of[d].units[n];
        }
    }
    return NULL;
}
