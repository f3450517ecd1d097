/* A cycle of PWM (pwm_cycle.h). */
#include "pwm_cycle.h"

void pwm_duties(double complex u_V, double u_dc_V, double duty[3])
{
    double phase_V[3];
    vec_to_phases(vec_ab_of(u_V), phase_V);
    const double highest = fmax(phase_V[0], fmax(phase_V[1], phase_V[2]));
    const double lowest = fmin(phase_V[0], fmin(phase_V[1], phase_V[2]));
    for (int x = 0; x < 3; x++) {
        duty[x] = 0.5 + (phase_V[x] - 0.5 * (highest + lowest)) / u_dc_V;
    }
}

void pwm_instants(const double duty[3], double at[PWM_INSTANTS])
{
    at[0] = 0.0;
    at[1] = 0.5;
    at[2] = 1.0;
    for (int leg = 0; leg < 3; leg++) {
        at[3 + 2 * leg] = 0.5 * (1.0 - duty[leg]);
        at[4 + 2 * leg] = 0.5 * (1.0 + duty[leg]);
    }
    for (int n = 1; n < PWM_INSTANTS; n++) {
        for (int k = n; k > 0 && at[k] < at[k - 1]; k--) {
            const double swap = at[k];
            at[k] = at[k - 1];
            at[k - 1] = swap;
        }
    }
}

double complex pwm_voltage(const double duty[3], double u_dc_V, double at)
{
    double leg_V[3];
    for (int leg = 0; leg < 3; leg++) {
        leg_V[leg] = fabs(at - 0.5) < 0.5 * duty[leg] ? u_dc_V : 0.0;
    }
    return vec_complex_of_phases(leg_V);
}
