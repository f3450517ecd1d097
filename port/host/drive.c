#include "drive.h"

#include "iqfoc/params.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- The firmware linked into this program ---- */

static bool host_start(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    drive_host *host = context;
    memset(&host->hal, 0, sizeof host->hal);
    host->config = *config;
    const iqfoc_error_t refused = iqfoc_cycle_init(&host->cycle, &host->config);
    if (refused != IQFOC_OK) {
        return error_failure(e, 0, "the library refused its configuration: iqfoc_error_t %d", (int)refused);
    }
    host->cycle.enabled = true;
    return true;
}

static bool host_reference(void *context, iqfoc_dq_t i_ref, error *e)
{
    (void)e;
    ((drive_host *)context)->cycle.i_ref = i_ref;
    return true;
}

static bool host_valley(void *context, const iqfoc_sample_t *sample, error *e)
{
    drive_host *host = context;
    (void)e;
    hal_host_interrupt(&host->hal, sample);
    iqfoc_isr_valley(&host->cycle, &host->hal);
    return true;
}

static bool host_peak(void *context, const iqfoc_sample_t *sample, iqfoc_command_t *command, uint32_t *status,
                      error *e)
{
    drive_host *host = context;
    (void)e;
    hal_host_interrupt(&host->hal, sample);
    iqfoc_isr_peak(&host->cycle, &host->hal);
    *command = host->hal.command;
    *status = host->cycle.status;
    return true;
}

drive_firmware drive_firmware_host(drive_host *host)
{
    const drive_firmware firmware = {host, host_start, host_reference, host_valley, host_peak};
    return firmware;
}

/* ---- Status ---- */

const char *drive_status_text(uint32_t status, char *text, size_t size)
{
    static const struct {
        uint32_t bit;
        const char *name;
    } names[] = {
        {IQFOC_STATUS_MISSED, "MISSED"},
        {IQFOC_STATUS_LATE, "LATE"},
        {IQFOC_STATUS_STALE, "STALE"},
        {IQFOC_STATUS_SAMPLE_CLIPPED, "SAMPLE_CLIPPED"},
        {IQFOC_STATUS_OVERCURRENT, "OVERCURRENT"},
        {IQFOC_STATUS_OVERSPEED, "OVERSPEED"},
        {IQFOC_STATUS_VOLTAGE_LIMIT, "VOLTAGE_LIMIT"},
        {IQFOC_STATUS_DC_LINK, "DC_LINK"},
        {IQFOC_STATUS_NO_INTERVAL, "NO_INTERVAL"},
    };
    size_t used = 0;
    (void)snprintf(text, size, "none");
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        if ((status & names[k].bit) != 0 && used < size) {
            const int wrote =
                snprintf(text + used, size - used, "%s%s", used > 0 ? " | " : "", names[k].name);
            used += wrote > 0 ? (size_t)wrote : 0;
        }
    }
    return text;
}

/* ---- The loop ---- */

typedef struct loop {
    const motor *m;
    const scenario_run *run;
    const drive_firmware *firmware;
    per_unit base;
    plant drive;
    double duty[3]; /* written by the firmware, in force from the next valley */
} loop;

static double electrical_speed(const loop *l, double rpm_mech)
{
    return rpm_mech / 60.0 * IQFOC_TWO_PI_ * l->m->pole_pairs;
}

/* Shaft, load and references for the cycle that begins at t_s. While settling everything stands as at t = 0,
 * unexcited. */
static bool set_cycle(loop *l, double t_s, bool settling, error *e)
{
    const scenario_run *run = l->run;
    const double T_s = l->base.T_s;
    if (settling || run->shaft == SHAFT_GIVEN) {
        const profile *rpm = &run->speed_rpm;
        const double begin = electrical_speed(l, settling ? profile_base_at(rpm, 0.0) : profile_at(rpm, t_s));
        const double end = settling ? begin : electrical_speed(l, profile_at(rpm, t_s + T_s));
        plant_set_speed(&l->drive, begin, (end - begin) / T_s);
    }
    plant_set_load(&l->drive, profile_at(&run->load_Nm, settling ? 0.0 : t_s));
    const double i_d_A = settling ? profile_base_at(&run->i_d_A, 0.0) : profile_at(&run->i_d_A, t_s);
    const double i_q_A = settling ? profile_base_at(&run->i_q_A, 0.0) : profile_at(&run->i_q_A, t_s);
    const iqfoc_dq_t i_ref = {iq24_from_double(i_d_A / l->base.I_A), iq24_from_double(i_q_A / l->base.I_A)};
    return l->firmware->reference(l->firmware->context, i_ref, e);
}

/* One control cycle: what acts is what the firmware wrote in the last one. */
static bool cycle(loop *l, drive_row *row, uint32_t *status, error *e)
{
    const plant_sensors *sensors = &l->drive.config.sensors;
    const drive_firmware *f = l->firmware;
    iqfoc_command_t command;
    memcpy(row->duty, l->duty, sizeof row->duty);
    plant_begin_cycle(&l->drive, l->duty);
    plant_sample(&l->drive, &row->valley);
    const iqfoc_sample_t valley = hal_host_sample(&row->valley, sensors, &l->base, 0);
    if (!f->valley(f->context, &valley, e)) {
        return false;
    }
    plant_advance_to(&l->drive, 0.5 * l->base.T_s);
    plant_sample(&l->drive, &row->peak);
    const iqfoc_sample_t peak = hal_host_sample(&row->peak, sensors, &l->base, IQ24(0.5));
    if (!f->peak(f->context, &peak, &command, status, e)) {
        return false;
    }
    plant_advance_to(&l->drive, l->base.T_s);
    row->truth = plant_mean(&l->drive);
    l->duty[0] = iq24_to_double(command.duties.high.a);
    l->duty[1] = iq24_to_double(command.duties.high.b);
    l->duty[2] = iq24_to_double(command.duties.high.c);
    if (!command.gates) {
        char text[160];
        return error_failure(e, 0, "the firmware stopped the drive in run %ld at %.6f s: %s", row->run,
                             row->valley.t_s, drive_status_text(*status, text, sizeof text));
    }
    return true;
}

bool drive_run(const motor *m, const plant_config *drive, const scenario_run *run, long run_number,
               const iqfoc_cycle_config_t *config, const drive_firmware *firmware, const drive_log *log,
               uint32_t *status, error *e)
{
    loop l = {.m = m, .run = run, .firmware = firmware, .base = per_unit_of(m), .duty = {0.5, 0.5, 0.5}};
    plant_config c = *drive;
    c.shaft.mode = PLANT_SHAFT_GIVEN;
    c.shaft.theta_mech_start_rad = run->theta_mech_start_rad;
    c.shaft.J_kgm2 = run->J_kgm2;
    c.shaft.friction_Nms = run->friction_Nms;
    if (run->u_dc_V > 0.0) {
        c.inverter.u_dc_V = run->u_dc_V;
    }
    if (!plant_config_check(&c, e) || !firmware->start(firmware->context, config, e)) {
        return false;
    }
    plant_init(&l.drive, &c);
    const long cycles = scenario_run_cycles(run, l.base.T_s);
    for (long k = -run->settle_cycles; k < cycles; k++) {
        drive_row row = {.run = run_number};
        uint32_t now = 0;
        if (k == 0 && run->shaft == SHAFT_INERTIA) {
            l.drive.config.shaft.mode = PLANT_SHAFT_INERTIA;
            plant_set_speed(&l.drive, plant_now(&l.drive).omega_e_rad_s, 0.0);
        }
        if (!set_cycle(&l, (double)k * l.base.T_s, k < 0, e) || !cycle(&l, &row, &now, e)) {
            return false;
        }
        *status |= now;
        if (k >= 0 && !log->row(log->context, &row, e)) {
            return false;
        }
    }
    return true;
}
