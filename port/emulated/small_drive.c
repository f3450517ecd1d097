/*
 * Stand-in drive of the emulated boards (port/emulated/small_drive.h).
 */
#include "small_drive.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/params.h"
#include "iqfoc/predictor.h"
#include "iqfoc/transform.h"

#define T_S      2.0e-4
#define R_OHM    0.75
#define L_H      5.2e-3
#define PSI_WB   0.134
#define U_DC_V   750.0
#define I_BASE_A IQFOC_I_BASE(10.5)
#define W_RAD_S  1500.0

const iqfoc_cycle_config_t small_drive_config = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_BASE_A, U_DC_V),
    .gains = IQFOC_GAINS(W_RAD_S, R_OHM, L_H, L_H, PSI_WB, T_S, I_BASE_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(0.96),
    .current_limit = IQ24(4.0),
};

/*
 * The machine differs from the firmware's parameters: 20 % more resistance,
 * 5 % less inductance. Coefficients of half a cycle.
 */
static const iqfoc_predictor_t machine =
    IQFOC_PREDICTOR(1.2 * R_OHM, 0.95 * L_H, PSI_WB, 0.5 * T_S, I_BASE_A, U_DC_V);

/*
 * Turns per cycle at the plan's corner points, 4,096 cycles apart; between them the speed is a straight
 * line. The last repeats. Up to the limit of the voltage and beyond.
 */
#define PLAN_STEP 4096
static const iq24_t plan[6] = {0, IQ24(0.02), IQ24(0.12), IQ24(-0.03), IQ24(-0.12), IQ24(0.06)};

void small_drive_start(small_drive_t *drive)
{
    const small_drive_t still = {{0, 0}, 0, 0, 0};
    *drive = still;
}

static iq24_t planned_speed(uint32_t cycle)
{
    const uint32_t leg = cycle / PLAN_STEP % 5;
    const int32_t share = (int32_t)(cycle % PLAN_STEP);
    return plan[leg] + (plan[leg + 1] - plan[leg]) / PLAN_STEP * share;
}

void small_drive_begin_cycle(small_drive_t *drive)
{
    drive->cycle++;
    drive->speed = planned_speed(drive->cycle);
}

iqfoc_dq_t small_drive_reference(uint32_t cycle)
{
    /* A step every 500 cycles; the values walk through -0.3 ... 0 and -0.6 ... 0.6. */
    const int32_t step = (int32_t)(cycle / 500);
    const iqfoc_dq_t reference = {-(step * 7 % 4) * IQ24(0.1), (step * 5 % 13 - 6) * IQ24(0.1)};
    return reference;
}

void small_drive_advance_half(small_drive_t *drive, const iqfoc_command_t *command)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(drive->speed / 2);
    const iqfoc_ab_t none = {0, 0};
    /* Gates off: the diodes are not modelled, the current is simply gone. */
    if (command->gates) {
        const iqfoc_ab_t u = iqfoc_clarke3(command->duties.high);
        drive->i = iqfoc_predictor_euler(&machine, drive->i, u, &rotor, iq24_sincos(drive->theta));
    } else {
        drive->i = none;
    }
    drive->theta = iq24_wrap(((int64_t)drive->theta + rotor.speed) & (IQ24_ONE - 1));
}
