/*
 * The result of a diagnosis as plain numbers: all that terminal, JSON file and report page show.
 */
#ifndef SIM_HOST_DIAGNOSE_RESULT_H
#define SIM_HOST_DIAGNOSE_RESULT_H

#include "data/motor.h"
#include "data/plan_pieces.h"
#include "data/recording.h"
#include "model/averaged_drive.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    DIAGNOSIS_CAUSES = 12,
    DIAGNOSIS_MINORS = 16,
    DIAGNOSIS_DIRECTIONS = 4,
    DIAGNOSIS_EXPLANATIONS = 5,
    DIAGNOSIS_PARAMETERS = 16,
    DIAGNOSIS_CONFUSED = 6,
    DIAGNOSIS_TRADES = 3,
    DIAGNOSIS_ALIKE = 4,
    DIAGNOSIS_GROUPS = 48,
    DIAGNOSIS_HYPOTHESES = 64,
    DIAGNOSIS_ESTIMATES = 6,
    DIAGNOSIS_FITTED = 24,
    DIAGNOSIS_LEARNED = 6,
    DIAGNOSIS_LEARNED_POINTS = 72
};

/* The verdict's tolerance over the noise floor, as diagnosis_reference.md defines it. */
#define DIAGNOSIS_FLOOR_TOLERANCE 1.25

typedef enum diagnosis_verdict {
    VERDICT_CLEAN,
    VERDICT_EXPLAINED,
    VERDICT_PARTLY,
    VERDICT_UNEXPLAINED
} diagnosis_verdict;

typedef struct diagnosis_parameter {
    char name[16], unit[8];
    double nominal, value, low, high; /* 95 % */
} diagnosis_parameter;

typedef struct diagnosis_cause {
    const char *id;    /* of interfaces.md */
    const char *words; /* for people */
    size_t parameters;
    diagnosis_parameter parameter[DIAGNOSIS_PARAMETERS];
    double gain; /* held-out error before it was added / after, in this order; if below 1: as the last one */
    double certainty; /* robust chi square of leaving it out */
    double probability;
    size_t trades; /* causes that together have the same effect: two or three, or none */
    const char *trade[DIAGNOSIS_TRADES];
    size_t confused;
    const char *confused_with[DIAGNOSIS_CONFUSED];
} diagnosis_cause;

/* Estimate of a parameter, named as a cause or not. If it is not excited the numbers have no meaning. */
typedef struct diagnosis_estimate {
    const char *name, *unit;
    bool excited;
    double value, low, high; /* 95 % */
} diagnosis_estimate;

/* Covariance of the machine's parameters and those of the causes. */
typedef struct diagnosis_covariance {
    size_t count;
    char name[DIAGNOSIS_FITTED][16], unit[DIAGNOSIS_FITTED][8];
    double value[DIAGNOSIS_FITTED][DIAGNOSIS_FITTED];
} diagnosis_covariance;

/* A row of the table of hypotheses: effect of each, alone and in addition to the named causes. */
typedef struct diagnosis_hypothesis {
    const char *id, *words;
    bool named, possible, skipped;
    double alone;  /* share of the nominal model's excess chi square that it removes by itself, 0 ... 1 */
    double beyond; /* chi square that it would still remove from the extended model */
} diagnosis_hypothesis;

/* One operating point. Errors in percent of its current's rms. */
typedef struct diagnosis_run {
    long run;
    size_t rows;
    double omega_rad_s, i_rms_A, u_rms_V, i_d_A, i_q_A;
    double nominal, extended, noise_floor; /* one cycle, held-out rows */
    double free_nominal, free_extended;    /* open-loop simulation from the start of each stretch, all rows */
} diagnosis_run;

/* One-cycle error by method with the same parameters, percent, held-out rows. */
typedef struct diagnosis_method {
    double euler, quasi_discrete, exact;
} diagnosis_method;

typedef struct diagnosis_structure {
    bool certain;
    double share;    /* of the extended model's innovation power */
    char words[512]; /* which order or frequency, which runs, how many glitches; empty if nothing */
} diagnosis_structure;

typedef struct diagnosis_learned_term {
    char name[48], unit[12]; /* "v_q: cos(9 theta_e)"; of the value */
    double value;
} diagnosis_learned_term;

/* Means over held-out rows: residual voltage of the extended model, and the fitted terms. */
typedef struct diagnosis_learned_point {
    double x, left, learned;
    double weight;
    size_t rows;
} diagnosis_learned_point;

/* The residual as a few terms of a dictionary. They name no cause. */
typedef struct diagnosis_learned {
    size_t terms; /* 0: none was fitted */
    diagnosis_learned_term term[DIAGNOSIS_LEARNED];
    double nominal, extended,
        gain;        /* percent, percent, 1: one cycle, held-out rows, without the terms and with */
    char words[512]; /* "what is left depends on ..." */
    char axis[64], voltage[32]; /* of the strongest term's picture */
    bool turns;                 /* that axis is an angle in degrees */
    size_t points;
    diagnosis_learned_point point[DIAGNOSIS_LEARNED_POINTS];
} diagnosis_learned;

/* A number to determine: of a pair that is not distinguishable, or one that is not excited. */
typedef struct diagnosis_open {
    const char *name, *unit;
    double value, half_width; /* by this recording, 95 % */
} diagnosis_open;

/* A test segment, and the uncertainty after recording it in addition to this recording. */
typedef struct diagnosis_candidate {
    plan_piece piece;
    double half_width[DIAGNOSIS_ESTIMATES];
    double correlation; /* of a pair */
    double open;        /* rank: the smallest is the best */
    bool enough;        /* nothing is left to determine then */
} diagnosis_candidate;

typedef struct diagnosis_experiment {
    size_t numbers; /* 0: nothing to determine, or no segment could */
    diagnosis_open number[DIAGNOSIS_ESTIMATES];
    const char *tell[2]; /* the two causes; NULL if it is about numbers that are not excited */
    double correlation;  /* of a pair, by this recording */
    double seconds;      /* of each */
    size_t candidates;
    diagnosis_candidate candidate[PLAN_PIECES];
} diagnosis_experiment;

/* A direction of the machine's parameters that the recording does not determine: shares of the file's values, the largest 1. */
typedef struct diagnosis_direction {
    size_t count;
    const char *name[DIAGNOSIS_DIRECTIONS];
    double share[DIAGNOSIS_DIRECTIONS];
    char words[200];
} diagnosis_direction;

/* One of several sets of causes that explain the recording alike. */
typedef struct diagnosis_explanation {
    size_t count;
    const char *id[DIAGNOSIS_ALIKE];
    char words[96];     /* the ids, joined by " + " */
    double probability; /* among these */
} diagnosis_explanation;

typedef struct diagnosis {
    const char *recording_path, *motor_path; /* borrowed; for messages */
    diagnosis_verdict verdict;
    size_t rows, rows_used, rows_held_out, outliers;
    size_t rows_clipped; /* a current sensor is at the end of its range: not used */
    size_t causes;
    diagnosis_cause cause[DIAGNOSIS_CAUSES];
    size_t minors; /* fitted and certain, but small in size or share: in the extended model, no cause */
    diagnosis_cause minor[DIAGNOSIS_MINORS];
    double nominal, extended, noise_floor, gain; /* percent, percent, percent, 1 */
    double sensor_noise_A;                       /* rms per phase */
    double within_digits; /* percent: the extended model with all parameters free within their tolerance */
    double free_nominal_percent, free_extended_percent; /* open-loop error of all rows; NAN if it diverged */
    diagnosis_estimate estimate[DIAGNOSIS_ESTIMATES];
    bool reliable; /* the model is complete: estimates are as certain as they say */
    size_t directions;
    diagnosis_direction not_visible[DIAGNOSIS_DIRECTIONS];
    size_t explanations; /* 0: none, or one is named */
    diagnosis_explanation explanation[DIAGNOSIS_EXPLANATIONS];
    bool alike_by_scale; /* they differ by one factor on R, L, psi_f and all voltages */
    diagnosis_covariance covariance;
    diagnosis_structure structure;
    diagnosis_learned learned; /* where the verdict is partly or unexplained */
    diagnosis_experiment experiment;
    char next_experiment[640];
    char sentence[512]; /* causes, error before and after, noise floor */
    size_t hypotheses;
    diagnosis_hypothesis hypothesis[DIAGNOSIS_HYPOTHESES];
    size_t runs;
    diagnosis_run run[DIAGNOSIS_GROUPS];
    diagnosis_method method_nominal, method_extended;
    motor extended_motor;
    averaged_drive nominal_drive, extended_drive;
    /* Series, one entry per row of the recording; NAN where there is no prediction. */
    vec_ab *error_nominal, *error_extended; /* A, one cycle */
    vec_ab *free_nominal, *free_extended;   /* A, current of the open-loop simulation */
    unsigned char *held_out;                /* 1: the row was not fitted */
} diagnosis;

void diagnosis_free(diagnosis *d);

/* Whether an error in percent is that of the noise. */
static inline bool diagnosis_at_floor(const diagnosis *d, double percent)
{
    return percent <= DIAGNOSIS_FLOOR_TOLERANCE * d->noise_floor;
}

const char *diagnosis_verdict_id(diagnosis_verdict v);

#endif
