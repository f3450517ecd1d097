/*
 * The calls that the sliders make: the errors of mean and prediction over the frequency ratio, the loop's step, the observer's
 * angle error; and the golden hash.
 */
#include "page.h"

#include "base/vector.h"
#include "golden_hash.h"
#include "loops/current_loops.h"
#include "reproduce/paper_2019.h"
#include "reproduce/sweep.h"
#include "tune/tune_design.h"
#include "tune/tune_margins.h"
#include "tune/tune_sensorless.h"

#include <inttypes.h>
#include <stdio.h>

enum { RATIOS_MAX = 64, NAME_SIZE = 256 };

static char names[PAGE_NAMES][NAME_SIZE];

__attribute__((export_name("page_name_at"))) char *page_name_at(int which)
{
    return which >= 0 && which < PAGE_NAMES ? names[which] : NULL;
}

const char *page_name_of(page_name which)
{
    return names[which];
}

int page_answer(bool ok, json_t *json, const error *e)
{
    if (ok) {
        json_print(stdout, json);
        fputc('\n', stdout);
    }
    json_free(json);
    fflush(stdout);
    return ok ? STATUS_DONE : error_print(e);
}

/* k_u = T U_b/(L I_b). */
static double voltage_constant(const motor *m, double L_H)
{
    const per_unit base = per_unit_of(m);
    return base.T_s * base.U_V / (L_H * base.I_A);
}

/* The library holds k_u up to 16 and k_psi = psi/(L I_b) up to 8. */
#define K_U_MOST   15.0
#define K_PSI_MOST 7.5
#define K_R_MOST   1.0 /* k_r = R T/L: a cycle shorter than the winding's time constant */

/*
 * A long cycle needs another drive: first a DC link of the voltage that this speed needs with 20 % to spare, then a larger current base. The
 * currents in A stay those of the paper's drive. L_H: the least that a controller takes it for.
 */
static void fit_library(motor *m, double rpm, double L_H)
{
    if (voltage_constant(m, L_H) > K_U_MOST) {
        const double i_A = per_unit_of(m).I_A;
        const double omega = motor_speed_rad_s(m, rpm);
        const double needed_V = hypot(omega * m->L_d_H * i_A, m->R_ohm * i_A + omega * m->psi_f_Wb);
        m->u_dc_V = fmin(m->u_dc_V, 1.2 * sqrt(3.0) * needed_V);
    }
    const double k_psi = m->psi_f_Wb / (L_H * per_unit_of(m).I_A);
    m->I_rated_A_rms *= fmax(1.0, fmax(voltage_constant(m, L_H) / K_U_MOST, k_psi / K_PSI_MOST));
}

/* The drive of the 2019 paper with another winding and magnet, at a ratio of switching to fundamental frequency. */
static motor machine_at(double rpm, double ratio, double R_ohm, double L_H, double psi_f_Wb)
{
    motor m = paper_2019_motor();
    m.R_ohm = R_ohm;
    m.L_d_H = m.L_q_H = L_H;
    m.psi_f_Wb = psi_f_Wb;
    m.n_max_rpm = rpm;
    m.f_pwm_Hz = ratio * rpm / 60.0 * m.pole_pairs;
    return m;
}

/* The rated current as i_q; `count` ratios from `low` to `high`, each the same multiple of the one before. Those with a cycle longer than L/R
 * are left out. */
PAGE_CALL(page_errors)
(double rpm, double R_ohm, double L_H, double psi_f_Wb, double low, double high, int count)
{
    error e = {0};
    json_t *points = json_array(), *rates = json_array();
    const double i_q_A = sqrt(2.0) * paper_2019_motor().I_rated_A_rms;
    bool ok = count >= 2 && count <= RATIOS_MAX;
    for (int k = 0; k < count && ok; k++) {
        motor m = machine_at(rpm, low * pow(high / low, (double)k / (count - 1)), R_ohm, L_H, psi_f_Wb);
        if (R_ohm / (m.f_pwm_Hz * L_H) > K_R_MOST) {
            continue;
        }
        fit_library(&m, rpm, L_H);
        method_machine machine;
        sweep_point point;
        ok = method_machine_of(&m, &machine, &e) && sweep_point_at(&m, &machine, rpm, i_q_A * I, &point, &e);
        if (ok) {
            json_array_append_new(points, sweep_point_json(&point));
            json_array_append_new(rates, json_number(m.f_pwm_Hz));
        }
    }
    ok =
        ok && (json_array_size(points) > 0 ||
               error_input(
                   &e, NULL, 0, 0,
                   "the cycle is longer than the winding's time constant L/R at every ratio; choose a larger "
                   "L, a smaller R or a higher speed"));
    return page_answer(ok, json_pack("{s:o, s:o}", "f_pwm_Hz", rates, "points", points), &e);
}

/* base: the current base over the paper's rated current. */
static json_t *step_json(loop_method how, const loop_result *r, double base)
{
    json_t *trace = json_array();
    for (int k = 0; k < LOOP_TRACE_CYCLES; k++) {
        json_array_append_new(trace, json_number(base * r->trace_q[k]));
    }
    return json_pack("{s:s, s:s, s:o, s:i, s:o}", "method", loop_method_text[how], "outcome",
                     loop_outcome_text(r->outcome), "overshoot", json_number(r->overshoot_percent),
                     "settling_cycles", r->settling_cycles, "trace", trace);
}

/* A step of i_q from 30 % to 70 % of rated; the controller takes the inductance for believed_L times what it is. */
PAGE_CALL(page_step)(double rpm, double ratio, double R_ohm, double L_H, double psi_f_Wb, double believed_L)
{
    static const loop_method shown[] = {LOOP_PI_MIDPOINT, LOOP_DEADBEAT_EULER, LOOP_DEADBEAT_QUASI_DISCRETE,
                                        LOOP_DEADBEAT_EXACT};
    error e = {0};
    loop_case c = current_loop_case(ratio, 0.0);
    c.truth = machine_at(rpm, ratio, R_ohm, L_H, psi_f_Wb);
    fit_library(&c.truth, rpm, fmin(1.0, believed_L) * L_H);
    if (R_ohm / (c.truth.f_pwm_Hz * fmin(1.0, believed_L) * L_H) > K_R_MOST) {
        return page_answer(
            error_input(&e, NULL, 0, 0,
                        "the cycle is longer than the winding's time constant L/R; choose a higher ratio"),
            NULL, &e);
    }
    const double base = c.truth.I_rated_A_rms / paper_2019_motor().I_rated_A_rms;
    c.omega_e_rad_s = motor_speed_rad_s(&c.truth, rpm);
    motor assumed = c.truth;
    assumed.L_d_H = assumed.L_q_H = believed_L * L_H;
    json_t *all = json_array();
    bool ok = true;
    for (size_t k = 0; k < sizeof shown / sizeof shown[0] && ok; k++) {
        loop_result r;
        ok = loop_method_run(&c, &assumed, shown[k], &r, &e);
        if (ok) {
            json_array_append_new(all, step_json(shown[k], &r, base));
        }
    }
    return page_answer(ok,
                       json_pack("{s:f, s:f, s:i, s:o}", "cycle_s", 1.0 / c.truth.f_pwm_Hz, "reference_after",
                                 0.7, "cycles_before", (int)LOOP_TRACE_BEFORE, "methods", all),
                       &e);
}

/* The true machine over the model: shares. */
typedef struct page_wrong {
    double R, L, psi_f, voltage;
} page_wrong;

enum { WRONG_KINDS = 5 };
static const char *const wrong_keys[WRONG_KINDS] = {"all", "R", "L", "psi_f", "voltage"};

/* One of the errors alone; 0: all together. */
static page_wrong only(const page_wrong *all, int kind)
{
    const page_wrong w = {kind == 0 || kind == 1 ? all->R : 1.0, kind == 0 || kind == 2 ? all->L : 1.0,
                          kind == 0 || kind == 3 ? all->psi_f : 1.0,
                          kind == 0 || kind == 4 ? all->voltage : 1.0};
    return w;
}

static tune_operating_point point_of(const motor *m, const tune_sensorless *s, const page_wrong *wrong,
                                     double ratio)
{
    tune_operating_point at = {.truth = s->control.machine,
                               .voltage_gain = wrong->voltage,
                               .phi_rad = VEC_TWO_PI / ratio,
                               .i_q_A = motor_rated_peak_A(m)};
    at.truth.R_ohm *= wrong->R;
    at.truth.L_d_H *= wrong->L;
    at.truth.L_q_H *= wrong->L;
    at.truth.psi_f_Wb *= wrong->psi_f;
    return at;
}

/* One ratio: the steady angle error of each kind, and noise and margins with all together. */
static json_t *observer_json(const motor *m, const tune_sensorless *s, const page_wrong *all, double ratio)
{
    const double degrees = 360.0 / VEC_TWO_PI;
    json_t *angles = json_object();
    tune_loop loop;
    tune_sensorless_error off = {NAN, NAN, NAN, NAN};
    for (int kind = WRONG_KINDS - 1; kind >= 0; kind--) {
        const page_wrong wrong = only(all, kind);
        const tune_operating_point at = point_of(m, s, &wrong, ratio);
        const bool steady = tune_sensorless_make(s, &at, 0.005 * motor_rated_peak_A(m), &loop, &off);
        off.angle_rad = steady ? off.angle_rad : NAN;
        off.angle_rms_rad = steady ? off.angle_rms_rad : NAN;
        json_object_set_new(angles, wrong_keys[kind], json_number(degrees * off.angle_rad));
    }
    const double disk =
        isnan(off.angle_rad) ? 0.0 : tune_disk_margin(&loop); /* the last one is all together */
    const tune_operating_point at = point_of(m, s, all, ratio);
    tune_loop measured;
    tune_loop_make(&s->control, &at.truth, at.phi_rad, &tune_no_fault, &measured);
    return json_pack("{s:f, s:o, s:o, s:f, s:f}", "sffr", ratio, "angle_deg", angles, "noise_deg",
                     json_number(degrees * off.angle_rms_rad), "disk_observed", disk, "disk_measured",
                     tune_disk_margin(&measured));
}

/*
 * The tuned controller with a bandwidth of 0.6/T on the observed angle, at the rated current, over `count` ratios.
 * The true machine is the sliders' one times the shares; controller and observer take it for the sliders' one. w_T: bandwidth
 * of the observer's loop times the cycle.
 */
PAGE_CALL(page_observer)
(double rpm, double R_ohm, double L_H, double psi_f_Wb, double share_R, double share_L, double share_psi,
 double share_voltage, double w_T, double low, double high, int count)
{
    error e = {0};
    json_t *points = json_array();
    const page_wrong wrong = {share_R, share_L, share_psi, share_voltage};
    const bool ok = count >= 2 && count <= RATIOS_MAX && w_T > 0.0;
    for (int k = 0; k < count && ok; k++) {
        const double ratio = low * pow(high / low, (double)k / (count - 1));
        const motor m = machine_at(rpm, ratio, R_ohm, L_H, psi_f_Wb);
        const tune_machine machine = {R_ohm, L_H, L_H, psi_f_Wb};
        const tune_design design = tune_design_of(TUNE_PI, &machine, 1.0 / m.f_pwm_Hz, 0.6);
        const tune_sensorless s = tune_sensorless_of(&design, false, w_T, 0.5);
        json_array_append_new(points, observer_json(&m, &s, &wrong, ratio));
    }
    return page_answer(ok, json_pack("{s:o}", "points", points), &e);
}

/* The line of `iqfoc golden`: that the library computes here what it does everywhere. */
PAGE_CALL(page_golden)(void)
{
    printf("golden %016" PRIx64 "\n", golden_hash(NULL));
    fflush(stdout);
    return STATUS_DONE;
}
