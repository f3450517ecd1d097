/* Stability of PI control with the corrected mean (corrected_mean.h). */
#include "corrected_mean.h"

#include "base/solve.h"
#include "base/vector.h"
#include "params_host.h"

#include <complex.h>
#include <math.h>

/* States in the frame of their own valley: current, current and voltage of the cycle before, voltage, integrator. */
enum { NOW, BEFORE, VOLTAGE, VOLTAGE_BEFORE, INTEGRATOR, STATES };

/* Voltages are in units of L/T: what a voltage adds to the current in a cycle without resistance. */
static void loop_matrix(double phi, double rho, double w_T, double complex a[STATES][STATES])
{
    const double h = 0.5 * phi;
    const double s1 = h > 1e-6 ? sin(h) / h : 1.0;
    const double s2 = h > 1e-3 ? (2.0 * sin(h) - phi * cos(h)) / (phi * phi) : phi / 12.0;
    const double kept = exp(-rho);
    const double kept_half = exp(-0.5 * rho);
    const double gained = rho > 1e-9 ? (1.0 - kept) / rho : 1.0;
    const double gained_half = rho > 1e-9 ? (1.0 - kept_half) / rho : 0.5;
    const double complex ahead = cexp(I * h);
    const double complex back = conj(ahead);
    /* 2016 (10) of both valleys and of the sample at the peak between them. */
    const double complex mean[STATES] = {[NOW] = -I * s2 * ahead,
                                         [BEFORE] = (s1 * kept_half + I * s2) * back,
                                         [VOLTAGE_BEFORE] = s1 * gained_half * back};
    for (int n = 0; n < STATES; n++) {
        a[NOW][n] = a[BEFORE][n] = a[VOLTAGE_BEFORE][n] = 0.0;
        a[VOLTAGE][n] = ahead * ((I * phi - w_T) * mean[n] + (n == INTEGRATOR ? 1.0 : 0.0));
        a[INTEGRATOR][n] = (n == INTEGRATOR ? 1.0 : 0.0) - w_T * rho * mean[n];
    }
    a[NOW][NOW] = kept * back * back;
    a[NOW][VOLTAGE] = gained * back * back;
    a[BEFORE][NOW] = 1.0;
    a[VOLTAGE_BEFORE][VOLTAGE] = 1.0;
}

double corrected_mean_radius(const motor *m, double bandwidth_Hz, double rpm)
{
    double complex a[STATES][STATES];
    double real[4 * STATES * STATES];
    double re[2 * STATES];
    double im[2 * STATES];
    double L_d_H;
    double L_q_H;
    motor_inductances(m, &L_d_H, &L_q_H);
    const double T_s = 1.0 / m->f_pwm_Hz;
    loop_matrix(fabs(motor_speed_rad_s(m, rpm)) * T_s, 2.0 * m->R_ohm * T_s / (L_d_H + L_q_H),
                VEC_TWO_PI * bandwidth_Hz * T_s, a);
    for (int n = 0; n < STATES; n++) {
        for (int k = 0; k < STATES; k++) {
            real[n * 2 * STATES + k] = real[(n + STATES) * 2 * STATES + k + STATES] = creal(a[n][k]);
            real[n * 2 * STATES + k + STATES] = -cimag(a[n][k]);
            real[(n + STATES) * 2 * STATES + k] = cimag(a[n][k]);
        }
    }
    if (!solve_eigenvalues(2 * STATES, real, re, im)) {
        return INFINITY;
    }
    double largest = 0.0;
    for (int n = 0; n < 2 * STATES; n++) {
        largest = fmax(largest, hypot(re[n], im[n]));
    }
    return largest;
}

double corrected_mean_bandwidth_Hz(const motor *m, double rpm)
{
    double stable = m->f_pwm_Hz / 1000.0;
    double lost = m->f_pwm_Hz / 4.0;
    if (corrected_mean_radius(m, stable, rpm) >= 1.0) {
        return 0.0;
    }
    if (corrected_mean_radius(m, lost, rpm) < 1.0) {
        return lost;
    }
    while (lost > 1.01 * stable) {
        const double middle = sqrt(lost * stable);
        if (corrected_mean_radius(m, middle, rpm) < 1.0) {
            stable = middle;
        } else {
            lost = middle;
        }
    }
    return stable;
}

/* The highest speed that the run gives to the shaft; with an inertia the first. */
static double highest_rpm(const scenario_run *run)
{
    double highest = 0.0;
    for (size_t n = 0; n < (run->shaft == SHAFT_GIVEN ? run->speed_rpm.points : 1); n++) {
        highest = fmax(highest, fabs(run->speed_rpm.value[n]) + fabs(run->speed_rpm.amplitude));
    }
    return highest;
}

bool corrected_mean_fits(const motor *m, const scenario *s, error *e)
{
    if (s->control.feedback != FEEDBACK_CORRECTED_MEAN || s->control.modulation != MODULATION_PWM) {
        return true;
    }
    const double bandwidth_Hz = control_bandwidth_Hz(m, &s->control);
    for (size_t n = 0; n < s->runs; n++) {
        const double rpm = highest_rpm(&s->run[n]);
        if (corrected_mean_radius(m, bandwidth_Hz, rpm) < 1.0) {
            continue;
        }
        const double sffr = m->f_pwm_Hz * VEC_TWO_PI / motor_speed_rad_s(m, rpm);
        const double most_Hz = corrected_mean_bandwidth_Hz(m, rpm);
        if (most_Hz > 0.0) {
            return error_input(
                e, NULL, 0, 0,
                "control: feedback = \"corrected_mean\" with a bandwidth of %.4g Hz is unstable "
                "at %.5g rpm (SFFR %.3g); expected bandwidth_Hz of at most %.3g",
                bandwidth_Hz, rpm, sffr, most_Hz);
        }
        return error_input(
            e, NULL, 0, 0,
            "control: feedback = \"corrected_mean\" is unstable at %.5g rpm (SFFR %.3g) with any "
            "bandwidth; expected \"quasi_discrete_mean\", a lower speed or a higher f_pwm_Hz",
            rpm, sffr);
    }
    return true;
}
