/*
 * Digests of the drive without an angle sensor, and of the modulator by pulse pattern (golden_sensorless.h).
 *
 * The drive runs in closed loop with a machine in the library's own integers, so that the observer locks: a
 * non-salient one, whose flux linkage is the sum of the voltages less the resistive drop. A switch of the source, a
 * lost lock and a trip occur on the way.
 */
#include "golden_sensorless.h"

#include "golden_types.h"

#include "iqfoc/edges.h"
#include "iqfoc/observer_inductance.h"
#include "iqfoc/observer_resistance.h"
#include "iqfoc/params.h"
#include "iqfoc/pattern_control.h"
#include "iqfoc/pulse_mode.h"
#include "iqfoc/sensorless.h"
#include "iqfoc/watch_angle.h"

/* ---- The drive without an angle sensor ---- */

#define AGAIN 1250 /* periods until the drive begins again, in another way */
#define TICKS 1000

#define R_OHM  0.9
#define L_H    6.48e-4
#define PSI_WB 0.0108
#define T_S    1e-4
#define I_B_A  10.0
#define U_DC_V 300.0

static const iqfoc_cycle_config_t cycle_config = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .gains = IQFOC_GAINS(2000.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24_ONE,
    .current_limit = IQ24(4.0),
    .period_ticks = TICKS,
    .tolerance_ticks = TICKS / 10,
    .stale_ticks = TICKS / 4,
    .deadline_ticks = TICKS / 2,
    .trips = IQFOC_STATUS_OVERCURRENT,
};
/* The observer's L_q is 15 % too large at first. */
static const iqfoc_observer_config_t observer_config =
    IQFOC_OBSERVER_CONFIG(R_OHM, L_H, 1.15 * L_H, PSI_WB, T_S, I_B_A, U_DC_V, 1600.0, IQ24(0.005));
static const iqfoc_observer_inductance_config_t inductance_config = {IQ24(0.05), IQ24(0.08), IQ24(0.003),
                                                                     IQ24(0.1), IQ24(0.4)};
static const iqfoc_observer_resistance_config_t resistance_config = {IQ24(0.05), IQ24(0.5), IQ24(0.05)};
/* Limits below the errors of the observer, so that it gets a name on the way. */
static const iqfoc_watch_angle_config_t angle_config = {2,           IQ24(0.01),   IQ24(0.002),
                                                        IQ24(0.001), IQ24(0.0005), IQ24(0.001)};
static const iqfoc_start_config_t start_config = {IQ24(0.6), 60, 90, IQ24(0.05), 120};
static const iqfoc_extension_t losses = {.i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE},
                                         .k_u = IQ24_ONE,
                                         .v_dead = IQ24(0.005),
                                         .knee_inverse = IQ24(7.0)};
/* Inverse of the machine's inductance, and its resistive drop. */
static const iq24_t inductance_inverse = IQFOC_FLUX_K(L_H, T_S, I_B_A, U_DC_V);
static const iq24_t resistance = IQFOC_FLUX_R(R_OHM, I_B_A, U_DC_V);
static const iq24_t magnet = IQFOC_FLUX_PSI(PSI_WB, T_S, U_DC_V);

static iqfoc_cycle_t cycle;
static iqfoc_sensorless_t drive;
static iqfoc_observer_inductance_t inductance;
static iqfoc_observer_resistance_t adapted;
static iqfoc_watch_angle_t angle_watch;
static iqfoc_ab_t flux;
static iq24_t theta;
static iq24_t speed;
static uint32_t ticks;

static iqfoc_ab_t flux_of_magnet(void)
{
    const iqfoc_dq_t along = {magnet, 0};
    return iqfoc_park_inverse(along, iq24_sincos(theta));
}

static iqfoc_ab_t current(void)
{
    const iqfoc_ab_t of_magnet = flux_of_magnet();
    const iqfoc_ab_t i = {iq24_mul_round(flux.alpha - of_magnet.alpha, inductance_inverse),
                          iq24_mul_round(flux.beta - of_magnet.beta, inductance_inverse)};
    return i;
}

/* Half a cycle with this voltage; without gates the current is 0 at its end. */
static void half(iqfoc_ab_t u, bool gates)
{
    const iqfoc_ab_t i = current();
    theta = (theta + speed / 2) & (IQ24_ONE - 1);
    ticks = (uint32_t)(((uint64_t)ticks + TICKS / 2) & UINT32_MAX);
    if (!gates) {
        flux = flux_of_magnet();
        return;
    }
    flux.alpha += (u.alpha - iq24_mul_round(resistance, i.alpha)) / 2;
    flux.beta += (u.beta - iq24_mul_round(resistance, i.beta)) / 2;
}

static void begin(golden_inputs_t *inputs)
{
    const uint32_t way = inputs->number / AGAIN % 4;
    theta = golden_within(inputs, IQ24_ONE) & (IQ24_ONE - 1);
    speed = golden_within(inputs, IQ24(0.15));
    flux = flux_of_magnet();
    ticks = UINT32_MAX - 100 * TICKS; /* the timer wraps on the way */
    (void)iqfoc_cycle_init(&cycle, &cycle_config);
    (void)iqfoc_sensorless_init(&drive, &observer_config, &start_config, way % 2 == 0 ? &losses : NULL);
    (void)iqfoc_observer_inductance_init(&inductance, &inductance_config, &observer_config);
    drive.observer.config = &inductance.adapted;
    (void)iqfoc_watch_angle_init(&angle_watch, &angle_config);
    (void)iqfoc_observer_resistance_init(&adapted, &resistance_config, &inductance.adapted);
    cycle.enabled = true;
    if (way == 0) {
        iqfoc_sensorless_start(&drive);
        theta = 0;
    } else if (way == 1) {
        iqfoc_sensorless_catch(&drive, speed + speed / 4);
    } else {
        iqfoc_sensorless_use(&drive, way == 2);
    }
}

static iqfoc_sample_t sample_of(golden_inputs_t *inputs, iq24_t at)
{
    const iqfoc_ab_t i = current();
    const iqfoc_ab_t noise = golden_ab(inputs, IQ24(0.005));
    const iqfoc_ab_t seen = {i.alpha + noise.alpha, i.beta + noise.beta};
    const iqfoc_sample_t sample = {.i = iqfoc_clarke_inverse(seen),
                                   .theta = theta,
                                   .speed = speed,
                                   .u_dc = IQ24_ONE,
                                   .instant = at,
                                   .time = ticks};
    return sample;
}

static void add_drive(uint64_t *digest, const iqfoc_sample_t *valley, const iqfoc_sample_t *peak)
{
    digest_add(digest, valley->theta);
    digest_add(digest, valley->speed);
    digest_add(digest, peak->theta);
    digest_add(digest, (int32_t)drive.source);
    digest_add(digest, (int32_t)drive.on);
    digest_add(digest, drive.difference);
    digest_ab(digest, drive.observer.psi);
    digest_add(digest, drive.observer.locked ? 1 : 0);
    digest_add(digest, inductance.level);
    digest_add(digest, inductance.slope);
    digest_add(digest, inductance.adapted.machine.l_q);
    digest_add(digest, adapted.r);
    digest_add(digest, adapted.psi);
    digest_ab(digest, adapted.s);
    digest_add(digest, angle_watch.path);
    digest_add(digest, angle_watch.count);
    for (int32_t k = 0; k < 3; k++) {
        digest_add(digest, (int32_t)(angle_watch.sum[k] & INT64_C(0x7fffffff)));
        digest_add(digest, angle_watch.x[k]);
        digest_add(digest, angle_watch.up[k]);
        digest_add(digest, angle_watch.down[k]);
    }
    digest_add(digest, (int32_t)angle_watch.fault);
    digest_add(digest, angle_watch.amount);
    digest_dq(digest, cycle.i_ref);
    digest_ab(digest, cycle.u_ab);
    digest_add(digest, (int32_t)cycle.status);
}

/* References, speeds and faults that a drive meets; the rotor follows the open-loop start. */
static void disturb(golden_inputs_t *inputs)
{
    const uint32_t draw = (uint32_t)golden_positive(inputs, 4095);
    if (drive.source == IQFOC_ANGLE_START) {
        speed = drive.start.speed;
    }
    if (draw % 64 == 7) {
        cycle.i_ref = golden_dq(inputs, IQ24(0.8));
    } else if (draw == 1000 || draw == 2000) {
        iqfoc_sensorless_use(&drive, draw == 1000);
    } else if (draw == 2500) {
        (void)iqfoc_cycle_offer(&cycle, &cycle_config);
    } else if (draw == 3000) {
        cycle.enabled = false;
    } else if (draw % 512 == 9) {
        cycle.enabled = true;
        iqfoc_cycle_clear(&cycle);
    }
}

void golden_sensorless(golden_inputs_t *inputs, uint64_t *digest)
{
    if (inputs->number % AGAIN == 0) {
        begin(inputs);
    }
    inputs->number++;
    disturb(inputs);
    iqfoc_sample_t valley = sample_of(inputs, 0);
    const iqfoc_ab_t i = iqfoc_clarke3(valley.i);
    iqfoc_sensorless_valley(&drive, &cycle, &valley);
    digest_add(digest, iqfoc_watch_angle_step(&angle_watch, &drive) ? 1 : 0);
    iqfoc_observer_inductance_step(&inductance, &drive.observer, i);
    iqfoc_observer_resistance_step(&adapted, &drive.observer, i);
    (void)iqfoc_cycle_valley(&cycle, &valley, ticks);
    const bool gates = cycle.enabled && !cycle.tripped;
    half(cycle.u_now, gates);
    iqfoc_sample_t peak = sample_of(inputs, IQ24(0.5));
    iqfoc_sensorless_peak(&drive, &peak);
    const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &peak, IQ24(1.5), ticks);
    half(cycle.u_now, gates && command.gates);
    add_drive(digest, &valley, &peak);
}

/* ---- The modulator by pulse pattern ---- */

#define ROWS        12
#define TABLE_AGAIN 500 /* cycles until a new table is drawn */

static iqfoc_pattern_row_t rows[ROWS];
static iqfoc_pattern_t table;
static iqfoc_pattern_modulator_t modulator;
static iq24_t voltage_angle;
static iq24_t voltage_turns;
static iq24_t voltage;

static void draw_row(golden_inputs_t *inputs, iqfoc_pattern_row_t *row, const iqfoc_pattern_row_t *before)
{
    iq24_t angle = 0;
    for (int32_t k = 0; k < IQFOC_PATTERN_ANGLES_MAX; k++) {
        angle += k < table.angles ? golden_positive(inputs, (IQ24(0.25) - angle) / 2) : -angle;
        row->angle[k] = angle;
    }
    row->start = golden_within(inputs, 1) >= 0 ? 1 : -1;
    row->joined = 0;
    if (before != NULL) {
        rows[before - rows].joined = row->start == before->start ? 1 : 0;
    }
}

static void draw_table(golden_inputs_t *inputs)
{
    table.row = rows;
    table.rows = ROWS;
    table.angles = 1 + golden_positive(inputs, IQFOC_PATTERN_ANGLES_MAX - 1);
    table.index_low = golden_positive(inputs, IQ24(0.9));
    table.rows_per_index = IQ24_ONE + golden_positive(inputs, IQ24(99.0));
    for (int32_t n = 0; n < ROWS; n++) {
        draw_row(inputs, &rows[n], n > 0 ? &rows[n - 1] : NULL);
    }
    const iq24_t least = golden_positive(inputs, golden_within(inputs, 1) > 0 ? IQ24(1.5) : IQ24(0.1));
    (void)iqfoc_pattern_init(&modulator, &table, least);
    voltage_angle = golden_within(inputs, IQ24_MAX);
    voltage_turns = golden_within(inputs, IQ24(0.14));
    voltage = golden_positive(inputs, IQ24(0.7));
}

void golden_pattern(golden_inputs_t *inputs, uint64_t *digest)
{
    if (inputs->number % TABLE_AGAIN == 0) {
        draw_table(inputs);
    }
    inputs->number++;
    const iq24_t u = iq24_abs_sat(iq24_add_wrap(voltage, golden_within(inputs, IQ24(0.02))));
    const iq24_t index = iqfoc_pattern_index(u, IQ24_ONE + golden_within(inputs, IQ24(0.1)));
    iqfoc_pattern_edges_t edges[3];
    iqfoc_pattern_step(&modulator, voltage_angle, voltage_turns, index, edges);
    for (int32_t leg = 0; leg < 3; leg++) {
        digest_add(digest, edges[leg].level);
        digest_add(digest, edges[leg].edges);
        digest_add(digest, edges[leg].high);
        for (int32_t k = 0; k < edges[leg].edges; k++) {
            digest_add(digest, edges[leg].instant[k]);
        }
        digest_add(digest, modulator.leg[leg].since);
    }
    voltage_angle = iq24_add_wrap(voltage_angle, voltage_turns);
    if (golden_positive(inputs, 255) == 77) {
        voltage_angle = golden_within(inputs, IQ24_MAX);
        voltage = golden_positive(inputs, IQ24(0.7));
    }
}

/* ---- Edges in ticks ---- */

static void add_ticks(uint64_t *digest, const iqfoc_edges_t *edges)
{
    for (int32_t x = 0; x < 3; x++) {
        digest_add(digest, edges->leg[x].level);
        digest_add(digest, edges->leg[x].edges);
        for (int32_t k = 0; k < edges->leg[x].edges; k++) {
            digest_add(digest, (int32_t)edges->leg[x].instant[k]);
        }
    }
}

void golden_edges(golden_inputs_t *inputs, uint64_t *digest)
{
    const uint32_t period = 2 + (uint32_t)golden_positive(inputs, (int32_t)IQFOC_EDGES_TICKS_MAX - 2);
    const iqfoc_abc_t high = {golden_within(inputs, IQ24(1.1)), golden_positive(inputs, IQ24_ONE),
                              golden_positive(inputs, IQ24_ONE)};
    iqfoc_pattern_edges_t asked[3];
    iqfoc_edges_t edges;
    for (int32_t x = 0; x < 3; x++) {
        asked[x].level = golden_within(inputs, 1) >= 0 ? 1 : -1;
        asked[x].edges = golden_positive(inputs, IQFOC_PATTERN_EDGES_MAX);
        iq24_t at = 0;
        for (int32_t k = 0; k < asked[x].edges; k++) {
            at += golden_positive(inputs, (IQ24_ONE - 1 - at) / 4);
            asked[x].instant[k] = at;
        }
    }
    iqfoc_edges_of_pattern(asked, period, &edges);
    add_ticks(digest, &edges);
    iqfoc_edges_of_pattern(asked, 2 + period % 40, &edges); /* many edges share a tick */
    add_ticks(digest, &edges);
    iqfoc_edges_of_duties(high, period, &edges);
    add_ticks(digest, &edges);
}

/* ---- The control of a pulse pattern ---- */

/* Five pulses: the angles of least distortion at index 0.7. */
static const iqfoc_pattern_row_t other_row = {1, 0, {IQ24(0.2015), IQ24(0.226)}};
static const iqfoc_pattern_t other_table = {&other_row, 1, 2, IQ24(0.3), IQ24_ONE};

static iqfoc_pattern_control_t control;
static iqfoc_dq_t wanted;
static iq24_t rotor_angle;
static iq24_t rotor_turns;

static void begin_control(golden_inputs_t *inputs, uint64_t *digest)
{
    const iqfoc_pattern_control_config_t config = {
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), golden_positive(inputs, IQ24(0.2)),
        golden_positive(inputs, IQ24(0.01))};
    draw_table(inputs);
    digest_add(digest, (int32_t)iqfoc_pattern_control_init(&control, &config, &table, IQ24(0.05)));
    wanted = golden_dq(inputs, IQ24(1.0));
    rotor_angle = golden_within(inputs, IQ24_MAX);
    rotor_turns = golden_within(inputs, IQ24(0.1));
}

void golden_pattern_control(golden_inputs_t *inputs, uint64_t *digest)
{
    if (inputs->number % TABLE_AGAIN == 0) {
        begin_control(inputs, digest);
    } else if (inputs->number % TABLE_AGAIN == TABLE_AGAIN / 2) {
        iqfoc_pattern_control_change(&control, &other_table);
    }
    inputs->number++;
    const iqfoc_ab_t noise = golden_ab(inputs, IQ24(0.02));
    const iqfoc_ab_t i = {iq24_clamp(control.i_next.alpha + noise.alpha, IQ24(-8.0), IQ24(8.0)),
                          iq24_clamp(control.i_next.beta + noise.beta, IQ24(-8.0), IQ24(8.0))};
    iqfoc_pattern_edges_t edges[3];
    iqfoc_pattern_control_aim(&control, wanted, rotor_turns);
    iqfoc_pattern_control_step(&control, i, rotor_angle, IQ24_ONE + golden_within(inputs, IQ24(0.1)), edges);
    for (int32_t leg = 0; leg < 3; leg++) {
        digest_add(digest, edges[leg].edges);
        digest_add(digest, edges[leg].high);
        for (int32_t k = 0; k < edges[leg].edges; k++) {
            digest_add(digest, edges[leg].instant[k]);
        }
    }
    digest_ab(digest, control.i_next);
    digest_ab(digest, control.error);
    digest_dq(digest, control.v);
    rotor_angle = iq24_add_wrap(rotor_angle, rotor_turns);
}

/* ---- Pulse modes ---- */

static const iqfoc_pulse_level_t pulse_levels[3] = {
    {NULL, 0, 0, 0, 0},
    {&other_table, IQ24(0.025), IQ24(0.02), 0, 0},
    {&iqfoc_pattern_six_step, IQ24(0.04), IQ24(0.035), IQ24(0.8), IQ24(0.7)}};
static const iqfoc_pulse_config_t pulse_config = {pulse_levels, 3, 17000};
static iqfoc_pulse_mode_t pulse_mode;
static iqfoc_cycle_t pulse_cycle;
static iqfoc_cycle_config_t pulse_set;
static iqfoc_pattern_control_t pulse_control;
static iq24_t pulse_turns;
static bool pulse_resumes;

static void begin_pulse_mode(golden_inputs_t *inputs, uint64_t *digest)
{
    const iqfoc_pattern_control_config_t config = {
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.02)};
    const iqfoc_cycle_config_t set = {
        .predictor = IQFOC_PREDICTOR(0.75, 5.2e-3, 0.134, 2e-4, 14.849, 565.0),
        .gains = IQFOC_GAINS(1000.0, 0.75, 5.2e-3, 5.2e-3, 0.134, 2e-4, 14.849, 565.0),
        .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
        .span_max = IQ24_ONE,
        .current_limit = IQ24(4.0),
        .period_ticks = 34000};
    pulse_set = set;
    digest_add(digest,
               (int32_t)iqfoc_pattern_control_init(&pulse_control, &config, &other_table, IQ24(0.05)));
    digest_add(digest, (int32_t)iqfoc_pulse_mode_init(&pulse_mode, &pulse_config));
    (void)iqfoc_cycle_init(&pulse_cycle, &pulse_set);
    pulse_cycle.enabled = true;
    pulse_turns = IQ24(0.02) + golden_within(inputs, IQ24(0.02));
    pulse_resumes = false;
}

void golden_pulse_mode(golden_inputs_t *inputs, uint64_t *digest)
{
    if (inputs->number % TABLE_AGAIN == 0) {
        begin_pulse_mode(inputs, digest);
    }
    inputs->number++;
    pulse_turns = iq24_clamp(pulse_turns + golden_within(inputs, IQ24(0.002)), IQ24(-0.05), IQ24(0.05));
    const iqfoc_ab_t i = golden_ab(inputs, IQ24_ONE);
    const iq24_t angle = golden_within(inputs, IQ24_MAX);
    const iq24_t u_dc = IQ24_ONE + golden_within(inputs, IQ24(0.1));
    iqfoc_pattern_edges_t edges[3] = {{0}};
    iqfoc_duties_t duties = {{0, 0, 0}, 0};
    pulse_cycle.i_ref = golden_dq(inputs, IQ24(0.7));
    iqfoc_pulse_mode_step(&pulse_mode, &pulse_control, pulse_turns, golden_positive(inputs, IQ24_ONE));
    if (pulse_mode.level > 0) {
        iqfoc_pattern_control_aim(&pulse_control, pulse_cycle.i_ref, pulse_turns);
        pulse_resumes = iqfoc_pulse_mode_to_carrier(&pulse_mode, &pulse_control, &pulse_cycle, &pulse_set, i,
                                                    angle, u_dc, edges, &duties);
    } else {
        const iqfoc_sample_t sample = {
            .i = iqfoc_clarke_inverse(i), .theta = angle, .speed = 2 * pulse_turns, .u_dc = u_dc};
        const iqfoc_abc_t high = {golden_positive(inputs, IQ24_ONE), golden_positive(inputs, IQ24_ONE),
                                  golden_positive(inputs, IQ24_ONE)};
        (void)iqfoc_cycle_valley(&pulse_cycle, &sample, 0);
        if (pulse_resumes) {
            iqfoc_pulse_mode_resume(&pulse_control, &pulse_cycle);
            pulse_resumes = false;
        }
        (void)iqfoc_pulse_mode_to_pattern(&pulse_mode, &pulse_control, &pulse_cycle, high, u_dc, edges);
    }
    for (int32_t leg = 0; leg < 3; leg++) {
        digest_add(digest, edges[leg].edges);
        digest_add(digest, edges[leg].high);
    }
    digest_add(digest, pulse_mode.level);
    digest_add(digest, pulse_mode.wanted);
    digest_add(digest, pulse_mode.waited);
    digest_add(digest, duties.high.a);
    digest_add(digest, duties.high.b);
    digest_add(digest, duties.high.c);
    digest_dq(digest, pulse_cycle.u_dq);
    digest_add(digest, iq24_acc_trunc(pulse_cycle.control.integral_d));
    digest_add(digest, iq24_acc_trunc(pulse_cycle.control.integral_q));
    digest_ab(digest, pulse_control.error);
}
