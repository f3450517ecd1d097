/* The uncertainty set: boundary points and draws (tune_region.h). */
#include "tune_region.h"

#include "tune_region_points.h"

#include <math.h>
#include <stdio.h>

/* Directions on a sphere: corners, edges and faces of a cube. */
enum { DIRECTIONS = 27 };

static const char *const axis_name[TUNE_AXES] = {"R", "L_d", "L_q"};

static tune_machine moved(const tune_machine *centre, const double off[TUNE_AXES])
{
    tune_machine m = *centre;
    m.R_ohm = fmax(m.R_ohm + off[0], 0.0);
    m.L_d_H += off[1];
    m.L_q_H += off[2];
    return m;
}

static void describe(const tune_machine *centre, tune_point *p)
{
    const double was[TUNE_AXES] = {centre->R_ohm, centre->L_d_H, centre->L_q_H};
    const double is[TUNE_AXES] = {p->machine.R_ohm, p->machine.L_d_H, p->machine.L_q_H};
    size_t used = 0;
    const bool alike = fabs(is[1] / was[1] - is[2] / was[2]) < 1e-9;
    p->text[0] = '\0';
    for (int n = 0; n < TUNE_AXES - (alike ? 1 : 0); n++) {
        const double percent = was[n] > 0.0 ? 100.0 * (is[n] / was[n] - 1.0) : 0.0;
        if (fabs(percent) >= 0.005) {
            const int length = snprintf(p->text + used, sizeof p->text - used, "%s%s %+.3g %%",
                                        used > 0 ? ", " : "", alike && n > 0 ? "L" : axis_name[n], percent);
            used += length > 0 ? (size_t)length : 0;
        }
    }
    if (used == 0) {
        (void)snprintf(p->text, sizeof p->text, "nominal");
    }
}

static void add_point(tune_region *region, const double off[TUNE_AXES])
{
    if (region->points < TUNE_POINTS_MOST) {
        tune_point *p = &region->point[region->points++];
        p->machine = moved(&region->centre, off);
        describe(&region->centre, p);
    }
}

/* The corner n of the box, added to `off`; false if it is one that an earlier one has been already. */
static bool box_corner(const tune_region *region, int n, double off[TUNE_AXES])
{
    for (int k = 0; k < TUNE_AXES; k++) {
        const bool high = (n >> k & 1) != 0;
        if (high && region->low[k] == region->high[k]) {
            return false;
        }
        off[k] += high ? region->high[k] : region->low[k];
    }
    return !region->alike || (n >> 1 & 1) == (n >> 2 & 1);
}

/*
 * A direction of the ellipsoid: -1, 0 or 1 on each axis, made a unit vector. False for none of its own. Axes
 * from `known` on have z of 0 then.
 */
static bool direction(int n, int known, double off[TUNE_AXES], const tune_region *region)
{
    double z[TUNE_AXES] = {(double)(n % 3 - 1), (double)(n / 3 % 3 - 1), (double)(n / 9 - 1)};
    double square = 0.0;
    for (int k = 0; k < TUNE_AXES; k++) {
        if (k >= known && z[k] != 0.0) {
            return false;
        }
        square += z[k] * z[k];
    }
    for (int row = 0; row < TUNE_AXES; row++) {
        off[row] = 0.0;
        for (int k = 0; k < TUNE_AXES && square > 0.0; k++) {
            off[row] += region->root[row][k] * region->radius * z[k] / sqrt(square);
        }
    }
    return known == 0 || square > 0.0;
}

void tune_region_add_points(tune_region *region)
{
    static const double none[TUNE_AXES] = {0.0, 0.0, 0.0};
    region->points = 0;
    add_point(region, none);
    for (int n = 0; n < DIRECTIONS; n++) {
        double way[TUNE_AXES];
        for (int corner = 0; corner < 1 << TUNE_AXES && direction(n, region->known, way, region); corner++) {
            if (box_corner(region, corner, way)) {
                add_point(region, way);
            }
        }
    }
}

double tune_region_L_off(const tune_region *region)
{
    double off = 0.0;
    for (int n = 0; n < region->points; n++) {
        off = fmax(off, fabs(region->point[n].machine.L_d_H / region->centre.L_d_H - 1.0));
        off = fmax(off, fabs(region->point[n].machine.L_q_H / region->centre.L_q_H - 1.0));
    }
    return off;
}

tune_machine tune_region_draw(const tune_region *region, plant_random *r)
{
    double z[TUNE_AXES] = {0.0};
    double square = 2.0;
    while (square > 1.0) {
        square = 0.0;
        for (int k = 0; k < region->known; k++) {
            z[k] = 2.0 * plant_random_uniform(r) - 1.0;
            square += z[k] * z[k];
        }
    }
    const double both = plant_random_uniform(r);
    double off[TUNE_AXES];
    for (int row = 0; row < TUNE_AXES; row++) {
        const double share = region->alike && row > 0 ? both : plant_random_uniform(r);
        off[row] = region->low[row] + (region->high[row] - region->low[row]) * share;
        for (int k = 0; k < region->known; k++) {
            off[row] += region->root[row][k] * region->radius * z[k];
        }
    }
    tune_machine m = moved(&region->centre, off);
    m.psi_f_Wb += region->psi_low + (region->psi_high - region->psi_low) * plant_random_uniform(r);
    return m;
}

tune_machine tune_machine_of_motor(const motor *m)
{
    tune_machine machine = {.R_ohm = m->R_ohm, .psi_f_Wb = m->psi_f_Wb};
    motor_inductances(m, &machine.L_d_H, &machine.L_q_H);
    return machine;
}

void tune_region_of_tolerances(const motor *m, const tune_tolerances *t, tune_region *region)
{
    *region = (tune_region){.centre = tune_machine_of_motor(m)};
    const double nominal[TUNE_AXES] = {m->R_ohm, region->centre.L_d_H, region->centre.L_q_H};
    const double share[TUNE_AXES] = {t->R, t->L, t->L};
    for (int n = 0; n < TUNE_AXES; n++) {
        region->high[n] = share[n] * nominal[n];
        region->low[n] = -region->high[n];
    }
    region->psi_high = t->psi_f * m->psi_f_Wb;
    region->psi_low = -region->psi_high;
    region->alike = m->L_d_H == m->L_q_H;
    (void)snprintf(region->source, sizeof region->source,
                   "stated tolerances: R within %g %%, %s within %g %%, psi_f within %g %%", 100.0 * t->R,
                   region->alike ? "L" : "L_d and L_q each", 100.0 * t->L, 100.0 * t->psi_f);
    tune_region_add_points(region);
    region->L_off = tune_region_L_off(region);
}
