/* Six-step torque control (six_step_loop.h): its controller as firmware, in the simulator's loop. */
#include "six_step_loop.h"

#include "drive/drive_loop.h"
#include "reproduce/paper_2019.h"

#include "iqfoc/mean_current.h"
#include "iqfoc/modulation.h"

#include <string.h>

/* Bandwidth of the angle's control: slow against the resonance at the fundamental that a winding has in the
 * rotor frame, damped by R/L = 144 1/s alone. */
#define BANDWIDTH_HZ 10.0

/* The firmware's state. */
typedef struct angle_control {
    double omega_rad_s;         /* what its timer is set by */
    iqfoc_current_control_t pi; /* its q axis: out comes the voltage's angle in turns */
    iqfoc_current_control_gains_t gains;
    int32_t state;      /* of the interval that runs, 0 ... 5 */
    iq24_t theta_start; /* at its start */
    iqfoc_ab_t i_start;
    iq24_t angle;        /* of the voltage ahead of the d axis */
    iqfoc_dq_t fed_back; /* what the controller was fed with */
    bool corrected;
} angle_control;

/* In turns: from a rotor angle to the end of the state's sector, where the voltage's angle is half a sector
 * past the state. More than a sector if the angle has just been taken back; never less than a hundredth of
 * one, so that a timer can be set. */
static iq24_t turns_to_go(const angle_control *c, iq24_t theta)
{
    const iq24_t end = (c->state * IQ24_ONE + IQ24_ONE / 2) / 6;
    const iq24_t turn = (end - theta - c->angle) & 0xFFFFFF;
    const iq24_t rest = turn < IQ24_ONE / 2 ? turn : turn - IQ24_ONE;
    return iq24_clamp(rest, IQ24_ONE / 600, IQ24_ONE / 3);
}

/* The state that is to come and how long it stands, seen from the rotor's angle at its start. */
static void command_state(const angle_control *c, iq24_t theta, drive_answer *answer)
{
    answer->command.duties = iqfoc_six_step_duties(c->state);
    answer->command.gates = true;
    answer->interval_s = iq24_to_double(turns_to_go(c, theta)) * VEC_TWO_PI / c->omega_rad_s;
}

/* The interval has ended: feedback, control, next state. */
static bool at_switching(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                         error *e)
{
    angle_control *c = context;
    (void)e;
    const iqfoc_ab_t i = iqfoc_clarke3(sample->i);
    const iqfoc_ab_t mean = iqfoc_clarke3(sample->i_mean);
    const iqfoc_ab_t delta = {iq24_sub_wrap(i.alpha, c->i_start.alpha),
                              iq24_sub_wrap(i.beta, c->i_start.beta)};
    const iq24_t covered = (sample->theta - c->theta_start) & 0xFFFFFF;
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(covered);
    const iq24_sincos_t sc_mid = iq24_sincos(c->theta_start + covered / 2);
    c->fed_back =
        c->corrected ? iqfoc_mean_current_correct(mean, delta, &rotor, sc_mid) : iqfoc_park(mean, sc_mid);
    c->angle = iqfoc_current_control_step(&c->pi, &c->gains, i_ref, c->fed_back).q;
    c->state = (c->state + 1) % 6;
    c->theta_start = sample->theta;
    c->i_start = i;
    command_state(c, sample->theta, answer);
    return true;
}

static angle_control control_of(const motor *m, const per_unit *base, double omega_rad_s, bool corrected)
{
    /* i_q answers to the voltage's angle by U/(omega L) per radian, U = (2/pi) u_dc the fundamental. */
    const double u_V = 2.0 / VEC_PI * SIX_STEP_U_DC;
    const double pu_per_turn = VEC_TWO_PI * u_V / (omega_rad_s * m->L_q_H) / base->I_A;
    const double interval_s = VEC_TWO_PI / omega_rad_s / 6.0;
    angle_control c;
    memset(&c, 0, sizeof c);
    c.omega_rad_s = omega_rad_s;
    c.corrected = corrected;
    c.gains.ki_q = iq24_from_double(VEC_TWO_PI * BANDWIDTH_HZ * interval_s / pu_per_turn);
    c.angle = IQ24(0.25); /* along the EMF */
    c.pi.integral_q = iq24_acc_mul(c.angle, IQ24_ONE);
    c.state = 2; /* 120 degrees: the nearest to 90 whose sector has not ended at theta = 0 */
    return c;
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
    angle_control c = control_of(&m, &base, omega_rad_s, corrected);
    const drive_firmware firmware = {.context = &c, .peak = at_switching};
    drive_loop loop;
    drive_answer first = {.status = 0};
    drive_loop_begin(&loop, &m, &config, &firmware);
    plant_set_speed(&loop.drive, omega_rad_s, 0.0);
    command_state(&c, 0, &first);
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
        result->trace_fed_back_A[k] = iq24_to_double(c.fed_back.q) * base.I_A;
        if (k >= SIX_STEP_INTERVALS - SIX_STEP_MEASURED) {
            measure(result, &row.truth, result->trace_fed_back_A[k], iq24_to_double(c.angle));
        }
    }
    result->torque_Nm = Nm_per_A * result->i_q_A;
    result->torque_reference_Nm = Nm_per_A * result->reference_A;
    return true;
}
