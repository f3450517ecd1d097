/* The porting checklist (port_check.h). */
#include "port_check.h"

#include <math.h>
#include <stdarg.h>

/* Cycles after which a port's filter of angle or speed has settled. */
#define SETTLE_CYCLES 400

const char *port_check_wrong(const char *format, ...)
{
    static char text[160];
    va_list arguments;
    va_start(arguments, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): started in the line above */
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

static double pu(iq24_t x)
{
    return x / 16777216.0;
}

/* The handler of the next valley, `late` cycles after it. */
static iqfoc_sample_t valley(const port_rig *rig, double late)
{
    iqfoc_sample_t sample;
    rig->go_to(0.99);
    rig->go_to(late);
    iqfoc_hal_read_valley(rig->hal, &sample);
    return sample;
}

/* The handler of this period's peak; the same one's second half where there is one trigger. */
static iqfoc_sample_t peak(const port_rig *rig, double late)
{
    iqfoc_sample_t sample;
    if (!rig->one_trigger) {
        rig->go_to(0.5 + late);
    }
    iqfoc_hal_read_peak(rig->hal, &sample);
    return sample;
}

/* "B and C" if those two being exchanged explains all sets of readings, each over its difference to the third; else NULL. */
static const char *exchanged(const double (*got)[3], const double (*want)[3], int sets, double tolerance)
{
    static const char *const pair[3] = {"B and C", "C and A", "A and B"};
    for (int stays = 0; stays < 3; stays++) {
        const int one = (stays + 1) % 3;
        const int other = (stays + 2) % 3;
        bool fits = true;
        for (int k = 0; k < sets && fits; k++) {
            fits = fabs(got[k][one] - got[k][stays] - want[k][other] + want[k][stays]) <= tolerance &&
                   fabs(got[k][other] - got[k][stays] - want[k][one] + want[k][stays]) <= tolerance;
        }
        if (fits) {
            return pair[stays];
        }
    }
    return NULL;
}

/* A mean that is said to be there is that of the interval: of a constant current, the current. */
static const char *mean_off(const iqfoc_sample_t *sample, const double i_pu[3], double step)
{
    const double got[3] = {pu(sample->i_mean.a), pu(sample->i_mean.b), pu(sample->i_mean.c)};
    for (int x = 0; x < 3 && sample->has_mean; x++) {
        if (!(fabs(got[x] - i_pu[x]) <= 2.0 * step)) {
            return port_check_wrong("has_mean is true, but the mean of phase %c reads %.4f, true %.4f",
                                    "ABC"[x], got[x], i_pu[x]);
        }
    }
    return NULL;
}

static const char *currents_off(const iqfoc_sample_t *sample, const double i_pu[3], double step,
                                const char *where)
{
    const double got[3] = {pu(sample->i.a), pu(sample->i.b), pu(sample->i.c)};
    for (int x = 0; x < 3; x++) {
        if (!(fabs(got[x] - i_pu[x]) <= 2.0 * step)) {
            return port_check_wrong("%s: phase %c reads %.4f, true %.4f: scaling, sign or order", where,
                                    "ABC"[x], got[x], i_pu[x]);
        }
    }
    return NULL;
}

enum { CURRENT_SETS = 5 };

static const char *current_scaling_signs_and_order(port_rig_start *start)
{
    static const double sets[CURRENT_SETS][3] = {
        {0.6, -0.3, -0.3}, {-0.3, 0.6, -0.3}, {-0.3, -0.3, 0.6}, {-0.8, 0.5, 0.3}, {0.0, 0.0, 0.0}};
    const port_rig *rig = start();
    double got[CURRENT_SETS][3];
    for (int k = 0; k < CURRENT_SETS; k++) {
        rig->set_current(sets[k]);
        const iqfoc_sample_t sample = valley(rig, 0.01);
        (void)peak(rig, 0.01);
        got[k][0] = pu(sample.i.a);
        got[k][1] = pu(sample.i.b);
        got[k][2] = pu(sample.i.c);
    }
    const char *legs = exchanged((const double(*)[3])got, sets, CURRENT_SETS, 4.0 * rig->current_step_pu);
    if (legs != NULL) {
        return port_check_wrong("the currents of phases %s are exchanged", legs);
    }
    for (int k = 0; k < CURRENT_SETS; k++) {
        rig->set_current(sets[k]);
        (void)valley(rig, 0.01);
        (void)peak(rig, 0.01);
        const iqfoc_sample_t at_valley = valley(rig, 0.01); /* after a whole interval of this current */
        const iqfoc_sample_t at_peak = peak(rig, 0.01);
        const char *off = currents_off(&at_valley, sets[k], rig->current_step_pu, "valley");
        off = off == NULL ? currents_off(&at_peak, sets[k], rig->current_step_pu, "peak") : off;
        off = off == NULL ? mean_off(&at_valley, sets[k], rig->current_step_pu) : off;
        off = off == NULL ? mean_off(&at_peak, sets[k], rig->current_step_pu) : off;
        if (off != NULL) {
            return off;
        }
        if (at_valley.clipped || at_peak.clipped) {
            return port_check_wrong("clipped is said of a current well within the range");
        }
    }
    const double beyond[3] = {100.0, -50.0, -50.0};
    rig->set_current(beyond);
    (void)valley(rig, 0.01);
    return peak(rig, 0.01).clipped ? NULL
                                   : port_check_wrong("a converter at its end is not reported as clipped");
}

static const char *dc_link(port_rig_start *start)
{
    const double links[3] = {0.8, 1.0, 1.2};
    const port_rig *rig = start();
    for (int k = 0; k < 3; k++) {
        rig->set_dc_link(links[k]);
        const double got = pu(valley(rig, 0.01).u_dc);
        if (!(fabs(got - links[k]) <= 0.002)) {
            return port_check_wrong("the DC link reads %.4f, true %.4f", got, links[k]);
        }
    }
    return NULL;
}

/* A shaft that turns evenly: the angle is that of the sampling instant although it is read later. */
static const char *angle_and_speed(port_rig_start *start)
{
    const double speeds[2] = {0.03, -0.03}; /* turns per cycle */
    const double late = 0.05;
    for (int way = 0; way < 2; way++) {
        const port_rig *rig = start();
        double angle = 0.4;
        iqfoc_sample_t sample = {.theta = 0};
        for (int k = 0; k < SETTLE_CYCLES; k++) {
            rig->go_to(0.99);
            rig->set_angle(angle + speeds[way] * late); /* where the shaft is when the handler reads it */
            sample = valley(rig, late);
            (void)peak(rig, late);
            angle += speeds[way];
        }
        angle -= speeds[way];
        if (!(fabs(pu(sample.speed) - speeds[way]) <= 0.1 * fabs(speeds[way]))) {
            return port_check_wrong(
                "speed reads %.5f turns a cycle, true %.5f: scaling, or A -> B -> C is not positive",
                pu(sample.speed), speeds[way]);
        }
        if (!(fabs(remainder(pu(sample.theta) - angle, 1.0)) <= 2.0 * rig->angle_step)) {
            return port_check_wrong(
                "angle is off by %.4f turns: offset, scaling, or not of the sampling instant",
                remainder(pu(sample.theta) - angle, 1.0));
        }
    }
    return NULL;
}

static bool ticks_differ(uint32_t from, uint32_t to, double want, uint32_t period)
{
    return !(fabs((double)((to - from) & UINT32_MAX) - want) <= period / 200.0);
}

/* `instant` and `time` are those of the instant, however late the handler comes. */
static const char *sampling_instant(port_rig_start *start)
{
    const port_rig *rig = start();
    const uint32_t period = rig->period_ticks();
    const double half = rig->one_trigger ? 0.0 : 0.5;
    uint32_t last = 0;
    for (int k = 0; k < 20; k++) {
        const double late = 0.02 * k;
        const iqfoc_sample_t at_valley = valley(rig, late);
        const uint32_t now = iqfoc_hal_now(rig->hal);
        const iqfoc_sample_t at_peak = peak(rig, late);
        if (at_valley.instant != 0 || at_peak.instant != (iq24_t)(half * IQ24_ONE)) {
            return port_check_wrong("`instant` of the %s", at_valley.instant != 0 ? "valley" : "peak");
        }
        if (ticks_differ(at_valley.time, now, late * period, period)) {
            return port_check_wrong("`time` is not that of the valley, but of %.3f cycles after it",
                                    late - (double)(now - at_valley.time) / period);
        }
        if (k > 0 && ticks_differ(last, at_valley.time, period, period)) {
            return port_check_wrong("two valleys are %u ticks apart, a period is %u",
                                    (unsigned)(at_valley.time - last), (unsigned)period);
        }
        if (ticks_differ(at_valley.time, at_peak.time, half * period, period)) {
            return port_check_wrong("`time` is not that of the peak");
        }
        last = at_valley.time;
    }
    return NULL;
}

static iqfoc_command_t command_of(double a, double b, double c)
{
    iqfoc_command_t command = {{{0, 0, 0}, IQ24_ONE}, true};
    command.duties.high.a = (iq24_t)lround(a * IQ24_ONE);
    command.duties.high.b = (iq24_t)lround(b * IQ24_ONE);
    command.duties.high.c = (iq24_t)lround(c * IQ24_ONE);
    return command;
}

/* The share of the coming period for which each leg is high; it begins at the valley. */
static void watch_period(const port_rig *rig, double share[3])
{
    const int steps = 2000;
    int high[3] = {0, 0, 0};
    for (int k = 0; k < steps; k++) {
        rig->go_to((k + 0.5) / steps);
        for (int leg = 0; leg < 3; leg++) {
            high[leg] += rig->leg_high(leg) ? 1 : 0;
        }
    }
    for (int leg = 0; leg < 3; leg++) {
        share[leg] = (double)high[leg] / steps;
    }
}

static const char *update_instant(port_rig_start *start)
{
    const iqfoc_command_t before = command_of(0.2, 0.1, 0.1);
    const iqfoc_command_t after = command_of(0.8, 0.1, 0.1);
    const port_rig *rig = start();
    rig->go_to(0.6);
    iqfoc_hal_write(rig->hal, &before);
    rig->go_to(0.0);
    rig->go_to(0.55);
    if (!rig->leg_high(0)) {
        return port_check_wrong("a leg is not high around the peak");
    }
    iqfoc_hal_write(rig->hal, &after);
    /* 0.2 of a period is 0.4 ... 0.6; 0.8 would be 0.1 ... 0.9. */
    for (double phase = 0.62; phase < 0.99; phase += 0.01) {
        rig->go_to(phase);
        if (rig->leg_high(0)) {
            return port_check_wrong("a command acts before the next valley");
        }
    }
    double share[3];
    watch_period(rig, share);
    if (!(fabs(share[0] - 0.8) <= 0.002)) {
        return port_check_wrong("a command does not act from the next valley on");
    }
    /* A command that comes too late for its valley waits for the next: it must not act at the peak. */
    rig->go_to(0.05);
    iqfoc_hal_write(rig->hal, &before);
    rig->go_to(0.85);
    return rig->leg_high(0) ? NULL : port_check_wrong("a late command acts in the middle of a period");
}

enum { DUTY_SETS = 4 };

/* What the legs have in common may be moved, as low-side shunts ask for: differences are compared. */
static const char *duties_and_order(port_rig_start *start)
{
    static const double sets[DUTY_SETS][3] = {
        {0.1, 0.5, 0.9}, {0.7, 0.3, 0.0}, {1.0, 0.25, 0.0}, {0.0, 0.0, 0.0}};
    const port_rig *rig = start();
    double share[DUTY_SETS][3];
    for (int k = 0; k < DUTY_SETS; k++) {
        const iqfoc_command_t command = command_of(sets[k][0], sets[k][1], sets[k][2]);
        rig->go_to(0.6);
        iqfoc_hal_write(rig->hal, &command);
        rig->go_to(0.99);
        watch_period(rig, share[k]);
    }
    const char *legs = exchanged((const double(*)[3])share, sets, DUTY_SETS, 0.004);
    if (legs != NULL) {
        return port_check_wrong("legs %s are exchanged", legs);
    }
    for (int k = 0; k < DUTY_SETS; k++) {
        for (int leg = 0; leg < 3; leg++) {
            const double got = share[k][leg] - share[k][2];
            const double want = sets[k][leg] - sets[k][2];
            if (!(fabs(got - want) <= 0.002) || share[k][leg] > sets[k][leg] + 0.002) {
                return port_check_wrong(
                    "leg %c is high for %.3f of the period, asked for %.3f: scaling, sense or order",
                    "ABC"[leg], share[k][leg], sets[k][leg]);
            }
        }
    }
    return NULL;
}

static const char *gates(port_rig_start *start)
{
    const iqfoc_command_t on = command_of(0.5, 0.5, 0.5);
    iqfoc_command_t off = command_of(0.0, 0.0, 0.0);
    const port_rig *rig = start();
    off.gates = false;
    if (rig->outputs_on()) {
        return port_check_wrong("the gates are on before any command");
    }
    rig->go_to(0.6);
    iqfoc_hal_write(rig->hal, &on);
    rig->go_to(0.1);
    if (!rig->outputs_on()) {
        return port_check_wrong("the gates do not come on");
    }
    iqfoc_hal_write(rig->hal, &off);
    return rig->outputs_on() ? port_check_wrong("gates off must act at once, not at the valley") : NULL;
}

const port_check_item port_check_items[PORT_CHECK_ITEMS] = {
    {"currents: scaling, signs, order, clipping", current_scaling_signs_and_order},
    {"DC link: scaling", dc_link},
    {"angle and speed: direction, and of the sampling instant", angle_and_speed},
    {"sampling instant: at and time", sampling_instant},
    {"update instant: from the next valley, at no other time", update_instant},
    {"duties: share, sense, order of the legs", duties_and_order},
    {"gates: off at the start, on, off at once", gates},
};

int port_check_run(const port_check_item *items, int count, port_rig_start *start, FILE *out)
{
    int failed = 0;
    for (int k = 0; k < count; k++) {
        const char *what = items[k].run(start);
        (void)fprintf(out, "[%c] %s%s%s\n", what == NULL ? 'x' : ' ', items[k].name, what == NULL ? "" : ": ",
                      what == NULL ? "" : what);
        failed += what != NULL;
    }
    return failed;
}

int port_check_all(port_rig_start *start, FILE *out)
{
    return port_check_run(port_check_items, PORT_CHECK_ITEMS, start, out);
}
