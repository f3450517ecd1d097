/*
 * Counts the instructions of each function, from entry to return, over the inputs of bench/inputs.h.
 *
 * One place calls each function through a pointer, and then a bare return. The difference plus the one instruction of the return is the
 * function's count. The output has one line for each function: name, smallest count, mean times 4096, largest count.
 */
#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/finite_set.h"
#include "iqfoc/induction.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/mean_current.h"
#include "iqfoc/mean_modulated.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"

#include "console.h"
#include "count.h"
#include "drives.h"
#include "handler.h"
#include "inputs.h"
#include "kernels.h"
#include "services.h"

/* The state that the functions with memory work on; twice, as the bare call must not disturb it. */
static bench_drive_t drive;
static iqfoc_cycle_t cycle;
static iqfoc_duties_t duties;
static iqfoc_exact_law_t exact_law;
static iqfoc_exact_t exact;
static iqfoc_salient_t salient;
static iqfoc_salient_t salient_mean;
static iqfoc_mean_modulated_t modulated;
static iqfoc_ripple_t ripple;
static iqfoc_deadbeat_t deadbeat;
static iqfoc_deadbeat_drift_t drift;
static iqfoc_finite_set_t near_set; /* horizon 1 */
static iqfoc_finite_set_t far_set;  /* horizon 3 */
static iqfoc_induction_t induction;

/* An inlined function: what one more of it adds to a straight line of code. */
#define COUNT_INLINED(name, line, empty)                                                                     \
    static uint32_t count_##name(const bench_input_t *in)                                                    \
    {                                                                                                        \
        const volatile iq24_t from[4] = {in->i.alpha, in->i.beta, in->sc.sin, in->sc.cos};                   \
        volatile iq24_t to[2];                                                                               \
        const uint32_t start = counter_read();                                                               \
        line(from, to);                                                                                      \
        const uint32_t middle = counter_read();                                                              \
        empty(from, to);                                                                                     \
        const uint32_t end = counter_read();                                                                 \
        return (counter_units(middle - start) - counter_units(end - middle) + BENCH_LINE / 2) / BENCH_LINE;  \
    }

COUNT(sincos, iq24_sincos_t, iq24_sincos, (iq24_t), (in->sample.theta))
COUNT(sqrt, iq24_t, iq24_sqrt, (iq24_t), (in->positive))
COUNT(atan2, iq24_t, iq24_atan2, (iq24_t, iq24_t), (in->any_a, in->any_b))
COUNT(div, iq24_t, iq24_div, (iq24_t, iq24_t), (in->any_a, in->divisor))
COUNT_INLINED(park, bench_park_line, bench_four_to_two_line)
COUNT_INLINED(park_inverse, bench_park_inverse_line, bench_four_to_two_line)
COUNT_INLINED(clarke, bench_clarke_line, bench_two_to_two_line)
COUNT(rotor, iqfoc_rotor_t, iqfoc_rotor_from_speed, (iq24_t), (in->sample.speed))
COUNT(mean_correction, iqfoc_dq_t, iqfoc_mean_current_correct,
      (iqfoc_ab_t, iqfoc_ab_t, const iqfoc_rotor_t *, iq24_sincos_t), (in->i, in->delta, &in->rotor, in->sc))
COUNT(mean_quasi_discrete, iqfoc_ab_t, iqfoc_mean_current_quasi_discrete,
      (const iqfoc_predictor_t *, iqfoc_ab_t, iqfoc_ab_t, const iqfoc_rotor_t *, iq24_sincos_t),
      (&bench_config.predictor, in->i, in->u, &in->rotor, in->sc))
COUNT(prediction_euler, iqfoc_ab_t, iqfoc_predictor_euler,
      (const iqfoc_predictor_t *, iqfoc_ab_t, iqfoc_ab_t, const iqfoc_rotor_t *, iq24_sincos_t),
      (&bench_config.predictor, in->i, in->u, &in->rotor, in->sc))
COUNT(prediction_quasi_discrete, iqfoc_ab_t, iqfoc_predictor_quasi_discrete,
      (const iqfoc_predictor_t *, iqfoc_ab_t, iqfoc_ab_t, const iqfoc_rotor_t *, iq24_sincos_t),
      (&bench_config.predictor, in->i, in->u, &in->rotor, in->sc))
COUNT(prediction_exact, iqfoc_ab_t, iqfoc_exact_step,
      (const iqfoc_exact_t *, iqfoc_ab_t, iqfoc_ab_t, iq24_sincos_t), (&exact, in->i, in->u, in->sc))
COUNT(exact_at_speed, iqfoc_exact_t, iqfoc_exact_at_speed, (const iqfoc_exact_law_t *, iq24_t),
      (&exact_law, in->sample.speed))
COUNT(exact_set_up, iqfoc_exact_law_t, iqfoc_exact_prediction, (const iqfoc_exact_winding_t *, iq24_t),
      (&bench_winding, IQ24_ONE))
COUNT(prediction_salient, iqfoc_dq_t, iqfoc_salient_step, (const iqfoc_salient_t *, iqfoc_dq_t, iqfoc_dq_t),
      (&salient, in->i_ref, (iqfoc_dq_t){in->u.alpha, in->u.beta}))
COUNT(salient_at_speed, void, iqfoc_salient_at_speed,
      (const iqfoc_salient_machine_t *, iq24_t, iq24_t, iqfoc_salient_t *, iqfoc_salient_t *),
      (&bench_salient, in->sample.speed, IQ24_ONE, &salient, &salient_mean))
COUNT(mean_modulated, iqfoc_dq_t, iqfoc_mean_modulated,
      (const iqfoc_mean_modulated_t *, iqfoc_ab_t, iqfoc_ab_t, iqfoc_abc_t, iq24_t, iq24_sincos_t),
      (&modulated, in->i, in->delta, duties.high, in->sample.u_dc, in->sc))
COUNT(modulated_at_speed, iqfoc_mean_modulated_t, iqfoc_mean_modulated_at_speed,
      (const iqfoc_predictor_t *, const iqfoc_rotor_t *), (&bench_config.predictor, &in->rotor))
COUNT(ripple, iqfoc_dq_t, iqfoc_ripple_seen, (const iqfoc_ripple_t *, iqfoc_abc_t, iq24_t, iq24_sincos_t),
      (&ripple, duties.high, in->sample.u_dc, in->sc))
COUNT(prediction_induction, iqfoc_induction_state_t, iqfoc_induction_step,
      (const iqfoc_induction_t *, iqfoc_induction_state_t, iqfoc_ab_t),
      (&induction, (iqfoc_induction_state_t){in->i, in->delta}, in->u))
COUNT(induction_at_speed, iqfoc_induction_t, iqfoc_induction_at_speed,
      (const iqfoc_induction_machine_t *, iq24_t, iq24_t), (&bench_induction, in->sample.speed, IQ24_ONE))
COUNT(deadbeat, iqfoc_ab_t, iqfoc_deadbeat_step,
      (const iqfoc_deadbeat_t *, iqfoc_ab_t, iqfoc_ab_t, iqfoc_dq_t, iq24_t, iq24_t),
      (&deadbeat, in->i, in->u, in->i_ref, in->sample.theta, in->sample.speed))
COUNT(deadbeat_drift, iqfoc_ab_t, iqfoc_deadbeat_drift_step,
      (iqfoc_deadbeat_drift_t *, const iqfoc_deadbeat_t *, iq24_t, iqfoc_ab_t, iqfoc_ab_t, iqfoc_dq_t, iq24_t,
       iq24_t),
      (&drift, &deadbeat, IQ24(0.1), in->i, in->u, in->i_ref, in->sample.theta, in->sample.speed))
COUNT(finite_set_1, int32_t, iqfoc_finite_set_choose,
      (const iqfoc_finite_set_t *, iqfoc_ab_t, int32_t, iqfoc_dq_t, iq24_t, iq24_t, iq24_t, uint32_t *),
      (&near_set, in->i, 1, in->i_ref, in->sample.theta, in->sample.speed, in->sample.u_dc, 0))
COUNT(finite_set_3, int32_t, iqfoc_finite_set_choose,
      (const iqfoc_finite_set_t *, iqfoc_ab_t, int32_t, iqfoc_dq_t, iq24_t, iq24_t, iq24_t, uint32_t *),
      (&far_set, in->i, 1, in->i_ref, in->sample.theta, in->sample.speed, in->sample.u_dc, 0))
COUNT(control_step, iqfoc_dq_t, iqfoc_current_control_step,
      (iqfoc_current_control_t *, const iqfoc_current_control_gains_t *, iqfoc_dq_t, iqfoc_dq_t),
      (&drive.control, &bench_config.gains, in->i_ref, (iqfoc_dq_t){in->i.alpha, in->i.beta}))
COUNT(modulation, iqfoc_duties_t, iqfoc_modulate, (iqfoc_ab_t, iq24_t, iq24_t),
      (in->u, IQ24(1.0), bench_config.span_max))
COUNT(current_control, void, bench_current_control, (bench_drive_t *, iq24_t, iq24_t, iq24_t, iq24_t),
      (&drive, in->sample.i.a, in->sample.i.b, in->sample.theta, duties.scale))
COUNT(cycle, void, bench_cycle, (bench_drive_t *, iq24_t, iq24_t, iq24_t, iqfoc_duties_t *),
      (&drive, in->sample.i.a, in->sample.i.b, in->sample.theta, &duties))
COUNT(isr_cycle_looked_up_valley, bool, iqfoc_cycle_valley,
      (iqfoc_cycle_t *, const iqfoc_sample_t *, uint32_t), (&cycle, &in->sample, in->sample.time))
COUNT(isr_cycle_looked_up_peak, iqfoc_command_t, iqfoc_cycle_peak,
      (iqfoc_cycle_t *, const iqfoc_sample_t *, iq24_t, uint32_t),
      (&cycle, &in->sample, IQ24(1.5), in->sample.time))

#define COUNT_DRIVE(name)                                                                                    \
    COUNT(name##_valley, bool, bench_##name##_valley, (iqfoc_cycle_t *, const iqfoc_sample_t *, uint32_t),   \
          (&cycle, &in->sample, in->sample.time))                                                            \
    COUNT(name##_peak, iqfoc_command_t, bench_##name##_peak,                                                 \
          (iqfoc_cycle_t *, const iqfoc_sample_t *, iq24_t, uint32_t),                                       \
          (&cycle, &in->sample, IQ24(1.5), in->sample.time))                                                 \
    static uint32_t count_##name(const bench_input_t *in)                                                    \
    {                                                                                                        \
        return count_period(in, count_##name##_valley, count_##name##_peak);                                 \
    }

/* Integrators that hold a voltage. */
static iqfoc_current_control_t holding(iqfoc_dq_t u)
{
    const iqfoc_current_control_t control = {iq24_acc_mul(u.d, IQ24_ONE), iq24_acc_mul(u.q, IQ24_ONE)};
    return control;
}

/* What the last period's peak took of it. */
static uint32_t last_peak;

/* One carrier period as the interrupts run it: valley and peak. */
static uint32_t count_period(const bench_input_t *in, uint32_t (*count_valley)(const bench_input_t *),
                             uint32_t (*count_peak)(const bench_input_t *))
{
    static uint32_t period;
    bench_input_t at_peak = *in;
    bench_input_t at_valley = *in;
    at_valley.sample.time = period;
    at_peak.sample.time = period + bench_config.period_ticks / 2;
    at_peak.sample.instant = IQ24(0.5);
    period += bench_config.period_ticks;
    cycle.i_ref = in->i_ref;
    cycle.control = holding(in->u_winding);
    const uint32_t valley = count_valley(&at_valley);
    last_peak = count_peak(&at_peak);
    return valley + last_peak;
}

BENCH_DRIVES(COUNT_DRIVE)

static uint32_t count_isr_cycle_looked_up(const bench_input_t *in)
{
    return count_period(in, count_isr_cycle_looked_up_valley, count_isr_cycle_looked_up_peak);
}

/* From the last sample, at the peak, to the duties. */
static uint32_t count_sample_to_duty(const bench_input_t *in)
{
    (void)count_isr_cycle(in);
    return last_peak;
}

COUNT(interrupt, void, bench_handler, (void), ())

static uint32_t count_handler_stm32g4(const bench_input_t *in)
{
    bench_handler_set(in, false);
    const uint32_t valley = count_interrupt(in);
    bench_handler_set(in, true);
    return valley + count_interrupt(in);
}

/* The drive settled at the input's operating point. */
static void settle(const bench_input_t *in)
{
    drive.control = holding(in->u_steady);
    drive.i_ref = in->i_ref;
    drive.rotor = in->rotor;
    drive.u_dc_inverse = in->u_dc_inverse;
    drive.u_now = iqfoc_park_inverse(in->u_steady, in->sc);
    duties = iqfoc_modulate(drive.u_now, in->u_dc_inverse, bench_config.span_max);
}

static uint32_t count_current_control_of_drive(const bench_input_t *in)
{
    settle(in);
    return count_current_control(in);
}

static uint32_t count_cycle_of_drive(const bench_input_t *in)
{
    settle(in);
    return count_cycle(in);
}

/* A cycle from its start: what one configuration has left is not another's. */
static void renew(void)
{
    (void)iqfoc_cycle_init(&cycle, bench_drives_config());
    cycle.enabled = true;
}

void bench_report(const char *name, uint32_t (*count)(const bench_input_t *))
{
    static bench_input_t input;
    uint32_t least = UINT32_MAX;
    uint32_t greatest = 0;
    uint32_t sum = 0;
    bench_input_restart();
    for (uint32_t k = 0; k < BENCH_INPUT_COUNT; k++) {
        bench_input_draw(&input);
        const uint32_t units = count(&input);
        least = units < least ? units : least;
        greatest = units > greatest ? units : greatest;
        sum += units;
    }
    console_text(name);
    console_text(" ");
    console_unsigned(least);
    console_text(" ");
    console_unsigned(sum);
    console_text(" ");
    console_unsigned(greatest);
    console_text("\n");
}

int main(void)
{
    uint32_t status = 0;
    counter_start();
    drive.config = &bench_config;
    drive.u_dc_inverse = IQ24_ONE;
    exact_law = iqfoc_exact_prediction(&bench_winding, IQ24_ONE);
    exact = iqfoc_exact_at_speed(&exact_law, IQ24(0.08));
    iqfoc_salient_at_speed(&bench_salient, IQ24(0.08), IQ24_ONE, &salient, &salient_mean);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(IQ24(0.08));
    modulated = iqfoc_mean_modulated_at_speed(&bench_config.predictor, &rotor);
    induction = iqfoc_induction_at_speed(&bench_induction, IQ24(0.08), IQ24_ONE);
    ripple = iqfoc_ripple_at_speed(&bench_salient, &rotor);
    deadbeat.model = exact;
    deadbeat.k_u_inverse = iqfoc_deadbeat_inverse(exact_law.k_u_q26);
    deadbeat.reference = iqfoc_valley_reference_at(&rotor, bench_config.predictor.k_psi);
    near_set = (iqfoc_finite_set_t){exact, deadbeat.reference, IQ24(0.01), 1};
    far_set = (iqfoc_finite_set_t){exact, deadbeat.reference, IQ24(0.01), 3};
    duties = iqfoc_modulate((iqfoc_ab_t){IQ24(0.3), IQ24(0.2)}, IQ24_ONE, bench_config.span_max);
    if (iqfoc_cycle_init(&cycle, bench_drives_config()) != IQFOC_OK) {
        console_text("the benchmark's configuration was refused\n");
        return 1;
    }

    console_text("unit " COUNTER_UNIT "\n");
    bench_report("sincos", count_sincos);
    bench_report("park", count_park);
    bench_report("park_inverse", count_park_inverse);
    bench_report("clarke", count_clarke);
    bench_report("sqrt", count_sqrt);
    bench_report("atan2", count_atan2);
    bench_report("div", count_div);
    bench_report("rotor", count_rotor);
    bench_report("mean_correction", count_mean_correction);
    bench_report("mean_quasi_discrete", count_mean_quasi_discrete);
    bench_report("prediction_euler", count_prediction_euler);
    bench_report("prediction_quasi_discrete", count_prediction_quasi_discrete);
    bench_report("prediction_exact", count_prediction_exact);
    bench_report("exact_at_speed", count_exact_at_speed);
    bench_report("exact_set_up", count_exact_set_up);
    bench_report("prediction_salient", count_prediction_salient);
    bench_report("salient_at_speed", count_salient_at_speed);
    bench_report("mean_modulated", count_mean_modulated);
    bench_report("modulated_at_speed", count_modulated_at_speed);
    bench_report("ripple", count_ripple);
    bench_report("prediction_induction", count_prediction_induction);
    bench_report("induction_at_speed", count_induction_at_speed);
    bench_report("deadbeat", count_deadbeat);
    bench_report("deadbeat_drift", count_deadbeat_drift);
    bench_report("finite_set_1", count_finite_set_1);
    bench_report("finite_set_3", count_finite_set_3);
    bench_report("control_step", count_control_step);
    bench_report("modulation", count_modulation);
    bench_report("current_control", count_current_control_of_drive);
    bench_report("cycle", count_cycle_of_drive);
#define REPORT_DRIVE(name)                                                                                   \
    renew();                                                                                                 \
    bench_report(#name, count_##name);                                                                       \
    status |= cycle.status;
    BENCH_DRIVES(REPORT_DRIVE)
    REPORT_DRIVE(isr_cycle_looked_up)
    REPORT_DRIVE(sample_to_duty)
    bench_services();
    bench_handler_start(&bench_config);
    bench_report("handler_stm32g4", count_handler_stm32g4);
    status |= bench_handler_status();
    if ((status & ~(IQFOC_STATUS_VOLTAGE_LIMIT | IQFOC_STATUS_NO_INTERVAL)) != 0) {
        console_text("status ");
        console_unsigned(status);
        console_text("\n");
        return 1;
    }
    console_text("end\n");
    return 0;
}
