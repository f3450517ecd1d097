/*
 * The hypotheses: each cause of interfaces.md as the directions in which it moves the parameters, how common
 * it is, and how small it may be.
 *
 * A cause may have several entries (which phase, which order, how many cycles); they exclude one another. The
 * last entries are effects without a name in interfaces.md: they compete, so that no named cause is taken for
 * them, but are never named.
 */
#ifndef SIM_HOST_DIAGNOSE_HYPOTHESES_H
#define SIM_HOST_DIAGNOSE_HYPOTHESES_H

#include "parameters.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    COLUMN_L = P_COUNT, /* both inductances alike */
    COLUMN_GAIN_A,      /* gain of sensor a against the two others, their mean kept */
    COLUMN_GAIN_BC,     /* gain of sensor b against c, their mean kept */
    COLUMN_COUNT,
    HYPOTHESIS_COLUMNS = 3
};

typedef enum hypothesis_id {
    H_RESISTANCE,
    H_INDUCTANCE,
    H_FLUX,
    H_SALIENCY,
    H_SATURATION,
    H_DEAD_TIME,
    H_VOLTAGE_GAIN,
    H_CURRENT_OFFSET,
    H_CURRENT_GAIN,
    H_GAIN_MISMATCH,
    H_ANGLE_OFFSET,
    H_ANGLE_HARMONIC_1,
    H_ANGLE_HARMONIC_2,
    H_ANGLE_DELAY,
    H_VOLTAGE_DELAY_1,
    H_VOLTAGE_DELAY_2,
    H_EMF_HARMONICS,
    H_ASYMMETRY_A,
    H_ASYMMETRY_B,
    H_ASYMMETRY_C,
    H_ASYMMETRY,
    H_IRON_LOSS,
    H_EDDY,
    H_CROSS_SATURATION,
    H_EMF_HARMONICS_11,
    H_TEMPERATURE,
    H_LATE_SHARE,
    H_COUNT
} hypothesis_id;

typedef struct hypothesis {
    const char *cause; /* id of interfaces.md, or a description of an effect that is not named */
    const char *words; /* for people */
    bool named;
    size_t columns;
    int column[HYPOTHESIS_COLUMNS]; /* directions that are fitted */
    bool fixed;                     /* the one direction is not fitted but set to 1 */
    double surprise; /* what choosing it must pay beyond its parameters, in chi square: rarer causes more */
    double least;    /* the smallest norm of z that is worth a name */
} hypothesis;

extern const hypothesis hypothesis_table[H_COUNT];

/* A set of hypotheses as bits. */
typedef unsigned long hypothesis_set;
#define HYPOTHESIS_BIT(id) (1UL << (id))

/*
 * Whether a hypothesis may join a set: one entry per cause, none that contains another, and no three that
 * together move along a line on which nothing changes (all of R, L, psi and the voltage scaled alike; or all
 * voltages, fluxes and current sensors).
 */
bool hypothesis_joins(hypothesis_set set, hypothesis_id id);

/* How far z stands from the motor file along a hypothesis, in the measure of `least`. */
double hypothesis_size(hypothesis_id h, const double z[P_COUNT]);

/* Whether every member of the set is large enough to be worth a name. */
bool hypotheses_count(hypothesis_set set, const double z[P_COUNT]);

/*
 * How unusual the sizes are, as -2 log of a normal prior: it decides where the data cannot, between flux and
 * voltage gain beside a current gain, say, for the smaller deviations.
 */
double hypotheses_unusual(hypothesis_set set, const double z[P_COUNT]);

/* Moves z along a column. */
void column_move(int column, double by, double z[P_COUNT]);

/* Where z stands along a column. */
double column_value(int column, const double z[P_COUNT]);

/* Copies the parameters that a hypothesis moves; from a z of nought, takes them back to the motor file's. */
void hypothesis_copy(hypothesis_id h, const double from[P_COUNT], double to[P_COUNT]);
extern const double hypothesis_nominal[P_COUNT];

/* Which hypotheses this recording allows (needs temperature, a moving rotor, harmonics of a known revolution
 * ...). */
hypothesis_set hypotheses_possible(const diagnose_rows *r, const parameter_set *p);

/* The set of all entries of a cause id; 0 if there is none of that name. */
hypothesis_set hypotheses_of_cause(const char *cause);

#endif
