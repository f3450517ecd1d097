/*
 * The simulated true drive at switching level: inverter, machine, shaft and sensors.
 *
 * A control cycle runs from one carrier valley (t = 0) over the peak (t = T/2) to the next valley (t = T). A
 * leg with duty d is high from T (1 - d)/2 to T (1 + d)/2, around the peak. Use:
 *
 *     plant_begin_cycle(p, duty);        duties in force from this valley
 *     plant_sample(p, &valley);          what the ADC sees now
 *     plant_advance_to(p, 0.5 * T);      to the peak, over every edge on the way
 *     plant_sample(p, &peak);
 *     plant_advance_to(p, T);            to the next valley
 *     plant_mean(p)                      the true means since the cycle began
 *
 * Six-step: plant_begin_interval in place of plant_begin_cycle, one inverter state for any duration. A pulse pattern: plant_switch at
 * each edge within it.
 * Between edges an ideal drive at constant given speed is advanced exactly (plant_electrical.h); with effects
 * that are not linear, or a speed that changes, by an error-controlled integrator (plant_solver.h).
 */
#ifndef SIM_HOST_PLANT_PLANT_H
#define SIM_HOST_PLANT_PLANT_H

#include "../base/vector.h"
#include "plant_config.h"
#include "plant_inverter.h"
#include "plant_machine.h"
#include "plant_random.h"
#include "plant_sensor.h"

/* True means over the time since the cycle or interval began; in closed form where the drive is linear. */
typedef struct plant_means {
    double duration_s;
    vec_ab i_ab_A;
    double i_A[3];
    vec_dq i_dq_A; /* seen from the turning rotor */
    vec_ab u_ab_V; /* at the machine's terminals */
    double u_V[3]; /* the same, phase to star point */
} plant_means;

/* A point of the true waveforms. */
typedef struct plant_point {
    double t_s; /* since plant_init */
    double theta_e_rad, omega_e_rad_s;
    double i_A[3];
    vec_dq i_dq_A;
    double u_V[3]; /* phase to star point, at the machine's terminals */
    double torque_Nm;
} plant_point;

typedef void plant_trace(void *context, const plant_point *point);

typedef struct plant {
    plant_config config;
    plant_state state; /* current, angle, speed and running integrals */
    inverter_leg leg[3];
    double t_span_s;   /* start of the present span between edges */
    double t_cycle_s;  /* since the cycle or interval began */
    double duration_s; /* of this cycle or interval */
    double t_begin_s;  /* its start, since plant_init */
    bool linear;       /* the exact path serves */
    sensor_memory sensors;
    plant_random glitch_random;
    /* Commanded: [whole delay_cycles] now, [0] so many cycles ago. */
    double duty_queue[PLANT_VOLTAGE_DELAY_MAX + 1][3];
    double duty_in_force[3]; /* from this cycle's valley on, or from its peak */
    double duty_to_peak[3];
    double duty_to_gate[2][3]; /* what the gates get up to the peak, and from there on */
    bool duties_seen;
    bool glitched;      /* this cycle missed its update */
    long glitches;      /* how many did */
    plant_trace *trace; /* NULL: none. Called before and after every edge, and every trace_step_s */
    void *trace_context;
    double trace_step_s; /* 0: at edges only */
} plant;

/* The configuration must have passed plant_config_check. Current starts at zero. */
void plant_init(plant *p, const plant_config *c);

void plant_set_current(plant *p, vec_dq i_dq_A);
/* Other values of machine, inverter, shaft and sensors from now on, checked as at the start; angle, speed and current stay. */
void plant_set_config(plant *p, const plant_config *c);
/* PLANT_SHAFT_GIVEN: speed and acceleration from now on. */
void plant_set_speed(plant *p, double omega_e_rad_s, double accel_e_rad_s2);
void plant_set_load(plant *p, double T_load_Nm);

/* Duties outside 0 .. 1 count as 0 or 1. What is left of the last cycle is advanced first. */
void plant_begin_cycle(plant *p, const double duty[3]);
/* Half a carrier period, from its valley to its peak or from there on: for drives that update twice a period. T_s of the
 * configuration is then that of a half; samples at both ends see a current without ripple. */
void plant_begin_half(plant *p, const double duty[3], bool to_peak);
/* One inverter state, high[x] for phase x, for any duration > 0. */
void plant_begin_interval(plant *p, const bool high[3], double duration_s);
/* Leg x changes its level now. */
void plant_switch(plant *p, int x);

/* t_s since the cycle began; at most its duration, never backwards. */
void plant_advance_to(plant *p, double t_s);

/* What the sensors deliver now; draws noise, so two calls differ. */
void plant_sample(plant *p, plant_samples *s);

plant_means plant_mean(const plant *p);
/* The truth now. */
plant_point plant_now(const plant *p);

/* A whole cycle: samples at its valley and its peak, and its true means. Any of the three may be NULL. */
void plant_cycle(plant *p, const double duty[3], plant_samples *valley, plant_samples *peak,
                 plant_means *means);

#endif
