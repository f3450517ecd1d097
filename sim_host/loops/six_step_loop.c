/* Six-step torque control (six_step_loop.h): the library's cycle as firmware, in the simulator's loop. */
#include "six_step_loop.h"

#include "drive/drive_loop.h"
#include "drive/firmware_host.h"
#include "params_host.h"
#include "reproduce/paper_2019.h"

#include "iqfoc/cycle_six_step.h"

#include <string.h>

/* Bandwidth of the angle's control: slow against the resonance at the fundamental that a winding has in the
 * rotor frame, damped by R/L = 144 1/s alone. */
#define BANDWIDTH_HZ 10.0

/* The library's cycle in six-step by a timer, as firmware. */
typedef struct six_step_drive {
    iqfoc_cycle_config_t config;
    iqfoc_six_step_config_t control;
    iqfoc_cycle_t cycle;
    iqfoc_six_step_t six;
} six_step_drive;

/* The interval has ended: feedback, control, next state. */
static bool at_switching(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                         error *e)
{
    six_step_drive *d = context;
    d->cycle.i_ref = i_ref;
    const iqfoc_six_step_command_t next =
        iqfoc_cycle_six_step_switch(&d->six, &d->cycle, sample, sample->time);
    *answer = drive_answer_of_state(&d->cycle, &next);
    return next.command.gates || error_failure(e, 0, "six-step: the firmware stopped the drive");
}

static bool begin(six_step_drive *d, const motor *m, double omega_rad_s, bool corrected, drive_answer *first,
                  error *e)
{
    /* i_q answers to the voltage's angle by U/(omega L) per radian, U = (2/pi) u_dc the fundamental. */
    const per_unit base = per_unit_of(m);
    const double u_V = 2.0 / VEC_PI * SIX_STEP_U_DC;
    const double pu_per_turn = VEC_TWO_PI * u_V / (omega_rad_s * m->L_q_H) / base.I_A;
    const double interval_s = VEC_TWO_PI / omega_rad_s / 6.0;
    const scenario_control control = {.feedback = FEEDBACK_MIDPOINT, .modulation = MODULATION_SIX_STEP};
    const iqfoc_sample_t still = {.speed = iq24_from_double(omega_rad_s * base.T_s / VEC_TWO_PI),
                                  .u_dc = iq24_from_double(SIX_STEP_U_DC / base.U_V)};
    memset(d, 0, sizeof *d);
    if (!config_from_motor(m, &control, &d->config, e)) {
        return false;
    }
    const iqfoc_error_t refused = iqfoc_cycle_init(&d->cycle, &d->config);
    if (refused != IQFOC_OK) {
        return error_failure(e, 0, "the library refused its configuration: iqfoc_error_t %d", (int)refused);
    }
    d->cycle.enabled = true;
    d->control.gain = iq24_from_double(VEC_TWO_PI * BANDWIDTH_HZ * interval_s / pu_per_turn);
    d->control.angle_min = 0;
    d->control.angle_max = IQ24(0.5);
    d->control.discrete_angle = !corrected;
    /* At first along the EMF. */
    const iqfoc_six_step_command_t next =
        iqfoc_cycle_six_step_begin(&d->six, &d->cycle, &d->control, IQ24(0.25), &still);
    *first = drive_answer_of_state(&d->cycle, &next);
    return true;
}

/* Adds an interval to the means over those that are measured, alike long in steady state. */
static void measure(six_step_loop *result, const plant_means *means, double fed_back_A, double angle_turns)
{
    const double share = 1.0 / SIX_STEP_MEASURED;
    result->i_q_A += share * means->i_dq_A.q;
    result->i_d_A += share * means->i_dq_A.d;
    result->i_q_fed_back_A += share * fed_back_A;
    result->angle_deg += share * 360.0 * angle_turns;
}

double six_step_excess_percent(const six_step_loop *l)
{
    return 100.0 * (l->i_q_A / l->reference_A - 1.0);
}

bool six_step_loop_run(bool corrected, six_step_loop *result, error *e)
{
    const motor m = paper_2019_motor();
    const double omega_rad_s = motor_speed_rad_s(&m, SIX_STEP_RPM);
    const double Nm_per_A = 1.5 * m.pole_pairs * m.psi_f_Wb;
    const per_unit base = per_unit_of(&m);
    plant_config config = plant_config_from_motor(&m);
    config.inverter.u_dc_V = SIX_STEP_U_DC;
    six_step_drive d;
    const drive_firmware firmware = {.context = &d, .peak = at_switching};
    drive_loop loop;
    drive_answer first = {.status = 0};
    if (!begin(&d, &m, omega_rad_s, corrected, &first, e)) {
        return false;
    }
    drive_loop_begin(&loop, &m, &config, &firmware);
    plant_set_speed(&loop.drive, omega_rad_s, 0.0);
    drive_loop_put(&loop, &first);
    *result = (six_step_loop){.reference_before_A = 0.3 * base.I_A, .reference_A = 0.5 * base.I_A};
    double t_s = 0.0;
    for (int k = 0; k < SIX_STEP_INTERVALS; k++) {
        const double i_q_ref_A = k < SIX_STEP_STEP_AT ? result->reference_before_A : result->reference_A;
        const iqfoc_dq_t i_ref = {0, iq24_from_double(i_q_ref_A / base.I_A)};
        drive_row row;
        t_s += loop.interval_s;
        if (!drive_loop_span(&loop, i_ref, &row, e)) {
            return false;
        }
        result->trace_t_s[k] = t_s;
        result->trace_q_A[k] = row.truth.i_dq_A.q;
        result->trace_fed_back_A[k] = iq24_to_double(d.cycle.i_dq.q) * base.I_A;
        if (k >= SIX_STEP_INTERVALS - SIX_STEP_MEASURED) {
            measure(result, &row.truth, result->trace_fed_back_A[k],
                    iq24_to_double(iq24_acc_round(d.six.angle)));
        }
    }
    result->torque_Nm = Nm_per_A * result->i_q_A;
    result->torque_reference_Nm = Nm_per_A * result->reference_A;
    return true;
}
