/* Distortion, switchings and torque of a run through the pulse modes (pulse_samples.h). */
#include "pulse_samples.h"

#include "base/vector.h"
#include "patterns/carrier_ripple.h"
#include "patterns/patterns.h"

#include <math.h>
#include <string.h>

#define START_S   0.04 /* left out at both ends */
#define LONGEST_S 0.04 /* of a turn, as a span of the mean torque */
#define POINT_S   0.01 /* a point is at least so long, in whole turns */
#define POINT_HZ  20.0 /* points from this frequency on */
#define TRACE_S   2e-3 /* of the trace of the torque error */
#define WHOLE     0.1  /* distance of the pulses a turn from a whole number */

#define EVERY (lround(PULSE_TORQUE_S / PULSE_SAMPLE_S)) /* samples from one mean torque to the next */

const char *const pulse_run_mode_text[PULSE_RUN_MODES] = {
    [PULSE_FIXED] = "fixed carrier",           [PULSE_CARRIER_21] = "carrier, 21 a turn",
    [PULSE_CARRIER_15] = "carrier, 15 a turn", [PULSE_CARRIER_9] = "carrier, 9 a turn",
    [PULSE_PATTERN_9] = "pattern, 9 pulses",   [PULSE_PATTERN_7] = "pattern, 7 pulses",
    [PULSE_PATTERN_5] = "pattern, 5 pulses",   [PULSE_SIX_STEP] = "six-step",
};
const int pulse_run_mode_pulses[PULSE_RUN_MODES] = {0, 21, 15, 9, 9, 7, 5, 1};

static double turn_s(const pulse_sample *at)
{
    return fmin(VEC_TWO_PI / fabs(at->w), LONGEST_S);
}

double pulse_mean_torque(const pulse_sample *at)
{
    const long half = lround(turn_s(at) / 3.0 / PULSE_SAMPLE_S);
    double sum = 0.0;
    double weights = 0.0;
    for (long n = -half; n <= half; n++) {
        const double weight = 1.0 + cos(VEC_PI * (double)n / ((double)half + 0.5));
        sum += weight * cimag(at[n].i);
        weights += weight;
    }
    return sum / weights;
}

static pulse_event event_of(const pulse_sample *before, const pulse_sample *after)
{
    if (before->mode <= PULSE_CARRIER_9) {
        return after->mode <= PULSE_CARRIER_9 ? PULSE_EVENT_CARRIER : PULSE_EVENT_TO_PATTERN;
    }
    if (after->mode <= PULSE_CARRIER_9) {
        return PULSE_EVENT_TO_CARRIER;
    }
    if (before->jumps != after->jumps) {
        return PULSE_EVENT_JUMP;
    }
    if (before->mode == after->mode) {
        return before->mode == PULSE_SIX_STEP ? PULSE_EVENT_TOP : PULSE_EVENT_PATTERNS;
    }
    return after->mode == PULSE_SIX_STEP    ? PULSE_EVENT_TO_SIX_STEP
           : before->mode == PULSE_SIX_STEP ? PULSE_EVENT_FROM_SIX_STEP
                                            : PULSE_EVENT_PATTERNS;
}

static double hz_of(const pulse_sample *at)
{
    return fabs(at->w) / VEC_TWO_PI;
}

static void measure_torque(const pulse_sample *sample, long count, double wanted, pulse_run_up *r)
{
    const long margin = lround(START_S / PULSE_SAMPLE_S);
    const long block = lround(TRACE_S / PULSE_SAMPLE_S);
    for (long k = margin; k < count - margin; k += EVERY) {
        const pulse_sample *at = &sample[k];
        const long turn = lround(turn_s(at) / PULSE_SAMPLE_S);
        const double off = 100.0 * (pulse_mean_torque(at) - wanted);
        double *of_event = &r->worst_percent[event_of(at - turn, at + turn)];
        double *of_mode = &r->mode[at->mode].torque_percent;
        *of_event = fmax(*of_event, fabs(off));
        *of_mode = isnan(*of_mode) ? fabs(off) : fmax(*of_mode, fabs(off));
        if ((k - margin) / block == r->traced && r->traced < PULSE_TRACE) {
            r->trace[r->traced++] = (pulse_error){hz_of(at), off, k < count / 2};
        } else if (r->traced > 0 && fabs(off) > fabs(r->trace[r->traced - 1].percent)) {
            r->trace[r->traced - 1].percent = off;
        }
    }
}

long pulse_samples_torque(const pulse_sample *sample, long count, double i_q, pulse_torque *torque,
                          long capacity)
{
    const long margin = lround(START_S / PULSE_SAMPLE_S);
    const long every = EVERY;
    long n = 0;
    for (long k = margin; k < count - margin && n < capacity; k += every, n++) {
        torque[n] =
            (pulse_torque){100.0 * (pulse_mean_torque(&sample[k]) - i_q), turn_s(&sample[k]), sample[k].mode};
    }
    return n;
}

/* Space vectors with so many pulses a turn: their flux over that of the rated current. */
static double space_vectors(const motor *m, double w, double complex i, double pulses)
{
    const pattern_weight same = {1.0, 1.0};
    const int whole = (int)lround(pulses);
    if (whole < 3 || fabs(pulses - whole) > WHOLE) {
        return NAN;
    }
    const double index = patterns_index_of(m, w, creal(i), cimag(i));
    const double flux_Wb = index * 2.0 / VEC_PI * m->u_dc_V / fabs(w);
    return carrier_ripple(whole, index, &same) * flux_Wb / (m->L_d_H * motor_rated_peak_A(m));
}

/* From sample `first` to `end`, whole turns. */
static pulse_point point_of(const pulse_sample *sample, long first, long end, long count, const motor *m)
{
    const double turns = fabs(sample[end].theta - sample[first].theta) / VEC_TWO_PI;
    const double s = (double)(end - first) * PULSE_SAMPLE_S;
    double complex sum = 0.0;
    double square = 0.0;
    for (long k = first; k < end; k++) {
        sum += sample[k].i;
        square += creal(sample[k].i * conj(sample[k].i));
    }
    const double complex mean = sum / (double)(end - first);
    const double pulses = (double)(sample[end].edges - sample[first].edges) / 6.0;
    pulse_point p = {.hz = turns / s, .mode = sample[first].mode, .up = first < count / 2};
    p.distortion = sqrt(fmax(square / (double)(end - first) - creal(mean * conj(mean)), 0.0));
    p.pulses = pulses / turns;
    p.switching_Hz = pulses / s;
    p.space_vectors = p.mode == PULSE_FIXED ? NAN : space_vectors(m, VEC_TWO_PI * p.hz, mean, p.pulses);
    return p;
}

static void measure_points(const pulse_sample *sample, long count, const motor *m, pulse_run_up *r)
{
    long began = 0; /* of the mode */
    long first = 0;
    for (long k = 1; k < count && r->points < PULSE_POINTS; k++) {
        if (sample[k].mode != sample[k - 1].mode || hz_of(&sample[k]) < POINT_HZ) {
            began = k;
            first = k;
        }
        const double turns = fabs(sample[k].theta - sample[first].theta) / VEC_TWO_PI;
        if (first == began) { /* a turn to settle */
            first = turns >= 1.0 ? k : first;
        } else if (turns >= fmax(2.0, ceil(POINT_S * hz_of(&sample[first])))) {
            r->point[r->points++] = point_of(sample, first, k, count, m);
            first = k;
        }
    }
}

static void measure_visits(const pulse_sample *sample, long count, pulse_run_up *r)
{
    for (long k = 0; k < count; k++) {
        pulse_row *row = &r->mode[sample[k].mode];
        const bool up = k < count / 2;
        const bool enters = k == 0 || sample[k].mode != sample[k - 1].mode;
        const double hz = hz_of(&sample[k]);
        row->visits_up += enters && up ? 1 : 0;
        row->visits_down += enters && !up ? 1 : 0;
        if (up) {
            row->from_Hz = enters ? hz : row->from_Hz;
            row->to_Hz = hz;
        }
        row->down_to_Hz = hz;
    }
}

static void summarise(pulse_run_up *r)
{
    for (int m = 0; m < PULSE_RUN_MODES; m++) {
        double square = 0.0;
        double carrier = 0.0;
        int compared = 0;
        double all = 0.0;
        int points = 0;
        for (int n = 0; n < r->points; n++) {
            const pulse_point *p = &r->point[n];
            if (p->mode == (pulse_run_mode)m) {
                const bool both = !isnan(p->space_vectors);
                compared += both ? 1 : 0;
                square += both ? p->distortion * p->distortion : 0.0;
                carrier += both ? p->space_vectors * p->space_vectors : 0.0;
                all += p->distortion * p->distortion;
                points++;
                r->mode[m].switching_Hz =
                    fmax(r->mode[m].switching_Hz, p->switching_Hz); /* of NAN the other */
            }
        }
        if (points > 0) {
            r->mode[m].distortion = compared > 0 ? sqrt(square / compared) : sqrt(all / points);
            r->mode[m].space_vectors = compared > 0 ? sqrt(carrier / compared) : NAN;
        }
    }
}

void pulse_samples_measure(const pulse_sample *sample, long count, const motor *m, double i_q,
                           pulse_run_up *result)
{
    for (int n = 0; n < PULSE_RUN_MODES; n++) {
        result->mode[n] = (pulse_row){0, 0, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    }
    memset(result->worst_percent, 0, sizeof result->worst_percent);
    result->points = 0;
    result->traced = 0;
    measure_torque(sample, count, i_q, result);
    measure_points(sample, count, m, result);
    measure_visits(sample, count, result);
    summarise(result);
}
