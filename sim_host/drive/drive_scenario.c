/* All runs of a scenario as one recording (drive_scenario.h). */
#include "drive_scenario.h"

#include "base/progress.h"
#include "corrected_mean.h"

motor drive_scenario_motor(const motor *m, const scenario *s)
{
    motor with_updates = *m;
    with_updates.f_pwm_Hz *= s->control.updates == 2 ? 2.0 : 1.0;
    return with_updates;
}

bool drive_scenario_plain(const scenario *s, const char *path, error *e)
{
    if (s->control.updates == 2) {
        return error_input(
            e, path, 0, 0,
            "updates = 2: only `iqfoc simulate` without --target runs two updates a carrier period");
    }
    if (s->control.modulation == MODULATION_PATTERN) {
        return error_input(
            e, path, 0, 0,
            "modulation = \"pattern\": only `iqfoc simulate` without --target runs pulse patterns");
    }
    return s->control.angle == ANGLE_MEASURED ||
           error_input(
               e, path, 0, 0,
               "angle = \"observed\": only `iqfoc simulate` without --target runs on the observed angle");
}

plant_config drive_scenario_plant(const motor *m, const scenario *s)
{
    const motor with_updates = drive_scenario_motor(m, s);
    plant_config c = plant_config_from_motor(&with_updates);
    c.sensors.current_bits = s->sensors.current_bits;
    c.sensors.current_full_scale_A = s->sensors.current_full_scale_A;
    c.sensors.current_noise_A = s->sensors.current_noise_A;
    c.sensors.current_bandwidth_Hz = s->sensors.current_bandwidth_Hz;
    c.sensors.angle_noise_rad = s->sensors.angle_noise_rad;
    c.sensors.omega_noise_rad_s = s->sensors.speed_noise_rad_s;
    c.sensors.u_dc_noise_V = s->sensors.u_dc_noise_V;
    for (int x = 0; x < 3; x++) {
        c.sensors.current_offset_A[x] = s->sensors.current_offset_A[x];
    }
    return c;
}

uint64_t drive_scenario_seed(long seed, size_t n)
{
    return (uint64_t)seed * 1000003U + n;
}

/* Each run has noise of its own, and begins when the one before has ended. */
static bool run_one(const drive_scenario *all, size_t k, const iqfoc_cycle_config_t *config,
                    drive_recording *out, error *e)
{
    const drive_log log = drive_recording_log(out);
    plant_config c = *all->plant;
    uint32_t status = 0;
    c.seed = drive_scenario_seed(all->seed, k);
    c.clock_s = drive_recording_next_s(out);
    if (!drive_run(all->motor, &c, &all->scenario->run[k], (long)k + 1, config, all->firmware, &log, &status,
                   e)) {
        return false;
    }
    status &= ~IQFOC_STATUS_NO_INTERVAL; /* set at every start with a corrected mean */
    if (status != 0 && all->note != NULL) {
        all->note(all->context, k + 1, status);
    }
    return true;
}

bool drive_scenario_run(const drive_scenario *all, drive_recording *out, error *e)
{
    iqfoc_cycle_config_t config;
    scenario logged = *all->scenario;
    logged.log.temperature = all->plant->machine.heating_K != 0.0;
    *out = (drive_recording){.run = 0};
    bool good = drive_recording_begin(out, &logged, all->plant->T_s, e) &&
                config_from_motor(all->motor, &all->scenario->control, &config, e) &&
                corrected_mean_fits(all->motor, all->scenario, e);
    progress p = progress_begin("simulate", (double)all->scenario->runs, "runs");
    for (size_t k = 0; good && k < all->scenario->runs; k++) {
        good = run_one(all, k, &config, out, e);
        progress_update(&p, (double)(k + 1));
    }
    progress_end(&p);
    return good;
}
