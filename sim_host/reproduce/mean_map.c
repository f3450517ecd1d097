/* The cheapest sufficient mean of the dq current (mean_map.h). */
#include "mean_map.h"

#include "model/modulated_mean.h"

#include <math.h>

static const char *const names[MEAN_METHODS] = {[MEAN_MIDPOINT] = "mid-point sample",
                                                [MEAN_LINEAR] = "linear correction",
                                                [MEAN_QUASI_DISCRETE] = "quasi-discrete mean",
                                                [MEAN_MODULATED] = "mean under modulation"};

const char *mean_method_name(mean_method which)
{
    return names[which];
}

/* From SFFR 3 to 100 in equal steps of its logarithm; cells are drawn around these. */
static double ratio_at(int n)
{
    return 3.0 * pow(100.0 / 3.0, n / (MEAN_MAP_RATIOS - 1.0));
}

/* 0.07 ... 0.97: the steady state is still corrected a little, and needs that much room above its voltage. */
static double index_at(int n)
{
    return 0.07 + 0.9 * n / (MEAN_MAP_INDICES - 1.0);
}

static double load_at(int n)
{
    return 0.5 * n;
}

/* What each method makes of a cycle, rotor frame, A. */
static void means_of(const motor *m, const steady_drive *d, const drive_cycle *at,
                     double complex mean[MEAN_METHODS])
{
    const papers_machine round = {m->R_ohm, 0.5 * (m->L_d_H + m->L_q_H), m->psi_f_Wb, d->T_s};
    modulated_cycle c = {d->T_s, d->u_dc_V, {0.0, 0.0, 0.0}, at->theta_rad, d->omega_rad_s};
    steady_drive_duties(d, at, c.duty);
    const double phi = d->omega_rad_s * d->T_s;
    const double theta_mid = at->theta_rad + 0.5 * phi;
    const double complex change = at->i_next_valley_A - at->i_valley_A;
    mean[MEAN_MIDPOINT] = papers_mean_discrete_angle_dq(at->i_mid_A, theta_mid);
    mean[MEAN_LINEAR] = papers_mean_corrected_dq(at->i_mid_A, change, theta_mid, phi);
    const double complex next =
        papers_predict_quasi_discrete(&round, at->i_valley_A, at->u_V, at->theta_rad, d->omega_rad_s);
    const double complex stationary =
        papers_mean_quasi_discrete(&round, at->i_valley_A, at->u_V, at->theta_rad, d->omega_rad_s);
    mean[MEAN_QUASI_DISCRETE] = papers_mean_corrected_dq(stationary, next - at->i_valley_A, theta_mid, phi);
    if (m->L_d_H == m->L_q_H) {
        mean[MEAN_MODULATED] = modulated_from_samples(&round, &c, at->i_valley_A, at->i_next_valley_A);
    } else {
        const exact_salient machine = {m->R_ohm, m->L_d_H, m->L_q_H, m->psi_f_Wb};
        const double complex back = vec_turn(-at->theta_rad);
        const exact_span even =
            exact_salient_span(&machine, at->i_valley_A * back, at->u_V * back, d->T_s, d->omega_rad_s);
        mean[MEAN_MODULATED] = even.mean_dq_A + modulated_ripple_dq(&machine, &c);
    }
}

static bool point_of(const motor *m, double ratio, double index, double load, double percent[MEAN_METHODS],
                     error *e)
{
    const double omega = VEC_TWO_PI * m->f_pwm_Hz / ratio;
    const double rated_A = motor_rated_peak_A(m);
    const double complex i_dq_A = vec_complex(0.0, load * rated_A);
    motor fitted = *m;
    const double voltage_V = cabs(steady_point_solve(m, omega, i_dq_A).u_dq_V);
    fitted.u_dc_V = fmax(voltage_V, 1e-3) / (index * steady_drive_voltage_limit(1.0));
    steady_drive d;
    const double n_rpm = 60.0 * m->f_pwm_Hz / (ratio * m->pole_pairs);
    if (!steady_drive_run(&fitted, n_rpm, i_dq_A, 100, &d, e)) {
        return false;
    }
    for (int k = 0; k < MEAN_METHODS; k++) {
        percent[k] = 0.0;
    }
    for (size_t n = 0; n < d.count; n++) {
        double complex mean[MEAN_METHODS];
        means_of(m, &d, &d.cycle[n], mean);
        for (int k = 0; k < MEAN_METHODS; k++) {
            percent[k] = fmax(percent[k], 100.0 * cabs(mean[k] - d.cycle[n].i_mean_dq_A) / rated_A);
        }
    }
    steady_drive_free(&d);
    return true;
}

bool mean_map_run(const motor *m, mean_map *map, error *e)
{
    for (int r = 0; r < MEAN_MAP_RATIOS; r++) {
        map->ratio[r] = ratio_at(r);
    }
    for (int n = 0; n < MEAN_MAP_INDICES; n++) {
        map->index[n] = index_at(n);
    }
    for (int l = 0; l < MEAN_MAP_LOADS; l++) {
        map->load[l] = load_at(l);
        for (int n = 0; n < MEAN_MAP_INDICES; n++) {
            for (int r = 0; r < MEAN_MAP_RATIOS; r++) {
                if (!point_of(m, map->ratio[r], map->index[n], map->load[l], map->percent[l][n][r], e)) {
                    return false;
                }
            }
        }
    }
    return true;
}

mean_method mean_map_enough(const double percent[MEAN_METHODS], double limit_percent)
{
    for (int k = 0; k < MEAN_METHODS; k++) {
        if (percent[k] <= limit_percent) {
            return (mean_method)k;
        }
    }
    return MEAN_METHODS;
}

json_t *mean_map_json(const mean_map *map)
{
    json_t *points = json_array();
    for (int l = 0; l < MEAN_MAP_LOADS; l++) {
        for (int n = 0; n < MEAN_MAP_INDICES; n++) {
            for (int r = 0; r < MEAN_MAP_RATIOS; r++) {
                const double *percent = map->percent[l][n][r];
                json_array_append_new(
                    points,
                    json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "sffr", map->ratio[r],
                              "modulation_index", map->index[n], "load", map->load[l], "mid_point",
                              percent[MEAN_MIDPOINT], "linear", percent[MEAN_LINEAR], "quasi_discrete",
                              percent[MEAN_QUASI_DISCRETE], "modulated", percent[MEAN_MODULATED]));
            }
        }
    }
    return points;
}
