/*
 * Inputs of the benchmark (bench/inputs.h): a 32-bit generator and ranges.
 */
#include "inputs.h"

#include "iqfoc/iq24_math.h"
#include "iqfoc/params.h"

#define T_S      2.0e-4
#define R_OHM    0.75
#define L_H      5.2e-3
#define PSI_WB   0.134
#define U_DC_V   750.0
#define I_BASE_A IQFOC_I_BASE(10.5)
#define W_RAD_S  1500.0

const iqfoc_cycle_config_t bench_config = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_BASE_A, U_DC_V),
    .gains = IQFOC_GAINS(W_RAD_S, R_OHM, L_H, L_H, PSI_WB, T_S, I_BASE_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(0.96),
    .current_limit = IQ24(8.0),
    .period_ticks = 1000,
    .tolerance_ticks = 10,
    .stale_ticks = 100,
    .deadline_ticks = 400,
    .trips = 0,
};

const iqfoc_exact_winding_t bench_winding = IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, T_S, I_BASE_A, U_DC_V);
const iqfoc_salient_machine_t bench_salient =
    IQFOC_SALIENT_MACHINE(R_OHM, L_H, 1.5 * L_H, PSI_WB, T_S, I_BASE_A, U_DC_V);

#define SEED UINT32_C(20161219)

static uint32_t state = SEED;

/* Marsaglia's xorshift with 13, 17, 5. */
static uint32_t draw(void)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state;
}

/* Even over -limit ... limit; limit < 2^31. */
static int32_t draw_within(int32_t limit)
{
    const uint64_t steps = 2 * (uint64_t)limit + 1;
    return (int32_t)((int64_t)((draw() * steps) >> 32) - limit);
}

/* Even over the exponents: small numbers are as frequent as large ones. */
static int32_t draw_magnitudes(void)
{
    const int32_t all_bits = (int32_t)draw();
    return all_bits >> (draw() % 32);
}

void bench_input_restart(void)
{
    state = SEED;
}

void bench_input_draw(bench_input_t *input)
{
    input->any_a = draw_magnitudes();
    input->any_b = draw_magnitudes();
    input->positive = iq24_abs_sat(draw_magnitudes()) | 1;
    input->divisor = draw_magnitudes() | 1;
    while (iq24_abs_sat(input->any_a) / 128 >= iq24_abs_sat(input->divisor)) {
        input->divisor = iq24_add_sat(input->divisor, input->divisor);
    }
    input->i.alpha = draw_within(IQ24(2.0));
    input->i.beta = draw_within(IQ24(2.0));
    input->delta.alpha = draw_within(IQ24(0.5));
    input->delta.beta = draw_within(IQ24(0.5));
    input->u.alpha = draw_within(IQ24(0.8));
    input->u.beta = draw_within(IQ24(0.8));
    input->i_ref.d = draw_within(IQ24(1.0));
    input->i_ref.q = draw_within(IQ24(1.0));
    input->rotor = iqfoc_rotor_from_turns(draw_within(IQFOC_ROTOR_TURNS_MAX));
    input->sample.theta = draw_within(IQ24(1.0));
    input->sc = iq24_sincos(input->sample.theta);
    input->sample.i.a = draw_within(IQ24(2.0));
    input->sample.i.b = draw_within(IQ24(2.0));
    input->sample.i.c = -input->sample.i.a - input->sample.i.b;
    input->sample.i_mean = input->sample.i;
    input->sample.turns = input->rotor.turns;
    input->sample.u_dc = IQ24(1.0) + draw_within(IQ24(0.1));
    input->sample.at = 0;
    input->sample.time = 0;
    input->sample.has_mean = false;
    input->sample.clipped = false;
}
