/*
 * The design: the highest bandwidth whose worst disk margin reaches the requirement, at every speed and over the
 * uncertainty set.
 *
 * The search has one variable, the bandwidth w:
 *
 *     keep = e^(-w T)         pole radius: an error of the current decays with w
 *     learn = (1 - keep)/2    observer gain: the constant part is estimated at half of that
 *     pi                      follow = keep: the reference's filter has w, too
 *     deadbeat                follow = 0: the set-point is reached after two cycles, the delay
 *
 * The methods differ in the filter of the reference. Their loops, and so their margins, are the same. The search ends
 * at w T = pi, where keep is 4 %: sampling allows nothing faster. It accepts a margin within 0.1 % of the
 * requirement.
 */
#ifndef SIM_HOST_TUNE_TUNE_DESIGN_H
#define SIM_HOST_TUNE_TUNE_DESIGN_H

#include "tune_margins.h"
#include "tune_region.h"

typedef enum tune_method { TUNE_PI, TUNE_DEADBEAT } tune_method;

extern const char *const tune_method_text[2];

enum { TUNE_SPEEDS = 17 };

/* Share of the required disk margin at which the search ends. */
#define TUNE_DISK_ACCEPTED 0.999

/* At one speed: the worst over the uncertainty set, and its machine. */
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
    bool halves; /* a control cycle is half a carrier period: f_pwm_Hz is twice the carrier's */
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
 * If r->halves, the offset's gain is 0: there is no sample between both ends of a cycle. The margins are those with it.
 *
 * Fills r->design and all members below it from motor, method, disk_wanted and region. False with *e set if no
 * bandwidth reaches the requirement; the message has the best margin.
 */
bool tune_design_find(tune_result *r, error *e);

/* The same without the margins at each speed: r->at has speeds only. */
bool tune_design_bandwidth(tune_result *r, error *e);

#endif
