/* A closed loop and its measures (closed_loop.h). */
#include "closed_loop.h"

#include <math.h>
#include <stdlib.h>

/* Points of the current's waveform in a cycle, for its distortion: ripple is straight between edges. */
enum { POINTS = 24 };

const char *loop_outcome_text(loop_outcome outcome)
{
    static const char *const text[] = {"holds", "misses", "unstable", "trips"};
    return text[outcome];
}

/* What the run collects. */
typedef struct loop_run {
    const loop_case *c;
    drive_loop loop;
    double *error_d, *error_q; /* per unit, each cycle from the step on */
    long cycle, steady_from, cycles;
    double square_sum, fundamental_re, fundamental_im; /* of phase A in the steady window */
    long points;
    double cycle_torque_Nm, torque_sum, torque_square_sum; /* of the cycle that runs; of the cycles' means */
    long edges;
    double half_d, half_q;     /* means of the last half up to a peak */
    double period_d, period_q; /* of the last carrier period */
    bool tripped;
} loop_run;

static void take_point(void *context, const plant *drive)
{
    loop_run *r = context;
    if (r->cycle >= r->steady_from) {
        const plant_point now = plant_now(drive);
        r->square_sum += now.i_A[0] * now.i_A[0];
        r->fundamental_re += now.i_A[0] * cos(now.theta_e_rad);
        r->fundamental_im += now.i_A[0] * sin(now.theta_e_rad);
        r->points++;
        r->cycle_torque_Nm += now.torque_Nm / POINTS;
    }
}

/* A leg at 0 or 1 throughout has no pulse; one that changes between such cycles has half of one. */
static void count_edges(loop_run *r, const double before[3])
{
    for (int x = 0; x < 3; x++) {
        const double duty = r->loop.duty[x];
        const bool pulses = duty > 0.0 && duty < 1.0;
        const bool flips = !pulses && (before[x] <= 0.0 || before[x] >= 1.0) && before[x] != duty;
        r->edges += pulses && !r->c->halves ? 2 : pulses || flips ? 1 : 0; /* half a period has one edge */
    }
}

static double reference_q(const loop_run *r)
{
    return (r->cycle < LOOP_SETTLE_CYCLES ? r->c->i_q_before_A : r->c->i_q_after_A) / r->loop.base.I_A;
}

static bool one_cycle(loop_run *r, loop_result *result, error *e)
{
    const double i_q_ref = reference_q(r);
    const iqfoc_dq_t i_ref = {0, iq24_from_double(i_q_ref)};
    drive_row row;
    if (!drive_loop_span(&r->loop, i_ref, &row, e)) {
        return false;
    }
    double d = row.truth.i_dq_A.d / r->loop.base.I_A;
    double q = row.truth.i_dq_A.q / r->loop.base.I_A;
    if (r->c->halves && r->loop.falling) { /* the half up to the peak has ended */
        r->half_d = d;
        r->half_q = q;
        d = r->period_d;
        q = r->period_q;
    } else if (r->c->halves) {
        d = r->period_d = 0.5 * (r->half_d + d);
        q = r->period_q = 0.5 * (r->half_q + q);
    }
    const double off = hypot(d, q - i_q_ref);
    const long shown = r->cycle - (LOOP_SETTLE_CYCLES - LOOP_TRACE_BEFORE);
    if (shown >= 0 && shown < LOOP_TRACE_CYCLES) {
        result->trace_q[shown] = q;
    }
    if (r->cycle < LOOP_TRACE_CYCLES) {
        result->trace_start[r->cycle] = 100.0 * off;
    }
    if (r->cycle >= LOOP_SETTLE_CYCLES) {
        r->error_d[r->cycle - LOOP_SETTLE_CYCLES] = d;
        r->error_q[r->cycle - LOOP_SETTLE_CYCLES] = q - i_q_ref;
    } else if (r->cycle >= LOOP_START_CYCLES) {
        result->start_percent = fmax(result->start_percent, 100.0 * off);
    }
    r->tripped = r->tripped || hypot(d, q) > LOOP_TRIP_LIMIT || !row.answer.command.gates;
    if (r->cycle >= r->steady_from) {
        count_edges(r, row.duty);
        r->torque_sum += r->cycle_torque_Nm;
        r->torque_square_sum += r->cycle_torque_Nm * r->cycle_torque_Nm;
        r->cycle_torque_Nm = 0.0;
    }
    return true;
}

static void measure_step(const loop_run *r, loop_result *result)
{
    const double step = (r->c->i_q_after_A - r->c->i_q_before_A) / r->loop.base.I_A;
    double beyond = 0.0;
    double remains = 0.0;
    long last_outside = -1;
    long last_beside = -1;
    for (long n = LOOP_TRANSIENT_CYCLES; n < r->cycles - LOOP_SETTLE_CYCLES; n++) {
        remains = fmax(remains, hypot(r->error_d[n], r->error_q[n]));
    }
    for (long n = 0; n < LOOP_TRANSIENT_CYCLES; n++) {
        const double off = hypot(r->error_d[n], r->error_q[n]);
        beyond = fmax(beyond, r->error_q[n] / step);
        last_outside = off > LOOP_SETTLED ? n : last_outside;
        last_beside = off > remains + LOOP_SETTLED ? n : last_beside;
    }
    result->settling_beside_cycles = (int)(last_beside + 1);
    result->overshoot_percent = 100.0 * beyond;
    result->settling_cycles = last_outside + 1 < LOOP_TRANSIENT_CYCLES ? (int)(last_outside + 1) : -1;
}

static void measure_steady(const loop_run *r, loop_result *result)
{
    const long from = r->steady_from - LOOP_SETTLE_CYCLES;
    const long to = r->cycles - LOOP_SETTLE_CYCLES;
    double d = 0.0;
    double q = 0.0;
    double square = 0.0;
    for (long n = from; n < to; n++) {
        d += r->error_d[n] / (double)(to - from);
        q += r->error_q[n] / (double)(to - from);
        square += (r->error_d[n] * r->error_d[n] + r->error_q[n] * r->error_q[n]) / (double)(to - from);
    }
    const double offset = hypot(d, q);
    const double wander = sqrt(fmax(square - offset * offset, 0.0));
    result->rms_percent = 100.0 * sqrt(square);
    result->offset_percent = 100.0 * offset;
    result->wander_percent = 100.0 * wander;
    result->i_d_offset_percent = 100.0 * d;
    result->i_q_offset_percent = 100.0 * q;
    const double points = (double)r->points;
    const double rms_squared = r->square_sum / points;
    const double peak = 2.0 * hypot(r->fundamental_re, r->fundamental_im) / points;
    const double fundamental_squared = 0.5 * peak * peak;
    result->thd_percent = 100.0 * sqrt(fmax(rms_squared - fundamental_squared, 0.0) / fundamental_squared);
    const double cycles = (double)(to - from);
    const double torque_Nm = r->torque_sum / cycles;
    const plant_machine *machine = &r->loop.drive.config.machine;
    const double asked_Nm = 1.5 * machine->pole_pairs * machine->psi_f_Wb * r->c->i_q_after_A;
    result->torque_error_percent = 100.0 * (torque_Nm / asked_Nm - 1.0);
    result->torque_ripple_percent =
        100.0 * sqrt(fmax(r->torque_square_sum / cycles - torque_Nm * torque_Nm, 0.0)) / asked_Nm;
    const double window_s = (double)(r->cycles - r->steady_from) * r->loop.base.T_s;
    result->switching_Hz = 0.5 * (double)r->edges / 3.0 / window_s;
    result->outcome = wander > LOOP_WANDER_LIMIT   ? LOOP_UNSTABLE
                      : offset > LOOP_OFFSET_LIMIT ? LOOP_MISSES
                                                   : LOOP_HOLDS;
}

static void nothing_measured(loop_result *result)
{
    const loop_result none = {.outcome = LOOP_TRIPS,
                              .rms_percent = NAN,
                              .offset_percent = NAN,
                              .wander_percent = NAN,
                              .i_d_offset_percent = NAN,
                              .i_q_offset_percent = NAN,
                              .overshoot_percent = NAN,
                              .settling_cycles = -1,
                              .settling_beside_cycles = -1,
                              .thd_percent = NAN,
                              .switching_Hz = NAN,
                              .torque_error_percent = NAN,
                              .torque_ripple_percent = NAN};
    *result = none;
    for (int n = 0; n < LOOP_TRACE_CYCLES; n++) {
        result->trace_q[n] = NAN;
        result->trace_start[n] = NAN;
    }
}

bool closed_loop_run(const loop_case *c, const drive_firmware *firmware, loop_result *result, error *e)
{
    loop_run r = {.c = c, .steady_from = LOOP_SETTLE_CYCLES + LOOP_TRANSIENT_CYCLES};
    const double turns = fabs(c->omega_e_rad_s) * per_unit_of(&c->truth).T_s / VEC_TWO_PI;
    r.cycles = r.steady_from + lround(c->periods / turns);
    plant_config drive = c->drive != NULL ? *c->drive : plant_config_from_motor(&c->truth);
    if (c->drive == NULL) {
        drive.sensors.current_noise_A = c->noise_A;
        drive.seed = c->seed;
    }
    if (!plant_config_check(&drive, e)) {
        return false;
    }
    const size_t kept = (size_t)(r.cycles - LOOP_SETTLE_CYCLES);
    r.error_d = calloc(kept, sizeof *r.error_d);
    r.error_q = calloc(kept, sizeof *r.error_q);
    if (r.error_d == NULL || r.error_q == NULL) {
        free(r.error_d);
        free(r.error_q);
        return error_failure(e, 0, "loops: out of memory");
    }
    drive_loop_begin(&r.loop, &c->truth, &drive, firmware);
    r.loop.halves = c->halves;
    r.loop.watch = (drive_watch){&r, POINTS, take_point};
    plant_set_speed(&r.loop.drive, c->omega_e_rad_s, 0.0);
    nothing_measured(result);
    bool ok = true;
    for (; r.cycle < r.cycles && ok && !r.tripped; r.cycle++) {
        ok = one_cycle(&r, result, e);
    }
    if (ok && !r.tripped) {
        measure_step(&r, result);
        measure_steady(&r, result);
    }
    free(r.error_d);
    free(r.error_q);
    return ok;
}
