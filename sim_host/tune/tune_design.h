/*
 * The design: the highest bandwidth whose worst disk margin, at every speed and over the whole region, is what
 * was asked for.
 *
 * One number is sought, the bandwidth w:
 *
 *     keep = e^(-w T)         what the model gets wrong of the current decays with w
 *     learn = (1 - keep)/2    and what is constant of it is learnt at half of that
 *     pi                      follow = keep: the reference is followed with w, too
 *     deadbeat                follow = 0: the reference is met after two cycles, the delay alone
 *
 * The methods differ in how they take a reference; their loops, and so their margins, are the same.
 * w T = pi is as fast as sampling makes sense: keep is then 4 %.
 */
#ifndef SIM_HOST_TUNE_TUNE_DESIGN_H
#define SIM_HOST_TUNE_TUNE_DESIGN_H

#include "tune_margins.h"
#include "tune_region.h"

typedef enum tune_method { TUNE_PI, TUNE_DEADBEAT } tune_method;

extern const char *const tune_method_text[2];

enum { TUNE_SPEEDS = 17 };

/* At one speed: the worst over the region, and what it is of. */
typedef struct tune_at_speed {
    double rpm, sffr; /* sffr: INFINITY at standstill */
    double phi_rad;
    tune_margins worst, nominal;
    int disk_worst;             /* index of the region's point */
    tune_pole pole[TUNE_ORDER]; /* nominal */
    int poles;
    double radius_worst; /* largest modulus of a pole over the region */
} tune_at_speed;

typedef struct tune_result {
    motor motor; /* its f_pwm_Hz is the one designed for */
    tune_method method;
    double disk_wanted;
    tune_region region;
    tune_design design;
    double bandwidth_rad_s;
    char limited_by[240];
    tune_at_speed at[TUNE_SPEEDS]; /* from 0 to n_max */
} tune_result;

/* The controller of a method at a bandwidth w T. */
tune_design tune_design_of(tune_method method, const tune_machine *machine, double T_s, double w_T);

/*
 * Fills r->design and all below it from motor, method, disk_wanted and region. False with *e set where no
 * bandwidth will do: what could be had is in the message.
 */
bool tune_design_find(tune_result *r, error *e);

/* The same, but for the margins at each speed: r->at has speeds alone. */
bool tune_design_bandwidth(tune_result *r, error *e);

#endif
