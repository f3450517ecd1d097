/* The run-up through overmodulation into six-step and down again (run_up.h). */
#include "run_up.h"

#include "drive/drive_loop.h"
#include "reproduce/paper_2019.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BANDWIDTH_HZ    250.0
#define WEAKENING_PER_S 120.0
#define REVERSAL_S      0.07 /* around the top, left out: the reversal steps the set-point */
#define TOP_RPM         7900.0
#define TIMER_HZ        30.0
#define TO_TIMER        0.13 /* of the rated current, weakening */
#define TO_CARRIER      0.03
#define SIX_STEP_LENGTH 0.625 /* of 0.63 to 0.633, its largest at these speeds */

const run_up_case run_up_cases[RUN_UP_CASES] = {
    {"linear modulation", "linear", IQFOC_MODULATION_PWM, false, 0.98, 0.0, 0.0, false},
    {"to six-step", "six_step", IQFOC_MODULATION_OVER, false, 1.0, 0.0, 0.0, false},
    {"to six-step, link +-1 % at 300 Hz", "six_step_300", IQFOC_MODULATION_OVER, false, 1.0, 0.01, 300.0,
     false},
    {"to six-step, link +-1 % at 100 Hz", "six_step_100", IQFOC_MODULATION_OVER, false, 1.0, 0.01, 100.0,
     false},
    {"overmodulation, 98 %", "over_98", IQFOC_MODULATION_OVER, false, 0.98, 0.0, 0.0, false},
    {"to six-step, mid-point sample", "midpoint", IQFOC_MODULATION_OVER, true, 1.0, 0.0, 0.0, false},
    {"to six-step by a timer", "timer", IQFOC_MODULATION_OVER, false, 1.0, 0.0, 0.0, true},
    {"by a timer, link +-1 % at 300 Hz", "timer_300", IQFOC_MODULATION_OVER, false, 1.0, 0.01, 300.0, true},
    {"by a timer, link +-1 % at 100 Hz", "timer_100", IQFOC_MODULATION_OVER, false, 1.0, 0.01, 100.0, true},
    {"to six-step, link +-2 % at 300 Hz", "ripple_2", IQFOC_MODULATION_OVER, false, 1.0, 0.02, 300.0, false},
    {"to six-step, link +-3 % at 300 Hz", "ripple_3", IQFOC_MODULATION_OVER, false, 1.0, 0.03, 300.0, false},
    {"to six-step, link +-5 % at 300 Hz", "ripple_5", IQFOC_MODULATION_OVER, false, 1.0, 0.05, 300.0, false}};

/* A record of each cycle, and of each state by a timer. */
typedef struct cycle_row {
    double t_s, duration_s, rpm, i_d, i_q, asked, voltage;
    int switched_on; /* legs */
    bool by_timer;
} cycle_row;

typedef struct history {
    cycle_row *row;
    long count, capacity;
    long reversal;
    double T_s; /* control cycle */
} history;

/* How many legs were switched on in a cycle: by a pulse within it, or at its valley, to stay on. */
static int switched_on(const drive_row *row, const double before[3])
{
    int on = 0;
    for (int x = 0; x < 3; x++) {
        const bool pulse = row->duty[x] > 0.0 && row->duty[x] < 1.0;
        on += pulse || (row->duty[x] >= 1.0 && before[x] < 1.0) ? 1 : 0;
    }
    return on;
}

/* Up with the rated torque until the top is reached, then down with the same. */
static bool drive_up_and_down(const run_up_case *c, const motor *m, drive_loop *l, const torque_drive *d,
                              history *h, error *e)
{
    bool up = true;
    double before[3] = {0.5, 0.5, 0.5};
    while (h->count < h->capacity) {
        const plant_point now = plant_now(&l->drive);
        cycle_row *at = &h->row[h->count];
        drive_row row;
        at->rpm = now.omega_e_rad_s / motor_speed_rad_s(m, 1.0);
        at->t_s = now.t_s;
        if (up && at->rpm >= RUN_UP_RPM) {
            up = false;
            h->reversal = h->count;
        }
        if (!up && at->rpm <= 0.0) {
            return true;
        }
        at->asked = up ? 1.0 : -1.0;
        const bool by_timer = l->interval_s > 0.0;
        const iqfoc_dq_t torque = {0, iq24_from_double(at->asked)};
        if (!drive_loop_span(l, torque, &row, e)) {
            return false;
        }
        at->i_d = row.truth.i_dq_A.d / l->base.I_A;
        at->i_q = row.truth.i_dq_A.q / l->base.I_A;
        at->voltage = torque_drive_voltage(d, row.peak.u_dc_V / l->base.U_V);
        at->duration_s = row.truth.duration_s;
        at->by_timer = by_timer;
        at->switched_on = switched_on(&row, before);
        memcpy(before, row.duty, sizeof before);
        h->count++;
    }
    return error_failure(e, 0, "run-up, %s: not up and down again within %ld cycles", c->text, h->capacity);
}

/* The weight of a row in the bell around another: cos^2, as long as RUN_UP_BELL cycles; 0 outside. */
static double bell(const cycle_row *at, const cycle_row *middle, double T_s)
{
    const double off_s = at->t_s + 0.5 * at->duration_s - middle->t_s - 0.5 * middle->duration_s;
    const double c = cos(VEC_PI * off_s / ((RUN_UP_BELL + 1.0) * T_s));
    return fabs(off_s) < 0.5 * (RUN_UP_BELL + 1.0) * T_s ? c * c * at->duration_s : 0.0;
}

static run_up_point smoothed(const history *h, long k)
{
    run_up_point p = {.t_s = h->row[k].t_s, .rpm = h->row[k].rpm, .asked = h->row[k].asked};
    double weights = 0.0;
    for (int n = -RUN_UP_BELL / 2; n <= RUN_UP_BELL / 2; n++) {
        if (k + n < 0 || k + n >= h->count) {
            continue;
        }
        const cycle_row *at = &h->row[k + n];
        const double w = bell(at, &h->row[k], h->T_s);
        weights += w;
        p.torque += w * at->i_q; /* the machine has no saliency */
        p.i_q += w * at->i_q;
        p.i_d += w * at->i_d;
        p.voltage += w * at->voltage;
    }
    p.torque /= weights;
    p.i_q /= weights;
    p.i_d /= weights;
    p.voltage /= weights;
    return p;
}

/* The speed on the way up above which the voltage stays above `voltage`. */
static double reached_at_rpm(const history *h, double voltage)
{
    double rpm = NAN;
    for (long k = h->reversal - lround(0.5 * RUN_UP_BELL); k >= RUN_UP_BELL; k--) {
        const run_up_point p = smoothed(h, k);
        if (p.voltage < voltage) {
            break;
        }
        rpm = p.rpm;
    }
    return rpm;
}

static double pulses_at_the_top(const history *h)
{
    double turns = 0.0;
    double pulses = 0.0;
    for (long k = 0; k < h->reversal; k++) {
        if (h->row[k].rpm > TOP_RPM) {
            pulses += h->row[k].switched_on / 3.0;
            turns +=
                (h->row[k + 1].t_s - h->row[k].t_s) * h->row[k].rpm / 60.0 * paper_2019_motor().pole_pairs;
        }
    }
    return pulses / turns;
}

static void measure(const history *h, run_up *r)
{
    const double reversal_s = h->row[h->reversal].t_s;
    *r = (run_up){.top_rpm = 0.0, .to_timer_rpm = NAN, .to_carrier_rpm = NAN};
    for (long k = 0; k < h->count; k++) {
        const cycle_row *at = &h->row[k];
        r->top_rpm = fmax(r->top_rpm, at->rpm);
        r->i_most = fmax(r->i_most, hypot(at->i_d, at->i_q));
        if (at->rpm < RUN_UP_FROM_RPM) {
            continue;
        }
        const run_up_point p = smoothed(h, k);
        r->i_d_least = fmin(r->i_d_least, p.i_d);
        r->voltage_most = fmax(r->voltage_most, p.voltage);
        if (fabs(h->row[k].t_s - reversal_s) > REVERSAL_S - 0.5 * h->T_s) {
            const double off =
                100.0 * (p.torque - p.asked) * p.asked; /* more of it in its own direction: up */
            r->step_up_percent = fmax(r->step_up_percent, off);
            r->step_down_percent = fmin(r->step_down_percent, off);
        }
    }
    for (long k = 1; k < h->count; k++) {
        if (h->row[k].by_timer != h->row[k - 1].by_timer) {
            r->transitions++;
            if (h->row[k].by_timer && isnan(r->to_timer_rpm)) {
                r->to_timer_rpm = h->row[k].rpm;
            } else if (h->row[k - 1].by_timer) {
                r->to_carrier_rpm = h->row[k].rpm;
            }
        }
    }
    r->points = RUN_UP_POINTS;
    for (int n = 0; n < RUN_UP_POINTS; n++) {
        r->point[n] = smoothed(h, n * (h->count - 1) / (RUN_UP_POINTS - 1));
    }
    r->pulses_top = pulses_at_the_top(h);
    r->linear_to_rpm = reached_at_rpm(h, 1.0 / sqrt(3.0));
    r->six_step_from_rpm = reached_at_rpm(h, SIX_STEP_LENGTH);
}

double run_up_step_percent(const run_up *r)
{
    return fmax(r->step_up_percent, -r->step_down_percent);
}

static bool run_one(const run_up_case *c, run_up *result, error *e)
{
    const motor m = paper_2019_motor();
    const double rated_A = sqrt(2.0) * m.I_rated_A_rms;
    const torque_limits limits = {.i_max_A = 1.5 * rated_A,
                                  .i_d_min_A = -rated_A,
                                  .share = c->share,
                                  .bandwidth_Hz = BANDWIDTH_HZ,
                                  .weakening_per_s = WEAKENING_PER_S,
                                  .u_dc_V = RUN_UP_U_DC,
                                  .timer_Hz = c->by_timer ? TIMER_HZ : 0.0,
                                  .i_d_to_timer_A = -TO_TIMER * rated_A,
                                  .i_d_to_carrier_A = -TO_CARRIER * rated_A};
    plant_config config = plant_config_from_motor(&m);
    config.inverter.u_dc_V = RUN_UP_U_DC;
    config.inverter.ripple_V = c->ripple * RUN_UP_U_DC;
    config.inverter.ripple_Hz = c->ripple_Hz;
    config.inverter.ripple_logged = true;
    config.shaft.mode = PLANT_SHAFT_INERTIA;
    config.shaft.J_kgm2 = RUN_UP_J_KGM2;
    torque_drive d;
    const drive_firmware firmware = torque_drive_firmware(&d);
    const iqfoc_methods_t methods = {IQFOC_MODEL_QUASI_DISCRETE,
                                     c->midpoint ? IQFOC_FEEDBACK_MIDPOINT
                                                 : IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
                                     IQFOC_CONTROL_PI, c->modulation, false};
    if (!plant_config_check(&config, e) || !torque_drive_init(&d, &m, &limits, methods, e)) {
        return false;
    }
    drive_loop loop;
    drive_loop_begin(&loop, &m, &config, &firmware);
    history h = {.capacity = 40000, .T_s = loop.base.T_s};
    h.row = malloc((size_t)h.capacity * sizeof *h.row);
    if (h.row == NULL) {
        return error_failure(e, 0, "out of memory for the run-up");
    }
    const bool ok = drive_up_and_down(c, &m, &loop, &d, &h, e);
    if (ok) {
        measure(&h, result);
    }
    free(h.row);
    return ok;
}

bool run_ups_run(run_up result[RUN_UP_CASES], error *e)
{
    for (int n = 0; n < RUN_UP_CASES; n++) {
        if (!run_one(&run_up_cases[n], &result[n], e)) {
            return false;
        }
    }
    return true;
}
