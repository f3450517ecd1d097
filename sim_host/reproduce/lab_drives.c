/* The stand-in for the 2019 paper's laboratory (lab_drives.h). */
#include "lab_drives.h"
#include "base/sort.h"

#include "per_unit.h"
#include "plant/plant_random.h"

#include <math.h>

const lab_uncertainty lab_uncertainty_assumed = {.R = 0.10,
                                                 .L = 0.05,
                                                 .psi_f = 0.02,
                                                 .voltage = 0.01,
                                                 .angle_rad = VEC_PI / 180.0,
                                                 .current_noise = 0.005};

/* One possible drive of the laboratory, with its controller's parameters. */
typedef struct lab_drive {
    method_machine machine;
    double voltage_gain, angle_offset_rad, noise_A;
} lab_drive;

static double uniform(plant_random *r, double half_width)
{
    return half_width * (2.0 * plant_random_uniform(r) - 1.0);
}

static bool draw(const motor *m, plant_random *r, lab_drive *drive, error *e)
{
    const lab_uncertainty *u = &lab_uncertainty_assumed;
    motor assumed = *m;
    assumed.R_ohm *= 1.0 + uniform(r, u->R);
    assumed.L_d_H *= 1.0 + uniform(r, u->L);
    assumed.L_q_H = assumed.L_d_H * m->L_q_H / m->L_d_H;
    assumed.psi_f_Wb *= 1.0 + uniform(r, u->psi_f);
    drive->voltage_gain = 1.0 + uniform(r, u->voltage);
    drive->angle_offset_rad = uniform(r, u->angle_rad);
    drive->noise_A = u->current_noise * per_unit_of(m).I_A;
    return method_machine_of(&assumed, &drive->machine, e);
}

/* Noise of two phase currents, as a vector: c = -a - b. */
static double complex noise_vector(plant_random *r, double sigma_A)
{
    const double a = sigma_A * plant_random_normal(r);
    const double b = sigma_A * plant_random_normal(r);
    const double abc[3] = {a, b, -a - b};
    return vec_complex_of_phases(abc);
}

/* As the laboratory measures it: the prediction from one sample against the next, each with its noise. */
static void run(const lab_drive *drive, const steady_drive *d, method which, plant_random *r,
                double percent[2])
{
    double sum = 0.0;
    double sum_iq24 = 0.0;
    double sum_current = 0.0;
    double complex noise = noise_vector(r, drive->noise_A);
    for (size_t n = 0; n < d->count; n++) {
        method_input in = method_input_of(d, &d->cycle[n]);
        in.i_valley_A += noise;
        in.u_V *= drive->voltage_gain;
        in.theta_rad += drive->angle_offset_rad;
        noise = noise_vector(r, drive->noise_A);
        const double complex next = method_truth(which, &d->cycle[n]) + noise;
        sum += vec_square(method_compute(which, &drive->machine, &in) - next);
        sum_iq24 += vec_square(method_compute_iq24(which, &drive->machine, &in) - next);
        sum_current += vec_square(in.i_valley_A);
    }
    percent[0] = 100.0 * sqrt(sum / sum_current);
    percent[1] = 100.0 * sqrt(sum_iq24 / sum_current);
}

static double quantile(const double sorted[LAB_DRAWS], double at)
{
    const double position = at * (LAB_DRAWS - 1);
    const int below = (int)position;
    const int above = below + 1 < LAB_DRAWS ? below + 1 : below;
    return sorted[below] + (position - below) * (sorted[above] - sorted[below]);
}

bool lab_spread_of(const motor *m, const steady_drive *d, method which, lab_spread *spread, error *e)
{
    double percent[LAB_DRAWS];
    double percent_iq24[LAB_DRAWS];
    plant_random r;
    /* The same draws at every speed and for every method: the same drives, measured again. */
    plant_random_seed(&r, LAB_SEED, 0);
    for (int n = 0; n < LAB_DRAWS; n++) {
        lab_drive drive;
        double both[2];
        plant_random noise;
        plant_random_seed(&noise, LAB_SEED, (uint64_t)n + 1);
        if (!draw(m, &r, &drive, e)) {
            return false;
        }
        run(&drive, d, which, &noise, both);
        percent[n] = both[0];
        percent_iq24[n] = both[1];
    }
    sort_ascending(percent, LAB_DRAWS);
    sort_ascending(percent_iq24, LAB_DRAWS);
    *spread = (lab_spread){quantile(percent, 0.5), quantile(percent, 0.05), quantile(percent, 0.95),
                           quantile(percent_iq24, 0.5)};
    return true;
}
