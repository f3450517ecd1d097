/*
 * Inputs of the benchmark (bench/inputs.h): a 32-bit generator and ranges.
 */
#include "inputs.h"

#include "iqfoc/extension_params.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/params.h"
#include "iqfoc/transform.h"

#define T_S      2.0e-4
#define R_OHM    0.75
#define L_H      5.2e-3
#define PSI_WB   0.134
#define U_DC_V   750.0
#define I_BASE_A IQFOC_I_BASE(10.5)
#define W_RAD_S  1500.0

/* 10000 1/min with three pole pairs: a quarter above what the 2019 paper drives this machine to. */
#define TURNS_TOP IQFOC_SPEED(10000.0, 3.0, T_S)

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
const iqfoc_flux_predictor_t bench_flux =
    IQFOC_FLUX_PREDICTOR(R_OHM, L_H, 1.5 * L_H, PSI_WB, T_S, I_BASE_A, U_DC_V);
const iqfoc_flux_map_t bench_flux_map = IQFOC_FLUX_MAP(
    R_OHM, 0.7 * L_H, 0.5 * L_H, PSI_WB,
    IQFOC_FLUX_MAP_PART(0.5 * L_H * 144.0, 20.0, 12.0, -5.0, T_S, I_BASE_A, U_DC_V),
    IQFOC_FLUX_MAP_PART(0.3 * L_H * 64.0, 15.0, 8.0, 4.0, T_S, I_BASE_A, U_DC_V), T_S, I_BASE_A, U_DC_V);
const iqfoc_salient_machine_t bench_salient =
    IQFOC_SALIENT_MACHINE(R_OHM, L_H, 1.5 * L_H, PSI_WB, T_S, I_BASE_A, U_DC_V);

const iqfoc_watch_config_t bench_watch =
    IQFOC_WATCH_CONFIG(R_OHM, L_H, 1.5 * L_H, PSI_WB, 3, T_S, I_BASE_A, U_DC_V, 0.003);

const iqfoc_induction_machine_t bench_induction =
    IQFOC_INDUCTION_MACHINE(0.1, 0.06, 2.5e-3, 26e-3, 2.0e-3, 311.0, 1500.0);

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

static iqfoc_dq_t draw_reference(void)
{
    const iqfoc_dq_t i = {draw_within(IQ24(0.25)), draw_within(IQ24(0.95))};
    return i;
}

/*
 * A drive in normal operation: at any speed up to a quarter above that of the paper, with the measured
 * current within 5 % of the rated current of its reference, as noise and ripple leave it, and with the
 * voltage that holds it there. The DC link is within 10 % of nominal. In one cycle of sixteen the reference
 * has just stepped to another; there, and at the top of the speeds, the voltage asked for may be more than
 * the inverter can make.
 */
static void draw_operating_point(bench_input_t *input)
{
    const iqfoc_dq_t settled = draw_reference();
    const iqfoc_dq_t other = draw_reference();
    input->i_ref = draw() % 16 == 0 ? other : settled;
    input->sample.u_dc = IQ24(1.0) + draw_within(IQ24(0.1));
    input->u_dc_inverse = iq24_div(IQ24_ONE, input->sample.u_dc);

    input->u_winding.d = iq24_mul_round(settled.d, IQ24(R_OHM * I_BASE_A / U_DC_V));
    input->u_winding.q = iq24_mul_round(settled.q, IQ24(R_OHM * I_BASE_A / U_DC_V));
    const iqfoc_dq_t apart =
        iqfoc_current_control_decoupling(&bench_config.gains, settled, input->rotor.speed);
    input->u_steady.d = input->u_winding.d + apart.d;
    input->u_steady.q = input->u_winding.q + apart.q;

    const iqfoc_dq_t i = {settled.d + draw_within(IQ24(0.05)), settled.q + draw_within(IQ24(0.05))};
    input->sample.i = iqfoc_clarke_inverse(iqfoc_park_inverse(i, input->sc));
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
    input->rotor = iqfoc_rotor_from_speed(draw_within(TURNS_TOP));
    input->sample.theta = draw_within(IQ24(1.0));
    input->sc = iq24_sincos(input->sample.theta);
    draw_operating_point(input);
    input->sample.i_mean = input->sample.i;
    input->sample.speed = input->rotor.speed;
    input->sample.instant = 0;
    input->sample.time = 0;
    input->sample.has_mean = false;
    input->sample.clipped = false;
}
