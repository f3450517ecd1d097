/*
 * The parameters that a fit can move, as dimensionless coordinates z about the motor file. z = 0 is the value of the motor file, and
 * a step of 1 is a large change (100 % of R, a radian, the rated current). Their rows are in data/causes.def, each with its cause.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_COORDINATES_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_COORDINATES_H

#include "model/averaged_drive.h"
#include "rows.h"

typedef enum coordinate_id {
#define COORDINATE(P, ...) P,
#include "data/causes.def"
    P_COUNT
} coordinate_id;

/* The unit of z: the change of the parameter for a step of 1. */
typedef enum coordinate_scale {
    SCALE_ONE,
    SCALE_R,          /* resistance of the motor file */
    SCALE_L,          /* mean of its inductances */
    SCALE_PSI,        /* flux linkage of its magnet */
    SCALE_CURRENT,    /* the rated peak current */
    SCALE_PER_SQUARE, /* 1 / rated peak current^2 */
    SCALE_MAP_THIRD,  /* third-order term of the flux map that doubles the flux at the rated current */
    SCALE_MAP_FOURTH, /* fourth-order term that does so */
    SCALE_MAP_ENERGY, /* mean inductance times the square of the rated peak current */
    SCALE_LINK,       /* 1 % of the DC link */
    SCALE_CYCLE,      /* a control cycle */
    SCALE_IRON,       /* iron loss with 1 % of the rated current at the highest speed */
    SCALE_FE,         /* iron branch with that current at the recording's voltages */
    SCALE_IRON_LATE,  /* SCALE_IRON times a cycle */
    SCALE_PERCENT,
    /* Rates: a change by one such unit over the length of the recording. */
    SCALE_RATE,
    SCALE_R_RATE,
    SCALE_PSI_RATE,
    SCALE_CURRENT_RATE,
    SCALE_COUNT
} coordinate_scale;

/* What `low` and `high` of a coordinate limit. */
typedef enum coordinate_bound {
    BOUND_NONE,
    BOUND_OF_Z,
    BOUND_OF_NOMINAL, /* the value, as a multiple of the file's */
    BOUND_OF_RATED    /* the value, as a multiple of the rated peak current */
} coordinate_bound;

typedef struct coordinate {
    size_t offset;    /* of its member in averaged_drive */
    bool logarithmic; /* value = nominal e^z; else nominal + scale z */
    coordinate_scale scale;
    double step; /* in z, for difference quotients; 0: `digits`, or COORDINATE_STEP without one */
    /* Step of a search from z = 0, for an effect whose slope there is misleading; 0: `step`. */
    double first_step;
    coordinate_bound bound;
    double low, high;
    bool not_negative;  /* the parameter is at least 0, whatever the motor file has */
    double stride;      /* largest change in a step of a fit, in z; 0: any */
    double summary;     /* added to its interval, as the report has a simpler model than the fit; in z */
    double wanders;     /* of a shape parameter: standard deviation between operating points, in z */
    bool senses;        /* changes the measured current only, not the drive */
    bool rate;          /* is the rate of another coordinate, per second */
    bool of_magnet;     /* without a magnet it keeps the motor file's value */
    bool third_sensor;  /* exists only if three currents are measured */
    bool of_noise;      /* exists only if the rows show noise of the voltages */
    int volts, amperes; /* powers by which it goes with all voltages, and with all currents, of a drive */
    double usual;       /* usual deviation of drives, one standard deviation, in z; 0: not known */
    double digits;      /* parameter tolerance, one standard deviation, in z; 0: none */
} coordinate;

extern const coordinate coordinate_table[P_COUNT];

/* Usual deviation of drives, in z; 1 if it is not known. */
static inline double coordinate_usual(coordinate_id id)
{
    return coordinate_table[id].usual > 0.0 ? coordinate_table[id].usual : 1.0;
}

enum { COORDINATE_DIRECTIONS = 16 };

/* The motor file, and the units of its coordinates. */
typedef struct coordinate_frame {
    const motor *motor;
    averaged_drive nominal;
    double scale[SCALE_COUNT];
    double i_rated_peak_A;
    int pole_pairs;
    /* A compensation above this times the inductance has a sign that is doubted: a wrong one is seen through the noise. */
    double doubted_V_H;
    double of_least; /* factor of all reporting thresholds: 1, or 0 to report any size */
    /* The largest recorded current in each direction of the rotor frame. Up to these currents a flux map must be physical. */
    vec_dq reach_A[COORDINATE_DIRECTIONS];
} coordinate_frame;

coordinate_frame coordinates_of(const motor *m, const diagnose_rows *r);

/* Which compensations have a sign that is doubted, by the noise of the rows' currents. */
void coordinates_doubt(coordinate_frame *f, const diagnose_rows *r);

/*
 * The drive at z. `edge`: edge model of a dead time that is fitted. A dead time that only the motor file states keeps the file's edge
 * model.
 */
averaged_drive coordinates_drive(const coordinate_frame *f, const double z[P_COUNT], edge_law edge);

/* A coordinate's parameter of a drive. */
double coordinate_value(const averaged_drive *d, coordinate_id id);

/* Step in z for difference quotients, and for those of a search that starts from z. */
#define COORDINATE_STEP 1e-4
double coordinate_step(coordinate_id id);
double coordinate_look(coordinate_id id, double z);

/* Largest share of the flux L i that saturation takes, or adds, at the recorded currents. */
double coordinates_flux_lost(const coordinate_frame *f, const double z[P_COUNT]);

/*
 * Sets the inductances and the two parts that saturate of `to`, so that their flux is as close as possible to that of `from` at the
 * recorded currents (model/flux_parts.h).
 */
void coordinates_take_parts(const coordinate_frame *f, const double from[P_COUNT], double to[P_COUNT]);

/* Limits of z between which a coordinate by itself is physical; infinite if it has none. */
void coordinate_range(const coordinate_frame *f, coordinate_id id, double *low, double *high);

/*
 * The drive with all voltages and all currents multiplied, as its sensors would show it: the voltages' gain goes with the voltages, and
 * the current sensors' against the currents. A recording does not show such a change, except in the current ripple of the duties. How
 * sharply an edge ends keeps its bounds: at the sharpest, the rows do not show the current at which.
 */
void coordinates_scale(const coordinate_frame *f, double voltages, double currents, double z[P_COUNT]);

/* The factor that gives a coordinate the motor file's value. */
double coordinates_to_file(const coordinate_frame *f, coordinate_id id, const double z[P_COUNT]);

/*
 * Limits z to physical values: R, L, psi_f > 0, a knee current well below the rated current, sensor gains of 0.6 to 1.6, and a flux
 * that rises with the current up to the recorded currents.
 */
void coordinates_bound(const coordinate_frame *f, double z[P_COUNT]);

#endif
