/* PI control on the observed angle (sensorless_loops.h). */
#include "sensorless_loops.h"

#include "base/json_file.h"
#include "base/spread.h"
#include "base/vector.h"
#include "reproduce/paper_2019.h"

#include <math.h>

const double sensorless_ratios[SENSORLESS_RATIOS] = {3.5, 5.0, 6.0, 8.0, 10.0, 12.5, 20.0, 50.0};
const double sensorless_loads[SENSORLESS_LOADS] = {0.0, 0.5, 1.0};

#define NOISE       0.005
#define BITS        12
#define DEAD_SHARE  0.005 /* of a carrier period */
#define CYCLES      1200.0
#define COUNT_FROM  (LOOP_SETTLE_CYCLES + LOOP_TRANSIENT_CYCLES)
#define FULL_SCALES 2.0 /* of the sensors, rated peaks */

/* The drive as its motor file has it. */
static motor motor_at(double ratio)
{
    motor m = paper_2019_motor();
    m.n_max_rpm = SENSORLESS_RPM;
    m.f_pwm_Hz = ratio * SENSORLESS_RPM / 60.0 * m.pole_pairs;
    m.ext.has[CAUSE_DEAD_TIME] = true;
    m.ext.v_dead_V = DEAD_SHARE * m.u_dc_V;
    return m;
}

static plant_config drive_at(const motor *m)
{
    plant_config drive = plant_config_from_motor(m);
    drive.inverter.t_dead_s = DEAD_SHARE / m->f_pwm_Hz;
    drive.sensors.current_bits = BITS;
    drive.sensors.current_full_scale_A = FULL_SCALES * motor_rated_peak_A(m);
    drive.sensors.current_noise_A = NOISE * motor_rated_peak_A(m);
    drive.seed = LOOP_SEED;
    return drive;
}

/* The firmware, and what its observer makes of the measured angle, which is the true one. */
typedef struct watched_host {
    drive_host host;
    drive_firmware firmware;
    long cycle;
    spread off_deg, faster; /* observed minus true angle; share of the speed */
    bool locked;
} watched_host;

static bool take_valley(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e)
{
    watched_host *w = context;
    const bool ok = w->firmware.valley(w->firmware.context, i_ref, sample, e);
    if (w->host.observed && w->cycle++ >= COUNT_FROM) {
        const double off = 360.0 * iq24_to_double(w->host.sensorless.difference);
        const double turns = iq24_to_double(sample->speed);
        const double faster =
            iq24_to_double(iqfoc_observer_speed(&w->host.sensorless.observer)) / turns - 1.0;
        spread_add(&w->off_deg, off);
        spread_add(&w->faster, faster);
        w->locked = w->locked && w->host.sensorless.source == IQFOC_ANGLE_OBSERVED &&
                    w->host.sensorless.observer.locked;
    }
    return ok;
}

static bool give_peak(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                      error *e)
{
    watched_host *w = context;
    return w->firmware.peak(w->firmware.context, i_ref, sample, answer, e);
}

/* i_q: before and after the step, shares of the rated peak. */
static bool run(double ratio, double before, double after, bool observed, sensorless_loop *result, error *e)
{
    const scenario_control control = {.feedback = FEEDBACK_QUASI_DISCRETE_MEAN, .modulation = MODULATION_PWM};
    const motor m = motor_at(ratio);
    const plant_config drive = drive_at(&m);
    const double rated_A = motor_rated_peak_A(&m);
    const loop_case c = {.truth = m,
                         .drive = &drive,
                         .omega_e_rad_s = motor_speed_rad_s(&m, SENSORLESS_RPM),
                         .i_q_before_A = before * rated_A,
                         .i_q_after_A = after * rated_A,
                         .periods = (int)(CYCLES / ratio)};
    iqfoc_cycle_config_t config;
    watched_host w = {.cycle = 0, .locked = true};
    w.firmware = drive_firmware_host(&w.host, NULL);
    if ((observed && !drive_host_observe(&w.host, &m, e)) || !config_from_motor(&m, &control, &config, e)) {
        return false;
    }
    config.trips = 0;
    const drive_firmware firmware = {&w, NULL, take_valley, give_peak};
    if (!w.firmware.start(w.firmware.context, &config, e) ||
        !closed_loop_run(&c, &firmware, &result->loop, e)) {
        return false;
    }
    result->bias_deg = spread_mean(&w.off_deg);
    result->rms_deg = spread_deviation(&w.off_deg);
    result->speed_percent = 100.0 * spread_rms(&w.faster);
    result->locked = w.locked && result->loop.outcome != LOOP_TRIPS;
    return true;
}

static bool run_step(sensorless_loops *all, int k, error *e)
{
    sensorless_loop measured;
    sensorless_loop observed;
    if (!run(sensorless_ratios[k], 0.0, 1.0, false, &measured, e) ||
        !run(sensorless_ratios[k], 0.0, 1.0, true, &observed, e)) {
        return false;
    }
    all->overshoot_measured[k] = measured.loop.overshoot_percent;
    all->overshoot_observed[k] = observed.loop.overshoot_percent;
    for (int n = 0; n < LOOP_TRACE_CYCLES; n++) {
        const double apart = fabs(observed.loop.trace_q[n] - measured.loop.trace_q[n]);
        all->step_percent[k] = fmax(all->step_percent[k], 100.0 * apart);
    }
    return true;
}

bool sensorless_loops_run(sensorless_loops *all, error *e)
{
    *all = (sensorless_loops){.step_percent = {0.0}};
    for (int k = 0; k < SENSORLESS_RATIOS; k++) {
        for (int n = 0; n < SENSORLESS_LOADS; n++) {
            const double load = sensorless_loads[n];
            if (!run(sensorless_ratios[k], load, load, true, &all->at[k][n], e)) {
                return false;
            }
        }
        if (!run_step(all, k, e)) {
            return false;
        }
    }
    return true;
}

void sensorless_loops_print(const sensorless_loops *all, FILE *f)
{
    fprintf(f,
            "\nPI on the observed angle at %g rpm, quasi-discrete mean; step of i_q from 0 to rated, percent "
            "of the "
            "step\n  %5s%8s%12s%12s%12s%8s%22s%22s%12s\n",
            SENSORLESS_RPM, "SFFR", "load, %", "bias, deg", "rms, deg", "speed, %", "lock",
            "overshoot, measured", "overshoot, observed", "difference");
    for (int k = 0; k < SENSORLESS_RATIOS; k++) {
        for (int n = 0; n < SENSORLESS_LOADS; n++) {
            const sensorless_loop *l = &all->at[k][n];
            fprintf(f, "  %5g%8g%12.3f%12.3f%12.4f%8s", sensorless_ratios[k], 100.0 * sensorless_loads[n],
                    l->bias_deg, l->rms_deg, l->speed_percent, l->locked ? "held" : "lost");
            if (n == SENSORLESS_LOADS - 1) {
                fprintf(f, "%22.1f%22.1f%12.2f", all->overshoot_measured[k], all->overshoot_observed[k],
                        all->step_percent[k]);
            }
            fputc('\n', f);
        }
    }
}

json_t *sensorless_loops_json(const sensorless_loops *all)
{
    json_t *list = json_array();
    for (int row = 0; row < SENSORLESS_RATIOS * SENSORLESS_LOADS && list != NULL; row++) {
        const int k = row / SENSORLESS_LOADS;
        const int n = row % SENSORLESS_LOADS;
        const sensorless_loop *l = &all->at[k][n];
        const bool steps = n == SENSORLESS_LOADS - 1;
        json_t *o =
            json_pack("{s:f, s:f, s:b, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "sffr", sensorless_ratios[k],
                      "load", sensorless_loads[n], "locked", (int)l->locked, "outcome",
                      loop_outcome_text(l->loop.outcome), "bias_deg", json_number(l->bias_deg), "rms_deg",
                      json_number(l->rms_deg), "speed_rms_percent", json_number(l->speed_percent),
                      "overshoot_measured_percent", json_number(steps ? all->overshoot_measured[k] : NAN),
                      "overshoot_observed_percent", json_number(steps ? all->overshoot_observed[k] : NAN),
                      "step_difference_percent", json_number(steps ? all->step_percent[k] : NAN));
        list = json_appended(list, o);
    }
    return list;
}

void sensorless_loops_part(page *p, const sensorless_loops *all)
{
    static const char *const heads[] = {"\tSFFR",
                                        "\tload, %",
                                        "\tangle: bias, degrees",
                                        "\trms",
                                        "\tspeed: rms, %",
                                        "\tovershoot, measured angle, %",
                                        "\tobserved angle",
                                        "\tlargest difference, %"};
    page_heading(p, 2, "Without an angle sensor");
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int k = 0; k < SENSORLESS_RATIOS; k++) {
        for (int n = 0; n < SENSORLESS_LOADS; n++) {
            const sensorless_loop *l = &all->at[k][n];
            page_row_begin(p);
            page_cell(p, true, "%g", sensorless_ratios[k]);
            page_cell(p, true, "%g", 100.0 * sensorless_loads[n]);
            page_cell(p, true, "%.2f%s", l->bias_deg, l->locked ? "" : ", lock lost");
            page_cell(p, true, "%.2f", l->rms_deg);
            page_cell(p, true, "%.3f", l->speed_percent);
            if (n == SENSORLESS_LOADS - 1) {
                page_cell(p, true, "%.1f", all->overshoot_measured[k]);
                page_cell(p, true, "%.1f", all->overshoot_observed[k]);
                page_cell(p, true, "%.1f", all->step_percent[k]);
            } else {
                for (int column = 0; column < 3; column++) {
                    page_cell(p, true, "%s", "");
                }
            }
            page_row_end(p);
        }
    }
    page_table_end(p);
    page_note(p,
              "PI with the quasi-discrete mean at %g rpm, sensors of 12 bit with noise, dead time "
              "compensated in the "
              "observer. The last columns are for a step of i_q from 0 to the rated current, in percent of "
              "the step.",
              SENSORLESS_RPM);
}
