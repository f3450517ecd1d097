/*
 * The true parameters of the simulated drive, which firmware and diagnosis do not see. Physical units.
 *
 * plant_config_from_motor gives the ideal drive of a motor file; the scenario sets sensors and shaft,
 * plant_config_extend adds the effects of the file, and plant_effect_apply (plant_effect.h) makes it differ from the file.
 */
#ifndef SIM_HOST_PLANT_PLANT_CONFIG_H
#define SIM_HOST_PLANT_PLANT_CONFIG_H

#include "../base/error.h"
#include "../data/motor.h"

#include <stdint.h>

/* Directions of the rotor frame in which the end of a flux map is sought. */
#define PLANT_MAP_DIRECTIONS 16

/* The most cycles by which a voltage can be late. */
#define PLANT_VOLTAGE_DELAY_MAX 8

/*
 * Iron that saturates: energy E sqrt(1 + ((i_d - I_c)/I_d)^2 + (i_q/I_q)^2), in addition to straight iron. E_J = 0: none. Flux and
 * inductances at no current are those of psi_f, L_d and L_q.
 */
typedef struct plant_iron {
    double E_J, I_d_A, I_q_A, I_c_A;
} plant_iron;

enum { PLANT_IRONS = 2 };

typedef struct plant_machine {
    int pole_pairs;
    double R_ohm;
    double dR_ohm[3];    /* phase x has R + dR[x] */
    double L_d_H, L_q_H; /* at zero current, if it saturates */
    double dL_H[3];      /* in series with phase x: leakage, or a choke in the cable */
    double psi_f_Wb;
    /* R and psi_f grow by alpha per kelvin above reference_K; the drive warms by heating_K (1 - e^{-clock/heating_s}). */
    double alpha_R, alpha_psi, heating_K, heating_s, reference_K;
    double R_rate_ohm_s, psi_rate_Wb_s; /* by which both have grown for each second of the clock */
    double psi_5_Wb, psi_7_Wb; /* psi_A = psi_f cos(theta) + psi_5 cos(5 theta) + psi_7 cos(7 theta) + ... */
    double psi_11_Wb, psi_13_Wb;
    double I_sat_A; /* flux / current = L/(1 + (i/I_sat)^2), i by its energy; 0: none */
    /* A flux map: further terms of the energy, of third and fourth order in i_d and i_q. */
    double w_ddd, w_dqq;           /* Wb/A^2 */
    double w_dddd, w_ddqq, w_qqqq; /* Wb/A^3 */
    plant_iron iron[PLANT_IRONS];  /* and of what saturates by itself */
    double
        map_reach_A[PLANT_MAP_DIRECTIONS]; /* how far the map holds in each direction; plant_init finds it */
    double map_least_A;                    /* the least of them */
    double
        R_fe_ohm; /* iron loss: branch in parallel with the flux, R_fe with tau_fe * R_fe in series; 0: none */
    double tau_fe_s;
    /* A short circuit of a share of one phase's turns through short_ohm; its current follows within short_s. */
    double short_turns, short_phase; /* 0: none; phase 1, 2 or 3 */
    double short_ohm, short_s;
    double weak_pole;    /* share of its flux that one pole pair has lost where it is weakest; 0: none */
    double eccentricity; /* the magnet's flux varies by this share once per mechanical revolution */
} plant_machine;

typedef struct plant_inverter {
    double u_dc_V;   /* true mean of the DC link */
    double k_u;      /* the true link is k_u times what is measured; 1: measured right */
    double ripple_V; /* amplitude of a sine on the DC link */
    double ripple_Hz;
    bool ripple_logged;    /* the measured link shows the ripple (at the valley); else only its mean */
    double unlogged_share; /* amplitude of another sine on the link, of its mean, that is never measured */
    double unlogged_Hz;
    double t_dead_s;       /* each switch turns on this much after it was commanded to */
    double v_switch_V;     /* constant drop of a conducting transistor */
    double v_diode_V;      /* and of a diode */
    double r_on_ohm;       /* of either */
    double delay_cycles;   /* duties act this much late; a half: registers that load at the peak */
    double compensation_V; /* added to each leg by the sign of its current at the valley; not in the record */
    double compensation_knee_A; /* below it in proportion to the current */
    double glitch_probability;  /* of a cycle that keeps the last cycle's duties: a PWM update missed */
} plant_inverter;

typedef enum plant_shaft_mode {
    PLANT_SHAFT_GIVEN,  /* speed is given: omega_start and a constant acceleration */
    PLANT_SHAFT_INERTIA /* J domega_mech/dt = torque - load - friction * omega_mech */
} plant_shaft_mode;

typedef struct plant_shaft {
    plant_shaft_mode mode;
    double theta_mech_start_rad;
    double omega_e_start_rad_s;
    double accel_e_rad_s2; /* PLANT_SHAFT_GIVEN */
    double J_kgm2;         /* PLANT_SHAFT_INERTIA, > 0 */
    double friction_Nms;
    double T_load_Nm; /* against positive rotation; may be changed between cycles */
} plant_shaft;

/* Of the angle sensor's error: how often it repeats in a mechanical revolution. */
#define PLANT_HARMONICS 4
typedef struct plant_harmonic {
    double order, amplitude_rad, phase_rad;
} plant_harmonic;

typedef struct plant_sensors {
    int current_bits; /* of the ADC over -full_scale .. +full_scale; 0: not quantised */
    double current_full_scale_A;
    double current_noise_A; /* standard deviation, each channel and sample on its own */
    double current_gain[3]; /* measured = gain * true + offset */
    double current_offset_A[3];
    double current_gain_rate_s[3], current_offset_rate_A_s[3]; /* by which both grow with the clock */
    double current_lag_s;        /* the low-pass by its time constant; negative: sampled so late */
    double current_bandwidth_Hz; /* first-order low-pass of all channels; 0: none */
    double
        theta_0_rad; /* reading = true(t + t_delay) + theta_0 + sum of amplitude cos(order theta_mech + phase) */
    plant_harmonic harmonic[PLANT_HARMONICS];
    double t_delay_s;
    double angle_noise_rad; /* standard deviation, electrical */
    double omega_noise_rad_s;
    double speed_lag_s; /* time constant of a first-order filter of the speed, ahead of its noise; 0: none */
    double u_dc_noise_V;
    int loose_channel;        /* 0, 1, 2: phase whose contact is loose */
    double fault_phase;       /* the same as 1, 2, 3, in place of loose_channel; 0: that */
    double loose_probability; /* of a new dropout at each sample; 0: none */
    double loose_samples;     /* mean length of a dropout, samples, >= 1 */
    double loose_gain;        /* during a dropout the channel reads gain * value + step */
    double loose_step_A;
    double hysteresis_A; /* a channel stands still until its current has turned by twice that */
    double crosstalk;    /* channel b reads a share of channel a as well, channel c one of b */
    double hum_A;        /* a sine picked up by channel hum_channel (1, 2, 3), or by all three alike (0) */
    double hum_Hz;
    int hum_channel;
    double
        edge_A; /* after an edge of its leg a channel reads so much more (falling: less), which dies with edge_s */
    double edge_s;
    double edge_coupling; /* share of it in the other two channels */
} plant_sensors;

/* Of the currents' low-pass, rad/s; 0: none. */
static inline double plant_current_filter(const plant_sensors *s)
{
    return s->current_lag_s > 0.0 ? 1.0 / s->current_lag_s : 6.283185307179586 * s->current_bandwidth_Hz;
}

typedef struct plant_config {
    plant_machine machine;
    plant_inverter inverter;
    plant_shaft shaft;
    plant_sensors sensors;
    double clock_s;   /* when the drive starts: what drifts has the values above when the clock shows 0 */
    double T_s;       /* control cycle = PWM period */
    double I_scale_A; /* size of the currents, for the tolerance of the numerical path: rated peak */
    uint64_t seed;
} plant_config;

/*
 * The ideal drive of a motor file: its [motor] and [inverter] values, perfect sensors, standing shaft. Its
 * extensions are fitted laws of the averaged model, not physics, and are not taken over; but its inductances
 * are those at zero current, as everywhere (motor_inductances).
 */
plant_config plant_config_from_motor(const motor *m);

/* What the motor file's [extension] says of a cause, as the plant's own physics; nothing if it has none of it. */
void plant_config_extend(plant_config *c, const motor *m, cause_id cause);

/* Refuses, by the field's name, what no machine can have. */
bool plant_config_check(const plant_config *c, error *e);

#endif
