/* What the sensors make of the truth (plant_sensor.h). */
#include "plant_sensor.h"
#include "../base/vector.h"
#include "plant_machine.h"

#include <math.h>

static const double ROOM_C = 25.0;
enum { STREAM_CURRENT = 1, STREAM_ANGLE, STREAM_LOOSE, STREAM_EDGE };

/* By how much the size of what an edge leaves varies from edge to edge. */
static const double EDGE_VARIES = 0.3;

void sensor_init(sensor_memory *m, uint64_t seed)
{
    plant_random_seed(&m->current, seed, STREAM_CURRENT);
    plant_random_seed(&m->angle, seed, STREAM_ANGLE);
    plant_random_seed(&m->loose, seed, STREAM_LOOSE);
    plant_random_seed(&m->edge, seed, STREAM_EDGE);
    m->held_begun = false;
    m->loose_left = 0;
    m->dropouts = 0;
    m->speed_begun = false;
    m->speed_at_s = m->speed_true_rad_s = m->speed_seen_rad_s = 0.0;
}

/* Round to nearest code of a two's complement converter, which has one code fewer above zero than below. */
static double adc(double value, int bits, double full_scale)
{
    if (bits == 0) {
        return value;
    }
    const double codes = ldexp(1.0, bits - 1); /* of one sign */
    const double lsb = full_scale / codes;
    return fmin(fmax(nearbyint(value / lsb), -codes), codes - 1.0) * lsb;
}

static double noise(plant_random *r, double sigma)
{
    return sigma > 0.0 ? sigma * plant_random_normal(r) : 0.0;
}

static double wrap(double angle_rad)
{
    double turns = angle_rad / (2.0 * VEC_PI);
    double wrapped = (turns - floor(turns)) * (2.0 * VEC_PI);
    return wrapped < 2.0 * VEC_PI ? wrapped : 0.0;
}

/* Is the loose channel open at this sample? Lengths are geometric with mean loose_samples. */
static bool loose_now(const plant_sensors *s, sensor_memory *m)
{
    if (s->loose_probability <= 0.0) {
        return false;
    }
    if (m->loose_left == 0 && plant_random_uniform(&m->loose) < s->loose_probability) {
        m->dropouts++;
        m->loose_left = 1;
        while (plant_random_uniform(&m->loose) >= 1.0 / s->loose_samples) {
            m->loose_left++;
        }
    }
    if (m->loose_left == 0) {
        return false;
    }
    m->loose_left--;
    return true;
}

/* The channel whose contact is loose. */
static int loose_channel(const plant_sensors *s)
{
    return s->fault_phase > 0.0 ? (int)s->fault_phase - 1 : s->loose_channel;
}

/* tau dy/dt + y = speed, which goes in a straight line from sample to sample. */
static double filtered_speed(double tau_s, sensor_memory *m, double t_s, double speed_rad_s)
{
    if (tau_s == 0.0) {
        return speed_rad_s;
    }
    const double h_s = t_s - m->speed_at_s;
    if (!m->speed_begun) {
        m->speed_seen_rad_s = speed_rad_s;
    } else if (h_s > 0.0) {
        const double slope = (speed_rad_s - m->speed_true_rad_s) / h_s;
        const double steady = m->speed_true_rad_s - tau_s * slope;
        m->speed_seen_rad_s = steady + slope * h_s + (m->speed_seen_rad_s - steady) * exp(-h_s / tau_s);
    }
    m->speed_begun = true;
    m->speed_at_s = t_s;
    m->speed_true_rad_s = speed_rad_s;
    return m->speed_seen_rad_s;
}

/* A core's play: what is shown follows once the current has turned by twice the width. */
static double held(const plant_sensors *s, sensor_memory *m, int x, double i_A)
{
    if (s->hysteresis_A == 0.0) {
        return i_A;
    }
    m->held_A[x] =
        m->held_begun ? fmin(fmax(m->held_A[x], i_A - s->hysteresis_A), i_A + s->hysteresis_A) : i_A;
    return m->held_A[x];
}

/* What the last edge of each leg leaves in channel x. */
static double edges(const plant_sensors *s, const double size[3], int x)
{
    double sum = 0.0;
    for (int leg = 0; leg < 3; leg++) {
        sum += size[leg] * (leg == x ? 1.0 : s->edge_coupling);
    }
    return sum;
}

static double hum(const plant_sensors *s, const sensor_truth *truth, int x)
{
    const bool here = s->hum_A != 0.0 && (s->hum_channel == 0 || s->hum_channel == x + 1);
    return here ? s->hum_A * sin(2.0 * VEC_PI * s->hum_Hz * truth->t_s) : 0.0;
}

/* What the three channels show of the true currents before noise and dropouts. */
static void channels(const plant_sensors *s, sensor_memory *m, const sensor_truth *truth, double i_A[3])
{
    double shown[3];
    double size[3] = {0.0, 0.0, 0.0};
    for (int x = 0; x < 3; x++) {
        const double gain = s->current_gain[x] + s->current_gain_rate_s[x] * truth->clock_s;
        const double offset_A = s->current_offset_A[x] + s->current_offset_rate_A_s[x] * truth->clock_s;
        shown[x] = held(s, m, x, gain * truth->i_A[x] + offset_A);
        if (s->edge_A != 0.0) {
            size[x] = s->edge_A * truth->edge_sign[x] * exp(-truth->edge_age_s[x] / s->edge_s) *
                      (1.0 + EDGE_VARIES * plant_random_normal(&m->edge));
        }
    }
    m->held_begun = true;
    for (int x = 0; x < 3; x++) {
        const double crossed = x > 0 ? s->crosstalk * shown[x - 1] : 0.0;
        i_A[x] = shown[x] + crossed + edges(s, size, x) + hum(s, truth, x);
    }
}

void sensor_read(const plant_config *c, sensor_memory *m, const sensor_truth *truth, plant_samples *s)
{
    const plant_sensors *sensors = &c->sensors;
    const bool loose = loose_now(sensors, m);
    double shown_A[3];
    s->t_s = truth->t_s;
    channels(sensors, m, truth, shown_A);
    for (int x = 0; x < 3; x++) {
        double i = shown_A[x];
        if (loose && x == loose_channel(sensors)) {
            i = sensors->loose_gain * i + sensors->loose_step_A;
        }
        i += noise(&m->current, sensors->current_noise_A);
        s->i_A[x] = adc(i, sensors->current_bits, sensors->current_full_scale_A);
    }
    const double pole_pairs = (double)c->machine.pole_pairs;
    const double late_s = sensors->t_delay_s;
    double wrong_rad = truth->omega_e_rad_s * late_s + 0.5 * truth->accel_e_rad_s2 * late_s * late_s;
    wrong_rad += sensors->theta_0_rad + noise(&m->angle, sensors->angle_noise_rad);
    for (int n = 0; n < PLANT_HARMONICS; n++) {
        const plant_harmonic *h = &sensors->harmonic[n];
        wrong_rad += h->amplitude_rad * cos(h->order * truth->theta_mech_rad + h->phase_rad);
    }
    s->theta_e_rad = wrap(pole_pairs * truth->theta_mech_rad + wrong_rad);
    s->theta_mech_rad = wrap(truth->theta_mech_rad + wrong_rad / pole_pairs);
    s->omega_e_rad_s = filtered_speed(sensors->speed_lag_s, m, truth->t_s, truth->omega_e_rad_s) +
                       noise(&m->angle, sensors->omega_noise_rad_s);
    s->temp_C = ROOM_C + machine_warmer_K(&c->machine, truth->clock_s);
    /* A link measured wrong reads 1/k_u of what is there. */
    s->u_dc_V = truth->u_dc_V / c->inverter.k_u + noise(&m->angle, sensors->u_dc_noise_V);
}
