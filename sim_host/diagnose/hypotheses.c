#include "hypotheses.h"

#include <math.h>
#include <string.h>

/*
 * `least`: below it the motor file is right for every practical purpose, and second-order effects of a real
 * inverter (ripple, quantised duties) begin. In units of z: shares of R, L, psi and of the rated peak
 * current, 1 % of the DC link, radians, cycles.
 */
const hypothesis hypothesis_table[H_COUNT] = {
    [H_RESISTANCE] = {"resistance", "winding resistance", true, 1, {P_R}, false, 0.0, 0.02},
    [H_INDUCTANCE] = {"inductance", "inductance, both axes alike", true, 1, {COLUMN_L}, false, 0.0, 0.008},
    [H_FLUX] = {"flux_linkage", "magnet flux", true, 1, {P_PSI}, false, 0.0, 0.004},
    [H_SALIENCY] = {"saliency", "d and q inductance, unequally", true, 2, {P_L_D, P_L_Q}, false, 0.0, 0.012},
    [H_SATURATION] =
        {"saturation", "inductance falls with current", true, 2, {COLUMN_L, P_SATURATION}, false, 4.0, 0.02},
    [H_DEAD_TIME] =
        {"dead_time", "voltage lost against the phase currents", true, 1, {P_V_DEAD}, false, 0.0, 0.04},
    [H_VOLTAGE_GAIN] = {"voltage_gain", "all voltages scaled alike", true, 1, {P_K_U}, false, 1.0, 0.003},
    [H_CURRENT_OFFSET] = {"current_offset",
                          "offsets of the current sensors",
                          true,
                          2,
                          {P_OFFSET_A, P_OFFSET_B},
                          false,
                          2.0,
                          0.002},
    [H_CURRENT_GAIN] = {"current_gain",
                        "gains of the current sensors",
                        true,
                        3,
                        {P_GAIN_A, P_GAIN_B, P_GAIN_C},
                        false,
                        4.0,
                        0.004},
    /* Where the gain common to all would be R, L and psi through another scale, they alone can be told. What
     * they leave out makes them the dearer choice elsewhere. */
    [H_GAIN_MISMATCH] = {"current_gain",
                         "gains of the current sensors against one another",
                         true,
                         2,
                         {COLUMN_GAIN_A, COLUMN_GAIN_BC},
                         false,
                         18.0,
                         0.004},
    [H_ANGLE_OFFSET] = {"angle_offset", "constant angle error", true, 1, {P_THETA_0}, false, 0.0, 0.003},
    [H_ANGLE_HARMONIC_1] = {"angle_harmonic",
                            "angle error once per revolution",
                            true,
                            2,
                            {P_HARMONIC_1C, P_HARMONIC_1S},
                            false,
                            4.0,
                            0.003},
    [H_ANGLE_HARMONIC_2] = {"angle_harmonic",
                            "angle error twice per revolution",
                            true,
                            2,
                            {P_HARMONIC_2C, P_HARMONIC_2S},
                            false,
                            4.0,
                            0.003},
    [H_ANGLE_DELAY] = {"angle_delay", "angle sampled late or early", true, 1, {P_T_DELAY}, false, 3.0, 0.01},
    [H_VOLTAGE_DELAY_1] =
        {"voltage_delay", "voltage acts a cycle late", true, 1, {P_U_DELAY_1}, true, 4.0, 0.5},
    [H_VOLTAGE_DELAY_2] =
        {"voltage_delay", "voltage acts two cycles late", true, 1, {P_U_DELAY_2}, true, 4.0, 0.5},
    [H_EMF_HARMONICS] = {"emf_harmonics",
                         "5th and 7th harmonic of the back-EMF",
                         true,
                         2,
                         {P_PSI_5, P_PSI_7},
                         false,
                         3.0,
                         0.0007},
    [H_ASYMMETRY_A] = {"phase_asymmetry", "resistance of phase A alone", true, 1, {P_DR_A}, false, 5.0, 0.02},
    [H_ASYMMETRY_B] = {"phase_asymmetry", "resistance of phase B alone", true, 1, {P_DR_B}, false, 5.0, 0.02},
    [H_ASYMMETRY_C] = {"phase_asymmetry", "resistance of phase C alone", true, 1, {P_DR_C}, false, 5.0, 0.02},
    [H_ASYMMETRY] =
        {"phase_asymmetry", "unequal resistances", true, 3, {P_DR_A, P_DR_B, P_DR_C}, false, 8.0, 0.03},
    [H_IRON_LOSS] = {"iron loss",
                     "iron loss (current that makes no flux)",
                     false,
                     2,
                     {P_IRON, P_IRON_LATE},
                     false,
                     3.0,
                     0.3},
    [H_EDDY] = {"iron loss", "iron loss (eddy currents)", false, 2, {P_EDDY, P_EDDY_LATER}, false, 3.0, 0.3},
    [H_CROSS_SATURATION] = {"saturation unlike in d and q",
                            "saturation that differs between the axes",
                            false,
                            2,
                            {COLUMN_L, P_SATURATION_Q},
                            false,
                            8.0,
                            0.03},
    [H_EMF_HARMONICS_11] = {"11th and 13th harmonic of the back-EMF",
                            "11th and 13th harmonic of the back-EMF",
                            false,
                            2,
                            {P_PSI_11, P_PSI_13},
                            false,
                            8.0,
                            0.0007},
    [H_TEMPERATURE] = {"temperature",
                       "flux and resistance that follow the temperature",
                       false,
                       2,
                       {P_PSI_TEMPERATURE, P_R_TEMPERATURE},
                       false,
                       8.0,
                       0.02},
    /* On average, updates that are missed now and then are a share of the voltage that comes a cycle late. */
    [H_LATE_SHARE] = {"a share of the voltage late",
                      "a share of the voltage a cycle late (missed updates)",
                      false,
                      1,
                      {P_U_DELAY_1},
                      false,
                      3.0,
                      0.005},
};

/* Inductance lies inside saliency and saturation; three free dR hold a resistance. */
#define ANY_INDUCTANCE                                                                                       \
    (HYPOTHESIS_BIT(H_INDUCTANCE) | HYPOTHESIS_BIT(H_SALIENCY) | HYPOTHESIS_BIT(H_SATURATION) |              \
     HYPOTHESIS_BIT(H_CROSS_SATURATION))

/* Of each line at most all but one may stand in a set. */
static const hypothesis_set exclusive[][4] = {
    {HYPOTHESIS_BIT(H_RESISTANCE), HYPOTHESIS_BIT(H_ASYMMETRY)},
    {HYPOTHESIS_BIT(H_VOLTAGE_DELAY_1) | HYPOTHESIS_BIT(H_VOLTAGE_DELAY_2), HYPOTHESIS_BIT(H_LATE_SHARE)},
    {HYPOTHESIS_BIT(H_VOLTAGE_GAIN), HYPOTHESIS_BIT(H_FLUX), ANY_INDUCTANCE},
    {HYPOTHESIS_BIT(H_VOLTAGE_GAIN), HYPOTHESIS_BIT(H_FLUX), HYPOTHESIS_BIT(H_CURRENT_GAIN)},
    {HYPOTHESIS_BIT(H_VOLTAGE_GAIN), HYPOTHESIS_BIT(H_CURRENT_GAIN), ANY_INDUCTANCE},
    {HYPOTHESIS_BIT(H_RESISTANCE), HYPOTHESIS_BIT(H_CURRENT_GAIN), ANY_INDUCTANCE},
};

bool hypothesis_joins(hypothesis_set set, hypothesis_id id)
{
    hypothesis_set joined = set | HYPOTHESIS_BIT(id);
    if (((HYPOTHESIS_BIT(id) & ANY_INDUCTANCE) && (set & ANY_INDUCTANCE)) || joined == set) {
        return false;
    }
    for (hypothesis_id other = 0; other < H_COUNT; other++) {
        if ((set & HYPOTHESIS_BIT(other)) &&
            strcmp(hypothesis_table[other].cause, hypothesis_table[id].cause) == 0) {
            return false;
        }
    }
    for (size_t k = 0; k < sizeof exclusive / sizeof *exclusive; k++) {
        bool all = true;
        for (size_t j = 0; j < 4 && exclusive[k][j]; j++) {
            all = all && (joined & exclusive[k][j]);
        }
        if (all) {
            return false;
        }
    }
    return true;
}

/* Of two gains, as a share of both: the least difference that makes them a mismatch. */
static const double LEAST_DIFFERENCE = 0.05;

/* How far three values are apart: root sum square about their mean. */
static double spread(double a, double b, double c)
{
    const double mean = (a + b + c) / 3.0;
    return sqrt((a - mean) * (a - mean) + (b - mean) * (b - mean) + (c - mean) * (c - mean));
}

/*
 * A mismatch: one gain common to all sensors is R and L seen through another scale. Two sensors have no third
 * that could stand out, so that what they share counts, but only beside a difference.
 */
static double size_of_two(double a, double b)
{
    const double all = hypot(a, b);
    return fabs(a - b) >= LEAST_DIFFERENCE * all ? all : 0.0;
}

double hypothesis_size(hypothesis_id h, const double z[P_COUNT])
{
    const hypothesis *hypo = &hypothesis_table[h];
    switch (h) {
    case H_INDUCTANCE:
        return fabs(z[P_L_D]);
    case H_SALIENCY:
        return fabs(z[P_L_D] - z[P_L_Q]);
    case H_SATURATION:
        return z[P_SATURATION];
    case H_CROSS_SATURATION:
        return fabs(z[P_SATURATION_Q]);
    case H_GAIN_MISMATCH:
        return spread(z[P_GAIN_A], z[P_GAIN_B], z[P_GAIN_C]);
    case H_CURRENT_GAIN:
        return z[P_GAIN_C] == 0.0 ? size_of_two(z[P_GAIN_A], z[P_GAIN_B])
                                  : spread(z[P_GAIN_A], z[P_GAIN_B], z[P_GAIN_C]);
    case H_ASYMMETRY:
        /* Three equal ones are a resistance. */
        return spread(z[P_DR_A], z[P_DR_B], z[P_DR_C]);
    default:
        break;
    }
    double square = 0.0;
    for (size_t k = 0; k < hypo->columns; k++) {
        square += z[hypo->column[k]] * z[hypo->column[k]];
    }
    return sqrt(square);
}

bool hypotheses_count(hypothesis_set set, const double z[P_COUNT])
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((set & HYPOTHESIS_BIT(h)) && hypothesis_size(h, z) < hypothesis_table[h].least) {
            return false;
        }
    }
    return true;
}

static const double USUAL_GAIN_OF_ALL = 0.02;

double hypotheses_unusual(hypothesis_set set, const double z[P_COUNT])
{
    /* One standard deviation of what drives usually show, in z. */
    static const double usual[P_COUNT] = {
        [P_R] = 0.3,       [P_L_D] = 0.12,    [P_L_Q] = 0.12,    [P_PSI] = 0.05,    [P_SATURATION] = 0.4,
        [P_K_U] = 0.04,    [P_GAIN_A] = 0.04, [P_GAIN_B] = 0.04, [P_GAIN_C] = 0.04, [P_THETA_0] = 0.1,
        [P_T_DELAY] = 0.5, [P_DR_A] = 0.4,    [P_DR_B] = 0.4,    [P_DR_C] = 0.4,    [P_V_DEAD] = 1.0};
    double moved[P_COUNT] = {0.0};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (set & HYPOTHESIS_BIT(h)) {
            hypothesis_copy(h, z, moved);
        }
    }
    if (!(set & HYPOTHESIS_BIT(H_SALIENCY))) {
        moved[P_L_Q] = 0.0; /* of both inductances alike one counts */
    }
    double sum = 0.0;
    for (size_t id = 0; id < P_COUNT; id++) {
        sum += usual[id] > 0.0 ? moved[id] * moved[id] / (usual[id] * usual[id]) : 0.0;
    }
    if (moved[P_GAIN_C] != 0.0) {
        /* Three sensors that err alike are rarer than an R and an L that do. */
        double mean = (moved[P_GAIN_A] + moved[P_GAIN_B] + moved[P_GAIN_C]) / 3.0;
        sum += mean * mean / (USUAL_GAIN_OF_ALL * USUAL_GAIN_OF_ALL);
    }
    return sum;
}

/* What a step along a column does: the parameters it moves, and by how much. The last of a list has share 0.
 */
typedef struct column_part {
    parameter_id parameter;
    double share;
} column_part;

enum { COLUMN_PARTS = 4 };

static const column_part joint[COLUMN_COUNT - P_COUNT][COLUMN_PARTS] = {
    [COLUMN_L - P_COUNT] = {{P_L_D, 1.0}, {P_L_Q, 1.0}},
    [COLUMN_GAIN_A - P_COUNT] = {{P_GAIN_A, 1.0}, {P_GAIN_B, -0.5}, {P_GAIN_C, -0.5}},
    [COLUMN_GAIN_BC - P_COUNT] = {{P_GAIN_B, 1.0}, {P_GAIN_C, -1.0}},
};

void column_move(int column, double by, double z[P_COUNT])
{
    if (column < P_COUNT) {
        z[column] += by;
        return;
    }
    for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
        z[part->parameter] += by * part->share;
    }
}

double column_value(int column, const double z[P_COUNT])
{
    if (column < P_COUNT) {
        return z[column];
    }
    double along = 0.0;
    double length = 0.0;
    for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
        along += part->share * z[part->parameter];
        length += part->share * part->share;
    }
    return along / length;
}

static void column_copy(int column, const double from[P_COUNT], double to[P_COUNT])
{
    if (column < P_COUNT) {
        to[column] = from[column];
        return;
    }
    for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
        to[part->parameter] = from[part->parameter];
    }
}

const double hypothesis_nominal[P_COUNT] = {0.0};

void hypothesis_copy(hypothesis_id h, const double from[P_COUNT], double to[P_COUNT])
{
    for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
        column_copy(hypothesis_table[h].column[k], from, to);
    }
}

hypothesis_set hypotheses_possible(const diagnose_rows *r, const parameter_set *p)
{
    hypothesis_set all = HYPOTHESIS_BIT(H_COUNT) - 1;
    bool turns = r->omega_max_rad_s * r->T_s > 1e-5;
    if (!turns || p->nominal.psi_f_Wb == 0.0) {
        all &= ~(HYPOTHESIS_BIT(H_FLUX) | HYPOTHESIS_BIT(H_EMF_HARMONICS) |
                 HYPOTHESIS_BIT(H_EMF_HARMONICS_11) | HYPOTHESIS_BIT(H_IRON_LOSS));
    }
    if (!turns) {
        all &= ~(HYPOTHESIS_BIT(H_ANGLE_HARMONIC_1) | HYPOTHESIS_BIT(H_ANGLE_HARMONIC_2) |
                 HYPOTHESIS_BIT(H_ANGLE_DELAY));
    }
    if (r->two_sensors) {
        all &= ~HYPOTHESIS_BIT(H_GAIN_MISMATCH);
    }
    if (!r->temperature_known) {
        all &= ~HYPOTHESIS_BIT(H_TEMPERATURE);
    }
    return all;
}

hypothesis_set hypotheses_of_cause(const char *cause)
{
    hypothesis_set set = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_table[h].named && strcmp(hypothesis_table[h].cause, cause) == 0) {
            set |= HYPOTHESIS_BIT(h);
        }
    }
    return set;
}
