/* Constants of the change detector from a diagnosis (tune_watch.h). */
#include "tune_watch.h"

#include "per_unit.h"

#include "iqfoc/watch.h"

#include <math.h>

/* sqrt(5/3): beta of two sensors. */
static const double VECTOR_OVER_SENSOR = 1.2909944487358056;
/* What a size over the noise may be at most: iqfoc/watch.h. */
static const double SIZE_MOST = 2048.0;
static const double NOISE_LEAST = 5e-5;
static const double NOISE_MOST = 0.1;

/* The greatest of the sizes that IQFOC_WATCH_CONFIG divides by the noise: the same eleven. */
static double greatest_size(const tune_result *r)
{
    const tune_machine *m = &r->design.machine;
    const per_unit base = per_unit_of(&r->motor);
    const double L = 0.5 * (m->L_d_H + m->L_q_H);
    const double rho = m->R_ohm * base.T_s / L;
    const double k_psi = m->psi_f_Wb / (L * base.I_A);
    const double k_u = base.T_s * base.U_V / (L * base.I_A);
    const double of_flux = VEC_TWO_PI * fmax(IQFOC_WATCH_SIZE_PSI, IQFOC_WATCH_SIZE_ANGLE) * k_psi;
    const double of_voltage = fmax(VEC_TWO_PI * IQFOC_WATCH_SIZE_LATE, IQFOC_WATCH_SIZE_GAIN) * k_u;
    const double of_current = fmax(VEC_TWO_PI * IQFOC_WATCH_SIZE_L, IQFOC_WATCH_SIZE_R * rho);
    return fmax(fmax(of_flux, of_voltage), of_current);
}

tune_watch tune_watch_of(const tune_result *r)
{
    const tune_region *region = &r->region;
    const tune_machine *centre = &r->design.machine;
    tune_watch w = {
        .psi = centre->psi_f_Wb > 0.0 ? fmax(region->psi_high, -region->psi_low) / centre->psi_f_Wb : 0.0};
    for (int n = 0; n < region->points; n++) {
        const tune_machine *m = &region->point[n].machine;
        w.R = centre->R_ohm > 0.0 ? fmax(w.R, fabs(m->R_ohm / centre->R_ohm - 1.0)) : 0.0;
    }
    w.fall = tune_fall_of(&r->motor).flux;
    w.L = fmax(region->L_off, w.fall);
    const double noise = VECTOR_OVER_SENSOR * region->noise_A / motor_rated_peak_A(&r->motor);
    /* A margin for the constant's rounding. */
    w.noise_pu = fmax(noise, fmax(NOISE_LEAST, 1.001 * greatest_size(r) / SIZE_MOST));
    if (!(region->noise_A > 0.0)) {
        w.none = "the noise of the current sensors is unknown; a diagnosis measures it (--diagnosis)";
    } else if (w.noise_pu > NOISE_MOST) {
        w.none = "the noise is above a tenth of the rated peak";
    } else if (w.R > 16.0 * IQFOC_WATCH_SIZE_R || w.L > 16.0 * IQFOC_WATCH_SIZE_L ||
               w.psi > 16.0 * IQFOC_WATCH_SIZE_PSI) {
        w.none = "the machine's uncertainty is too large";
    }
    return w;
}

/* A change of `times` assumed changes makes X y = times |X|^2, which must exceed |X|^2/2 and its uncertainty. */
static double noted_from(double size, double unsure)
{
    return 0.5 * size + unsure;
}

tune_noted tune_noted_from(const tune_watch *w)
{
    const tune_noted n = {noted_from(IQFOC_WATCH_SIZE_R, w->R), noted_from(IQFOC_WATCH_SIZE_L, w->L),
                          noted_from(IQFOC_WATCH_SIZE_PSI, w->psi)};
    return n;
}
