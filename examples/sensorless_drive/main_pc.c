/*
 * The drive without an angle sensor on the PC, against the simulated drive: from standstill to the top speed and back.
 * sensorless_drive M.toml. It prints time, speed and the error of the observed angle; exit status 1 if the drive fails.
 */
#include "drive/drive_loop.h"
#include "sensorless_drive.h"

#include <math.h>
#include <stdio.h>

enum { CYCLES = 20000, PRINTED = 1000 };

typedef struct firmware {
    sensorless_drive_t drive;
    iqfoc_hal_t hal;
} firmware;

static bool valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    firmware *f = context;
    (void)i_ref; /* the firmware's own */
    (void)e;
    hal_host_interrupt(&f->hal, sample);
    sensorless_drive_valley(&f->drive, &f->hal);
    return true;
}

static bool peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                 error *e)
{
    firmware *f = context;
    (void)i_ref;
    (void)e;
    hal_host_interrupt(&f->hal, sample);
    sensorless_drive_peak(&f->drive, &f->hal);
    answer->command = f->hal.command;
    answer->status = f->drive.cycle.status;
    return true;
}

/* The observed angle minus the true one, degrees. */
static double angle_error(const firmware *f, const drive_row *row)
{
    const double observed = iq24_to_double(iqfoc_observer_theta(&f->drive.angle.observer, 0));
    return 360.0 * remainder(observed - row->valley.theta_e_rad / VEC_TWO_PI, 1.0);
}

static bool run(const motor *m, error *e)
{
    static firmware f;
    const drive_firmware calls = {&f, NULL, valley, peak};
    drive_loop loop;
    plant_config truth = plant_config_from_motor(m);
    truth.shaft = (plant_shaft){
        .mode = PLANT_SHAFT_INERTIA, .J_kgm2 = 1e-3, .friction_Nms = 2e-3, .theta_mech_start_rad = 0.5};
    truth.sensors.current_bits = 12;
    truth.sensors.current_full_scale_A = 30.0;
    truth.sensors.current_noise_A = 0.05;
    if (!plant_config_check(&truth, e)) {
        return false;
    }
    if (!sensorless_drive_begin(&f.drive, (uint32_t)HAL_HOST_TICKS_PER_S)) {
        return error_failure(e, 0, "the library refused a configuration");
    }
    drive_loop_begin(&loop, m, &truth, &calls);
    double most = 0.0;
    double highest_rpm = 0.0;
    printf("   t, s   speed, rpm   angle   error, degrees\n");
    for (long k = 0; k < CYCLES; k++) {
        const iqfoc_dq_t none = {0, 0};
        drive_row row = {.run = 1};
        f.drive.target = k < 14000 ? SENSORLESS_DRIVE_TURNS(8000.0) : SENSORLESS_DRIVE_TURNS(600.0);
        if (!drive_loop_span(&loop, none, &row, e)) {
            return false;
        }
        const bool observed = f.drive.angle.source == IQFOC_ANGLE_OBSERVED;
        const double rpm = row.valley.omega_e_rad_s / m->pole_pairs * 60.0 / VEC_TWO_PI;
        highest_rpm = fmax(highest_rpm, rpm);
        most = observed ? fmax(most, fabs(angle_error(&f, &row))) : most;
        if (k % PRINTED == 0) {
            printf("%7.2f %12.0f   %-9s %6.2f\n", row.valley.t_s, rpm, observed ? "observed" : "open loop",
                   observed ? angle_error(&f, &row) : 0.0);
        }
        if (f.drive.cycle.tripped) {
            char text[160];
            return error_failure(e, 0, "the drive stopped at %.3f s: %s", row.valley.t_s,
                                 drive_status_text(row.answer.status, text, sizeof text));
        }
    }
    printf("top speed %.0f rpm, observed angle at most %.1f degrees off\n", highest_rpm, most);
    return (highest_rpm > 7900.0 && highest_rpm < 8400.0 && most < 5.0) ||
           error_failure(e, 0, "it did not run as it should");
}

int main(int argc, char **argv)
{
    error e = {0, ""};
    motor m;
    if (argc != 2) {
        fprintf(stderr, "usage: sensorless_drive M.toml\n");
        return 2;
    }
    return motor_read(argv[1], &m, &e) && run(&m, &e) ? 0 : error_print(&e);
}
