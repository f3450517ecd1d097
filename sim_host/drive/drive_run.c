/* A run of a scenario (drive_run.h). */
#include "drive_run.h"

iqfoc_dq_t drive_run_cycle(drive_loop *l, const motor *m, const scenario_run *run, long k)
{
    const double T_s = l->base.T_s;
    const double t_s = (double)k * T_s;
    const bool settling = k < 0;
    if (k == 0 && run->shaft == SHAFT_INERTIA) {
        l->drive.config.shaft.mode = PLANT_SHAFT_INERTIA;
        plant_set_speed(&l->drive, plant_now(&l->drive).omega_e_rad_s, 0.0);
    }
    if (settling || run->shaft == SHAFT_GIVEN) {
        const profile *rpm = &run->speed_rpm;
        const double begin =
            motor_speed_rad_s(m, settling ? profile_base_at(rpm, 0.0) : profile_at(rpm, t_s));
        const double end = settling ? begin : motor_speed_rad_s(m, profile_at(rpm, t_s + T_s));
        plant_set_speed(&l->drive, begin, (end - begin) / T_s);
    }
    plant_set_load(&l->drive, profile_at(&run->load_Nm, settling ? 0.0 : t_s));
    const double i_d_A = settling ? profile_base_at(&run->i_d_A, 0.0) : profile_at(&run->i_d_A, t_s);
    const double i_q_A = settling ? profile_base_at(&run->i_q_A, 0.0) : profile_at(&run->i_q_A, t_s);
    const iqfoc_dq_t i_ref = {iq24_from_double(i_d_A / l->base.I_A), iq24_from_double(i_q_A / l->base.I_A)};
    return i_ref;
}

bool drive_run_stopped(const drive_row *row, error *e)
{
    char text[160];
    return !row->answer.command.gates &&
           !error_failure(e, 0, "the firmware stopped the drive in run %ld at %.6f s: %s", row->run,
                          row->valley.t_s, drive_status_text(row->answer.status, text, sizeof text));
}

bool drive_run_begin(drive_loop *l, const motor *m, const plant_config *drive, const scenario_run *run,
                     const iqfoc_cycle_config_t *config, const drive_firmware *firmware, error *e)
{
    plant_config c = *drive;
    c.shaft.mode = PLANT_SHAFT_GIVEN;
    c.shaft.theta_mech_start_rad = run->theta_mech_start_rad;
    c.shaft.J_kgm2 = run->J_kgm2;
    c.shaft.friction_Nms = run->friction_Nms;
    c.clock_s -= (double)run->settle_cycles * c.T_s;
    if (run->u_dc_V > 0.0) {
        c.inverter.u_dc_V = run->u_dc_V;
    }
    if (!plant_config_check(&c, e) || !firmware->start(firmware->context, config, e)) {
        return false;
    }
    drive_loop_begin(l, m, &c, firmware);
    l->halves = run->halves;
    drive_loop_update(l, &run->pwm);
    return true;
}

bool drive_run(const motor *m, const plant_config *drive, const scenario_run *run, long run_number,
               const iqfoc_cycle_config_t *config, const drive_firmware *firmware, const drive_log *log,
               uint32_t *status, error *e)
{
    drive_loop l;
    if (!drive_run_begin(&l, m, drive, run, config, firmware, e)) {
        return false;
    }
    const long cycles = scenario_run_cycles(run, l.base.T_s);
    for (long k = -run->settle_cycles; k < cycles; k++) {
        drive_row row = {.run = run_number};
        const iqfoc_dq_t i_ref = drive_run_cycle(&l, m, run, k);
        if (!drive_loop_span(&l, i_ref, &row, e) || drive_run_stopped(&row, e)) {
            return false;
        }
        *status |= row.answer.status;
        if (k >= 0 && !log->row(log->context, &row, e)) {
            return false;
        }
    }
    return true;
}
