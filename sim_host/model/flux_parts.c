/* A bounded least-squares fit of parts that saturate (flux_parts.h). */
#include "flux_parts.h"

#include "base/solve.h"
#include "flux_map.h"

#include <math.h>
#include <string.h>

enum {
    STRAIGHT = 2, /* numbers of straight iron: L_d, L_q */
    OF_PART = 4,  /* of a part: E, ln I_d, ln I_q, I_c */
    ORDER_MOST = STRAIGHT + OF_PART * IRON_PARTS,
    STEPS = 200
};

/* A map at the currents at which it is fitted. */
typedef struct target {
    const averaged_drive *drive;
    const vec_dq *i;
    size_t count;
    vec_dq flux[FLUX_PARTS_CURRENTS];
    double squares;                           /* of the fluxes */
    double low[ORDER_MOST], high[ORDER_MOST]; /* of the numbers */
    double longest_A;
} target;

/* Numbers of a fit, in the order of the enumeration, and the sum of its squared errors. */
typedef struct fit {
    size_t order;
    double z[ORDER_MOST];
    double error;
} fit;

static target target_of(const averaged_drive *drive, const vec_dq *i, size_t count,
                        const flux_parts_limits *limits)
{
    const double low[] = {0.0, log(limits->I_low_A), log(limits->I_low_A), -limits->I_c_high_A};
    const double high[] = {limits->E_high_J, log(limits->I_high_A), log(limits->I_high_A),
                           limits->I_c_high_A};
    target t = {.drive = drive, .i = i, .count = count};
    for (size_t n = 0; n < ORDER_MOST; n++) {
        t.low[n] = n < STRAIGHT ? limits->L_low_H : low[(n - STRAIGHT) % OF_PART];
        t.high[n] = n < STRAIGHT ? limits->L_high_H : high[(n - STRAIGHT) % OF_PART];
    }
    for (size_t k = 0; k < count; k++) {
        t.flux[k] = flux_map_flux(drive, i[k]);
        t.squares += t.flux[k].d * t.flux[k].d + t.flux[k].q * t.flux[k].q;
        t.longest_A = fmax(t.longest_A, hypot(i[k].d, i[k].q));
    }
    return t;
}

/* Adds `sign` times a part's flux and its derivatives. */
static void add_flux(const double z[OF_PART], vec_dq i, double sign, vec_dq *flux, vec_dq by[OF_PART])
{
    const double per_d = exp(-z[1]);
    const double per_q = exp(-z[2]);
    const double x = per_d * (i.d - z[3]);
    const double y = per_q * i.q;
    const double per_root = 1.0 / sqrt(1.0 + x * x + y * y);
    const double cubed = per_root * per_root * per_root;
    /* of x/rho by x, y/rho by y, and of each by the other */
    const double dx = (1.0 + y * y) * cubed;
    const double dy = (1.0 + x * x) * cubed;
    const double across = -x * y * cubed;
    const double e_d = sign * z[0] * per_d;
    const double e_q = sign * z[0] * per_q;
    flux->d += e_d * x * per_root;
    flux->q += e_q * y * per_root;
    by[0].d += sign * per_d * x * per_root;
    by[0].q += sign * per_q * y * per_root;
    by[1].d -= e_d * (x * per_root + dx * x);
    by[1].q -= e_q * across * x;
    by[2].d -= e_d * across * y;
    by[2].q -= e_q * (y * per_root + dy * y);
    by[3].d -= e_d * per_d * dx;
    by[3].q -= e_q * per_d * across;
}

/* The flux at a current, and its derivatives by the numbers. */
static vec_dq flux_of(const fit *f, vec_dq i, vec_dq by[ORDER_MOST])
{
    static const vec_dq none = {0.0, 0.0};
    vec_dq flux = {f->z[0] * i.d, f->z[1] * i.q};
    memset(by, 0, ORDER_MOST * sizeof *by);
    by[0].d = i.d;
    by[1].q = i.q;
    for (size_t n = STRAIGHT; n < f->order; n += OF_PART) {
        add_flux(f->z + n, i, 1.0, &flux, by + n);
        add_flux(f->z + n, none, -1.0, &flux, by + n);
    }
    return flux;
}

/* The sum of squared errors; h and down, unless NULL: the sums of the derivatives' products, and of those with the errors. */
static double error_of(const target *t, const fit *f, double *h, double *down)
{
    double sum = 0.0;
    if (h != NULL) {
        memset(h, 0, ORDER_MOST * ORDER_MOST * sizeof *h);
        memset(down, 0, ORDER_MOST * sizeof *down);
    }
    for (size_t k = 0; k < t->count; k++) {
        vec_dq by[ORDER_MOST];
        const vec_dq flux = flux_of(f, t->i[k], by);
        const vec_dq off = {t->flux[k].d - flux.d, t->flux[k].q - flux.q};
        sum += off.d * off.d + off.q * off.q;
        for (size_t n = 0; h != NULL && n < f->order; n++) {
            down[n] += by[n].d * off.d + by[n].q * off.q;
            for (size_t m = 0; m < f->order; m++) {
                h[ORDER_MOST * n + m] += by[n].d * by[m].d + by[n].q * by[m].q;
            }
        }
    }
    return sum;
}

/* The step of Levenberg and Marquardt within the bounds. False: two numbers do the same. */
static bool step_from(const target *t, const fit *f, const double *h, const double *down, double damping,
                      double step[ORDER_MOST])
{
    double low[ORDER_MOST];
    double high[ORDER_MOST];
    double damped[ORDER_MOST * ORDER_MOST];
    memcpy(damped, h, sizeof damped);
    for (size_t n = 0; n < f->order; n++) {
        double *const own = &damped[ORDER_MOST * n + n];
        low[n] = t->low[n] - f->z[n];
        high[n] = t->high[n] - f->z[n];
        step[n] = 0.0;
        /* A number that no current shows stays where it is. */
        *own = *own > 0.0 ? (1.0 + damping) * *own : 1.0;
    }
    return solve_within(f->order, ORDER_MOST, damped, down, low, high, step);
}

static void improve(const target *t, fit *f)
{
    double h[ORDER_MOST * ORDER_MOST];
    double down[ORDER_MOST];
    double damping = 1e-2;
    double gained = INFINITY;
    f->error = error_of(t, f, h, down);
    for (int k = 0; k < STEPS && damping < 1e6 && gained > 1e-6; k++) {
        double step[ORDER_MOST];
        fit next = *f;
        if (step_from(t, f, h, down, damping, step)) {
            for (size_t n = 0; n < f->order; n++) {
                next.z[n] = fmin(fmax(f->z[n] + step[n], t->low[n]), t->high[n]);
            }
            next.error = error_of(t, &next, NULL, NULL);
        }
        if (next.error < f->error) {
            gained = 1.0 - next.error / f->error;
            *f = next;
            error_of(t, f, h, down);
            damping = fmax(damping / 3.0, 1e-5);
        } else {
            damping *= 4.0;
        }
    }
}

/* Adds a part that has a share of the inductance and saturates at the largest of the currents, about a centre. */
static fit with_part(const target *t, const fit *f, double share, double centre)
{
    const double most_A = t->longest_A;
    const double part[] = {share * fmax(t->drive->L_d_H, t->drive->L_q_H) * most_A * most_A, log(most_A),
                           log(most_A), centre * most_A};
    fit more = *f;
    memcpy(more.z + more.order, part, sizeof part);
    more.order += OF_PART;
    for (size_t n = 0; n < more.order; n++) {
        more.z[n] = fmin(fmax(more.z[n], t->low[n]), t->high[n]);
    }
    return more;
}

/* The drive with the parts in place of its map. */
static averaged_drive drive_of(const target *t, const fit *f)
{
    averaged_drive d = *t->drive;
    d.L_d_H = f->z[0];
    d.L_q_H = f->z[1];
    d.saturation = d.w_ddd = d.w_dqq = d.w_dddd = d.w_ddqq = d.w_qqqq = 0.0;
    for (size_t n = STRAIGHT, k = 0; k < IRON_PARTS; n += OF_PART, k++) {
        const fit none = with_part(t, &(fit){.order = n}, 0.0, 0.0);
        const double *const z = n < f->order ? f->z + n : none.z + n;
        d.iron[k] = (iron_part){z[0], exp(z[1]), exp(z[2]), z[3]};
        const flux_map_slope at_none = flux_map_part_slope(&d.iron[k]);
        d.L_d_H += at_none.dd;
        d.L_q_H += at_none.qq;
    }
    return d;
}

double flux_parts_closest(const averaged_drive *drive, const vec_dq *i, size_t count,
                          const flux_parts_limits *limits, size_t parts, averaged_drive *to)
{
    static const double centre[] = {-0.3, 0.3};
    const target t = target_of(drive, i, count, limits);
    const fit straight = {STRAIGHT, {0.5 * drive->L_d_H, 0.5 * drive->L_q_H}, INFINITY};
    fit one = with_part(&t, &straight, 0.3, 0.0);
    improve(&t, &one);
    fit best = one;
    for (size_t n = 0; parts > 1 && n < sizeof centre / sizeof centre[0]; n++) {
        fit two = with_part(&t, &one, 0.05, centre[n]);
        improve(&t, &two);
        best = two.error < best.error ? two : best;
    }
    *to = drive_of(&t, &best);
    return sqrt(best.error / t.squares);
}
