/* The search for the bandwidth (tune_design.h). */
#include "tune_design.h"

#include "base/vector.h"

#include <math.h>
#include <stdio.h>

const char *const tune_method_text[2] = {"pi", "deadbeat"};

/* The valley's offset is estimated over twenty cycles, and at most with a quarter of the observer gain. */
#define LEARN_OFFSET 0.05

#define FASTEST VEC_PI
#define SLOWEST 0.01

tune_design tune_design_of(tune_method method, const tune_machine *machine, double T_s, double w_T)
{
    const double keep = exp(-w_T);
    const double learn = 0.5 * (1.0 - keep);
    const tune_design d = {.machine = *machine,
                           .T_s = T_s,
                           .keep = keep,
                           .follow = method == TUNE_PI ? keep : 0.0,
                           .learn = learn,
                           .learn_offset = fmin(LEARN_OFFSET, 0.25 * learn)};
    return d;
}

/* A speed and a machine of the uncertainty set. */
typedef struct place {
    int speed, point;
} place;

static double disk_at(const tune_result *r, const tune_design *d, place at)
{
    tune_loop loop;
    tune_loop_make(d, &r->region.point[at.point].machine, r->at[at.speed].phi_rad, &tune_no_fault, &loop);
    return tune_disk_margin(&loop);
}

/* The worst of all places. */
static double disk_everywhere(const tune_result *r, const tune_design *d, place *worst)
{
    double least = INFINITY;
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        for (int p = 0; p < r->region.points; p++) {
            const place here = {s, p};
            const double disk = disk_at(r, d, here);
            if (disk < least) {
                least = disk;
                *worst = here;
            }
        }
    }
    return least;
}

/* Places that were the worst of some bandwidth. */
typedef struct place_list {
    place at[32];
    int count;
} place_list;

static bool holds_at(const tune_result *r, const place_list *list, double w_T)
{
    const tune_design d = tune_design_of(r->method, &r->region.centre, 1.0 / r->motor.f_pwm_Hz, w_T);
    for (int n = list->count - 1; n >= 0; n--) {
        if (disk_at(r, &d, list->at[n]) < r->disk_wanted) {
            return false;
        }
    }
    return true;
}

/*
 * The highest bandwidth, up to `most`, that reaches the margin at the listed places: down in steps of a tenth, then
 * bisected.
 */
static double highest(const tune_result *r, const place_list *list, double most)
{
    double lost = most;
    double held = most;
    while (!holds_at(r, list, held)) {
        lost = held;
        held *= 0.9;
        if (held < SLOWEST) {
            return 0.0;
        }
    }
    while (lost / held > 1.002) {
        const double middle = sqrt(lost * held);
        if (holds_at(r, list, middle)) {
            held = middle;
        } else {
            lost = middle;
        }
    }
    return held;
}

/* The best margin of the listed places at any bandwidth: an upper bound for all places. */
static bool nothing_holds(const tune_result *r, const place_list *list, error *e)
{
    double best = 0.0;
    place worst_of_best = list->at[0];
    for (double w_T = FASTEST; w_T > SLOWEST; w_T *= 0.8) {
        const tune_design d = tune_design_of(r->method, &r->region.centre, 1.0 / r->motor.f_pwm_Hz, w_T);
        double least = INFINITY;
        place worst = list->at[0];
        for (int n = 0; n < list->count; n++) {
            const double disk = disk_at(r, &d, list->at[n]);
            worst = disk < least ? list->at[n] : worst;
            least = fmin(least, disk);
        }
        worst_of_best = least > best ? worst : worst_of_best;
        best = fmax(best, least);
    }
    return error_input(
        e, NULL, 0, 0,
        "tune: no bandwidth reaches a disk margin of %g over the uncertainty set: the best is %.2f, at %.0f "
        "rpm with %s; expected --margin below that, a smaller uncertainty or a higher f_pwm_Hz",
        r->disk_wanted, best, r->at[worst_of_best.speed].rpm, r->region.point[worst_of_best.point].text);
}

/* The search's result in words: what keeps the bandwidth from being higher. */
static void say_limit(tune_result *r, bool by_sampling, double disk, place worst)
{
    if (by_sampling) {
        (void)snprintf(r->limited_by, sizeof r->limited_by,
                       "sampling: the margin still holds at pi/T, the highest bandwidth");
    } else {
        (void)snprintf(r->limited_by, sizeof r->limited_by, "disk margin %.2f at %.0f rpm with %s", disk,
                       r->at[worst.speed].rpm, r->region.point[worst.point].text);
    }
}

static bool find_bandwidth(tune_result *r, double *w_T, error *e)
{
    place_list list = {.count = 0};
    place worst = {0, 0};
    *w_T = FASTEST;
    for (;;) {
        const tune_design d = tune_design_of(r->method, &r->region.centre, 1.0 / r->motor.f_pwm_Hz, *w_T);
        const double disk = disk_everywhere(r, &d, &worst);
        if (disk >= r->disk_wanted * TUNE_DISK_ACCEPTED ||
            list.count == (int)(sizeof list.at / sizeof list.at[0])) {
            say_limit(r, list.count == 0, disk, worst);
            return true;
        }
        list.at[list.count++] = worst;
        *w_T = highest(r, &list, *w_T);
        if (!(*w_T > 0.0)) {
            return nothing_holds(r, &list, e);
        }
    }
}

static void measure(tune_result *r, int speed)
{
    tune_at_speed *at = &r->at[speed];
    tune_loop loop;
    at->radius_worst = 0.0;
    for (int p = 0; p < r->region.points; p++) {
        const tune_machine *machine = &r->region.point[p].machine;
        const tune_margins m = tune_margins_of(&r->design, machine, at->phi_rad);
        tune_loop_make(&r->design, machine, at->phi_rad, &tune_no_fault, &loop);
        if (p == 0) {
            at->radius_worst = tune_poles(&loop, at->pole);
            at->poles = loop.order;
            at->nominal = at->worst = m;
            at->disk_worst = 0;
        } else {
            at->radius_worst = fmax(at->radius_worst, tune_poles(&loop, NULL));
            at->disk_worst = m.disk < at->worst.disk ? p : at->disk_worst;
            at->worst = tune_margins_worst(at->worst, m);
        }
    }
}

bool tune_design_bandwidth(tune_result *r, error *e)
{
    const double T_s = 1.0 / r->motor.f_pwm_Hz;
    double w_T = 0.0;
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        tune_at_speed *at = &r->at[s];
        at->rpm = r->motor.n_max_rpm * s / (TUNE_SPEEDS - 1);
        at->phi_rad = motor_speed_rad_s(&r->motor, at->rpm) * T_s;
        at->sffr = s > 0 ? VEC_TWO_PI / at->phi_rad : INFINITY;
    }
    if (!find_bandwidth(r, &w_T, e)) {
        return false;
    }
    r->design = tune_design_of(r->method, &r->region.centre, T_s, w_T);
    r->bandwidth_rad_s = w_T / T_s;
    return true;
}

bool tune_design_find(tune_result *r, error *e)
{
    if (!tune_design_bandwidth(r, e)) {
        return false;
    }
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        measure(r, s);
    }
    r->design.learn_offset = r->halves ? 0.0 : r->design.learn_offset;
    return true;
}
