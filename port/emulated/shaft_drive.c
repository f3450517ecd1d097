/*
 * The stand-in drive of small_drive.h with a shaft in place of the plan: the torque accelerates it. The machine is that of the 2019
 * paper, in integers; the current is exact for a voltage that is constant over half a period.
 */
#include "small_drive.h"

#include "iqfoc/predictor_exact.h"
#include "iqfoc/transform.h"

/* 1e-3 kg m^2: the rated torque of 9 Nm gives 1.7e-4 turns per cycle^2. 2e-3 Nms of friction: 0.19 of that torque at 0.08 turns. */
#define ACCELERATION_Q32 INT32_C(731000)
#define FRICTION         IQ24(2.34)

static const iqfoc_exact_winding_t winding =
    IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 2.0e-4, 14.8492424, 750.0);

static iqfoc_exact_law_t law;

void small_drive_start(small_drive_t *drive)
{
    const small_drive_t still = {{0, 0}, IQ24(0.37), 0, 0};
    *drive = still;
    law = iqfoc_exact_prediction(&winding, IQ24(0.5));
}

void small_drive_begin_cycle(small_drive_t *drive)
{
    const iq24_t i_q = iqfoc_park(drive->i, iq24_sincos(drive->theta)).q;
    const iq24_t torque = i_q - iq24_mul_round(FRICTION, drive->speed);
    drive->cycle++;
    drive->speed += iq24_mul_high_round(torque, ACCELERATION_Q32);
}

void small_drive_advance_half(small_drive_t *drive, const iqfoc_command_t *command)
{
    const iqfoc_exact_t exact = iqfoc_exact_at_speed(&law, drive->speed);
    const iq24_sincos_t middle = iq24_sincos(drive->theta + drive->speed / 4);
    const iqfoc_ab_t none = {0, 0};
    /* Gates off: as in small_drive.c. */
    drive->i = command->gates
                   ? iqfoc_exact_step(&exact, drive->i, iqfoc_clarke3(command->duties.high), middle)
                   : none;
    drive->theta = iq24_wrap(((int64_t)drive->theta + drive->speed / 2) & (IQ24_ONE - 1));
}
