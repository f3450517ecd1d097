#include "arrange.h"

#include "base/solve.h"
#include "base/vector.h"

#include <math.h>

enum { ROWS_MOST = 1500, ZERO_STEPS = 2, ORDERS = 6, SIGNS = 4, SHIFTS = 5 };

/* What leaves at most this factor more of the voltage's power fits as well. */
static const double as_well = 1.5;

/* A magnet that induces less than this share of the voltage says nothing about the angle. */
static const double emf_least = 0.05;

/* Below this share of a column's rms an offset is the diagnosis' matter. */
static const double offset_least = 0.1;

/* Turns over which a current's mean says something. */
static const double turns_least = 3.0;

static const int orders[ORDERS][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
static const double signs[SIGNS][3] = {{1.0, 1.0, 1.0}, {-1.0, 1.0, 1.0}, {1.0, -1.0, 1.0}, {1.0, 1.0, -1.0}};

/* The back-EMF of a unit flux over the voltage, rms. */
static double emf_of_unit_flux(const recording *rec)
{
    double omega2 = 0.0;
    double u2 = 0.0;
    for (size_t k = 0; k < rec->rows; k += rec->rows / ROWS_MOST + 1) {
        double u[3];
        recording_voltage(rec, k, u);
        const vec_ab v = vec_from_phases(u);
        omega2 += rec->omega_e_rad_s[k] * rec->omega_e_rad_s[k];
        u2 += v.alpha * v.alpha + v.beta * v.beta;
    }
    return u2 > 0.0 ? sqrt(omega2 / u2) : 0.0;
}

static double wrapped(double angle)
{
    return angle - VEC_TWO_PI * round(angle / VEC_TWO_PI);
}

static int count_changes(const arrangement *c)
{
    int flipped = 0;
    bool i_order = false;
    bool u_order = false;
    for (int x = 0; x < 3; x++) {
        flipped += c->a.i_sign[x] < 0.0 && x != c->a.i_derived ? 1 : 0;
        i_order = i_order || c->a.i_from[x] != x;
        u_order = u_order || c->a.u_from[x] != x;
    }
    const int measured = c->a.i_derived >= 0 ? 2 : 3;
    return (flipped == measured ? 1 : flipped) + (i_order ? 1 : 0) + (u_order ? 1 : 0) +
           (c->inverted ? 1 : 0) + (c->a.angle_sign < 0.0 ? 1 : 0) + (fabs(c->a.angle_sign) > 1.0 ? 1 : 0) +
           (c->a.late_halves != 0 ? 1 : 0) + (fabs(c->a.angle_zero) > ARRANGE_ZERO_LEAST ? 1 : 0);
}

static void reverse_currents(arrangement *c)
{
    for (int x = 0; x < 3; x++) {
        c->a.i_sign[x] = -c->a.i_sign[x];
    }
    c->changes = count_changes(c);
}

static void reverse_commands(arrangement *c, bool has_emf)
{
    c->inverted = true;
    if (has_emf) {
        c->a.angle_zero = wrapped(c->a.angle_zero - VEC_PI);
    }
    c->changes = count_changes(c);
}

/* Fits with the angle's zero where the flux shows; false if no signs make a machine of it. */
static bool try_one(const recording *rec, const arrange_freedom *f, double unit_emf, arrangement *c)
{
    voltage_fit fit = voltage_equation_fit(rec, &c->a, ROWS_MOST);
    const bool has_emf = unit_emf * fabs(c->a.angle_sign) * hypot(fit.x[3], fit.x[4]) > emf_least;
    for (int step = 0; step < ZERO_STEPS && f->angle && has_emf; step++) {
        c->a.angle_zero = wrapped(c->a.angle_zero - atan2(fit.x[4], fit.x[3]));
        fit = voltage_equation_fit(rec, &c->a, ROWS_MOST);
    }
    c->left = fit.left;
    c->changes = count_changes(c);
    if (fit.x[1] * fit.x[2] <= 0.0) {
        return false;
    }
    if (fit.x[1] < 0.0) {
        /* Reversed currents or reversed commands: whichever leaves the angle's zero where it was. */
        arrangement other = *c;
        reverse_currents(c);
        reverse_commands(&other, f->angle && has_emf);
        const bool flux_against = !f->angle && has_emf && fit.x[3] < 0.0;
        if (other.changes < c->changes || flux_against) {
            *c = other;
        }
        c->polarity_open = !has_emf;
    }
    return true;
}

static bool is_better(const arrangement *c, const arrangement *best, double least)
{
    const double enough = as_well * least + 1e-9;
    const bool fits = c->left <= enough;
    const bool held = best->left <= enough;
    if (fits != held) {
        return fits;
    }
    return c->changes != best->changes ? c->changes < best->changes : c->left < best->left;
}

/* Calls try_one for every combination; twice: once for what the best leaves, once to choose. */
static void search(const recording *rec, const arrange_freedom *f, double unit_emf, double *least,
                   arrange_result *r)
{
    const bool choose = *least < 1.0;
    const int i_orders = f->current_phases ? ORDERS : 1;
    const int u_orders = f->voltage_phases ? ORDERS : 1;
    const int i_signs = f->current_phases ? SIGNS : 1;
    const double angles[] = {1.0, -1.0, f->per_angle, -f->per_angle};
    const int n_angles = !f->angle ? 1 : f->per_angle > 1 ? 4 : 2;
    for (int n = 0; n < i_orders * u_orders * i_signs * SHIFTS * n_angles; n++) {
        arrangement c = {.a = voltage_as_recorded};
        int rest = n;
        for (int x = 0; x < 3; x++) {
            c.a.i_from[x] = orders[rest % i_orders][x];
            c.a.u_from[x] = orders[rest / i_orders % u_orders][x];
            c.a.i_sign[x] = signs[rest / (i_orders * u_orders) % i_signs][x];
        }
        rest /= i_orders * u_orders * i_signs;
        c.a.late_halves = rest % SHIFTS;
        c.a.angle_sign = angles[rest / SHIFTS];
        c.a.i_derived = f->derived;
        if (f->derived >= 0 && c.a.i_sign[f->derived] < 0.0) {
            continue; /* its sign is that of the others */
        }
        r->tried++;
        if (!try_one(rec, f, unit_emf, &c)) {
            continue;
        }
        if (choose ? is_better(&c, &r->best, *least) : c.left < r->best.left) {
            r->best = c;
        }
    }
    *least = r->best.left;
}

/* A column's part that does not turn with the angle, by regression on 1, cos and sin of it; 0 if the log does not show it. */
static double offset_of(const recording *rec, const double *i_A)
{
    double h[3][3] = {{0}};
    double g[3] = {0};
    double x[3];
    double power = 0.0;
    double turned = 0.0;
    for (size_t k = 0; k < rec->rows; k++) {
        const double row[3] = {1.0, cos(rec->theta_e_rad[k]), sin(rec->theta_e_rad[k])};
        turned += fabs(rec->omega_e_rad_s[k]) * rec->T_s / VEC_TWO_PI;
        power += i_A[k] * i_A[k];
        for (size_t m = 0; m < 3; m++) {
            g[m] += row[m] * i_A[k];
            for (size_t n = 0; n < 3; n++) {
                h[m][n] += row[m] * row[n];
            }
        }
    }
    if (turned < turns_least || !solve_positive(3, 3, &h[0][0], g, x)) {
        return 0.0;
    }
    const double left = fmax(power - g[0] * x[0] - g[1] * x[1] - g[2] * x[2], 0.0);
    const double rows = (double)rec->rows;
    return fabs(x[0]) > offset_least * sqrt(power / rows) && fabs(x[0]) > 3.0 * sqrt(left / rows / turned)
               ? x[0]
               : 0.0;
}

static void take_offsets(recording *rec, const arrange_freedom *f, double offset_A[3])
{
    for (int x = 0; x < 3 && f->current_phases; x++) {
        if (x != f->derived) {
            offset_A[x] = offset_of(rec, rec->i_A[x]);
        }
    }
    for (int x = 0; x < 3; x++) {
        /* A phase that was made of the others holds theirs. */
        const double offset_of_x =
            x == f->derived ? -offset_A[(x + 1) % 3] - offset_A[(x + 2) % 3] : offset_A[x];
        for (size_t k = 0; k < rec->rows; k++) {
            rec->i_A[x][k] -= offset_of_x;
        }
    }
}

arrange_result arrange_find(recording *rec, const arrange_freedom *f)
{
    arrange_result r = {.tried = 0};
    const double unit_emf = emf_of_unit_flux(rec);
    double least = 1.0;
    r.as_mapped.a = voltage_as_recorded;
    const voltage_fit own = voltage_equation_fit(rec, &voltage_as_recorded, ROWS_MOST);
    r.as_mapped.left = own.left;
    r.as_mapped.negative = own.x[1] < 0.0 && own.x[2] < 0.0;
    r.best.left = 1.0;
    take_offsets(rec, f, r.offset_A);
    search(rec, f, unit_emf, &least, &r);
    if (least < 1.0) {
        r.tried = 0;
        search(rec, f, unit_emf, &least, &r);
        r.fit = voltage_equation_fit(rec, &r.best.a, ROWS_MOST);
    }
    return r;
}
