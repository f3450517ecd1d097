/*
 * The numbers that a fit can move, as dimensionless coordinates z around the motor file: z = 0 is what the
 * file says, and a step of 1 is a large change (100 % of R, a radian, the rated current). The rows stand in
 * data/causes.def, each with its cause.
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

/* What a step of 1 in z is, in the coordinate's own unit. */
typedef enum coordinate_scale {
    SCALE_ONE,
    SCALE_R,          /* the file's resistance */
    SCALE_L,          /* the mean of its inductances */
    SCALE_PSI,        /* its magnet's flux */
    SCALE_CURRENT,    /* the rated peak current */
    SCALE_PER_SQUARE, /* 1 / rated peak current^2 */
    SCALE_MAP_THIRD,  /* a term of third order of the flux map that doubles the flux at the rated current, */
    SCALE_MAP_FOURTH, /* and one of fourth */
    SCALE_LINK,       /* 1 % of the DC link */
    SCALE_CYCLE,      /* a control cycle */
    SCALE_IRON,       /* an iron loss that takes 1 % of the rated current at the highest speed */
    SCALE_FE,         /* an iron's branch that takes that at the recording's voltages */
    SCALE_IRON_LATE,  /* that times a cycle */
    SCALE_PERCENT,
    /* A change of 1 of these through the recording. */
    SCALE_RATE,
    SCALE_R_RATE,
    SCALE_PSI_RATE,
    SCALE_CURRENT_RATE,
    SCALE_COUNT
} coordinate_scale;

/* What `low` and `high` of a coordinate bound. */
typedef enum coordinate_bound {
    BOUND_NONE,
    BOUND_OF_Z,
    BOUND_OF_NOMINAL, /* the value, as a multiple of the file's */
    BOUND_OF_RATED    /* the value, as a multiple of the rated peak current */
} coordinate_bound;

typedef struct coordinate {
    size_t offset;    /* of the double within averaged_drive */
    bool logarithmic; /* value = nominal e^z; else nominal + scale z */
    coordinate_scale scale;
    double step; /* for differences, in z; 0: the usual one */
    /* By which a search looks from nought, where the slope says nothing of where it goes; 0: the same. */
    double first_step;
    coordinate_bound bound;
    double low, high;
    bool not_negative; /* nor is the value, whatever the file says */
    double summary; /* what its interval must allow for where a plainer law stands for the fitted one, in z */
    double wanders; /* of what shapes a law: its standard deviation between operating points, in z */
    bool senses;    /* moves what the sensors show, and not the drive */
    bool rate;      /* of another coordinate, per second */
    bool third_sensor; /* there is no such number where two currents are measured */
    double usual;      /* one standard deviation of what drives show, in z; 0: nothing is said */
    double digits;     /* and of what a file's last digits leave open, unnamed; 0: it is as the file says */
} coordinate;

extern const coordinate coordinate_table[P_COUNT];

/* What drives show of one; 1 where nothing is usual. */
static inline double coordinate_usual(coordinate_id id)
{
    return coordinate_table[id].usual > 0.0 ? coordinate_table[id].usual : 1.0;
}

enum { COORDINATE_DIRECTIONS = 16 };

/* A motor file with the sizes that its coordinates are measured in. */
typedef struct coordinate_frame {
    const motor *motor;
    averaged_drive nominal;
    double scale[SCALE_COUNT];
    double i_rated_peak_A;
    int pole_pairs;
    double
        of_least; /* by which each hypothesis' `least` is multiplied: 1, or 0 where any size is worth a name */
    /* The largest recorded currents in each direction of the rotor frame: up to there a flux map must be one that a
     * machine can have. */
    vec_dq reach_A[COORDINATE_DIRECTIONS];
} coordinate_frame;

coordinate_frame coordinates_of(const motor *m, const diagnose_rows *r);

/* The drive at z. `edge`: the law of a dead time that is fitted; one that the file states is the plain law. */
averaged_drive coordinates_drive(const coordinate_frame *f, const double z[P_COUNT], edge_law edge);

/* The step for differences, and for those by which a search looks where to go from z. */
#define COORDINATE_STEP 1e-4
double coordinate_step(coordinate_id id);
double coordinate_look(coordinate_id id, double z);

/* Between which z a coordinate is physical by itself; infinite where nothing bounds it. */
void coordinate_range(const coordinate_frame *f, coordinate_id id, double *low, double *high);

/*
 * All of R, L, psi_f, the voltages and what is measured by them scaled by a factor, iron's conductance by its inverse: nothing that a
 * recording shows changes but the ripple of the duties.
 */
void coordinates_scale(const coordinate_frame *f, double factor, double z[P_COUNT]);

/* Pulls z back to what is physical: R, L, psi > 0, a knee well below the rated current, gains of 0.6 to 1.6, a flux that
 * rises with the recorded currents. */
void coordinates_bound(const coordinate_frame *f, double z[P_COUNT]);

#endif
