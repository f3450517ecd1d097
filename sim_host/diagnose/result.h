/*
 * What a diagnosis found: everything that the terminal, the JSON file and the report show, as plain numbers.
 */
#ifndef SIM_HOST_DIAGNOSE_RESULT_H
#define SIM_HOST_DIAGNOSE_RESULT_H

#include "data/motor.h"
#include "data/recording.h"
#include "model/averaged_drive.h"
#include "plan/plan_pieces.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    DIAGNOSIS_CAUSES = 6,
    DIAGNOSIS_PARAMETERS = 8,
    DIAGNOSIS_CONFUSED = 6,
    DIAGNOSIS_TRADES = 3,
    DIAGNOSIS_GROUPS = 48,
    DIAGNOSIS_HYPOTHESES = 64,
    DIAGNOSIS_ESTIMATES = 6,
    DIAGNOSIS_FITTED = 24,
    DIAGNOSIS_LEARNED = 6,
    DIAGNOSIS_LEARNED_POINTS = 72
};

/* The verdict's tolerance over the noise floor, as interfaces.md defines it. */
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
    double gain;      /* error before it was added / after, held-out rows, causes in this order */
    double certainty; /* robust chi square of leaving it out */
    double probability;
    size_t trades; /* what together does the same to this recording: two or three causes, or none */
    const char *trade[DIAGNOSIS_TRADES];
    size_t confused;
    const char *confused_with[DIAGNOSIS_CONFUSED];
} diagnosis_cause;

/* What the recording says of a parameter, named or not. Where it is not excited the numbers say nothing. */
typedef struct diagnosis_estimate {
    const char *name, *unit;
    bool excited;
    double value, low, high; /* 95 % */
} diagnosis_estimate;

/* The machine's parameters and those of the causes, with what is known of them together. */
typedef struct diagnosis_covariance {
    size_t count;
    char name[DIAGNOSIS_FITTED][16], unit[DIAGNOSIS_FITTED][8];
    double value[DIAGNOSIS_FITTED][DIAGNOSIS_FITTED];
} diagnosis_covariance;

/* A row of the table of hypotheses: what each would do, alone and on top of what was named. */
typedef struct diagnosis_hypothesis {
    const char *id, *words;
    bool named, possible, skipped;
    double alone;  /* share of the nominal model's excess chi square that it takes off by itself, 0 ... 1 */
    double beyond; /* chi square it would still take off the extended model */
} diagnosis_hypothesis;

/* One operating point. Errors in percent of its current's rms. */
typedef struct diagnosis_run {
    long run;
    size_t rows;
    double omega_rad_s, i_rms_A, u_rms_V, i_d_A, i_q_A;
    double nominal, extended, noise_floor; /* one cycle, held-out rows */
    double free_nominal, free_extended;    /* free run from the start of each stretch, all rows */
} diagnosis_run;

/* One-cycle error by method with the same parameters, percent, held-out rows. */
typedef struct diagnosis_method {
    double euler, quasi_discrete, exact;
} diagnosis_method;

typedef struct diagnosis_structure {
    bool certain;
    double share;    /* of the extended model's innovation power */
    char words[256]; /* which order or frequency, which runs, how many glitches; empty if nothing */
} diagnosis_structure;

typedef struct diagnosis_learned_term {
    char name[48], unit[12]; /* "v_q: cos(9 theta_e)"; of the value */
    double value;
} diagnosis_learned_term;

/* Means over held-out rows: the voltage that the extended model leaves, and what the terms say of it. */
typedef struct diagnosis_learned_point {
    double x, left, learned;
    double weight;
    size_t rows;
} diagnosis_learned_point;

/* What is left, as a few terms of a dictionary. Nothing is named by it. */
typedef struct diagnosis_learned {
    size_t terms; /* 0: nothing was learned */
    diagnosis_learned_term term[DIAGNOSIS_LEARNED];
    double nominal, extended,
        gain;        /* percent, percent, 1: one cycle, held-out rows, without the terms and with */
    char words[512]; /* "what is left depends on ..." */
    char axis[64], voltage[32]; /* of the strongest term's picture */
    bool turns;                 /* that axis is an angle in degrees */
    size_t points;
    diagnosis_learned_point point[DIAGNOSIS_LEARNED_POINTS];
} diagnosis_learned;

/* A number that is open: one of a confused pair's, or one that is not excited. */
typedef struct diagnosis_open {
    const char *name, *unit;
    double value, half_width; /* by this recording, 95 % */
} diagnosis_open;

/* A piece, and what would be known once it was recorded beside this recording. */
typedef struct diagnosis_candidate {
    plan_piece piece;
    double half_width[DIAGNOSIS_ESTIMATES];
    double correlation; /* of a pair */
    double open;        /* what they are ranked by, the least first */
    bool enough;        /* nothing is open then */
} diagnosis_candidate;

typedef struct diagnosis_experiment {
    size_t numbers; /* 0: nothing is open, or no piece could tell */
    diagnosis_open number[DIAGNOSIS_ESTIMATES];
    const char *tell[2]; /* the two causes; NULL where numbers are not excited */
    double correlation;  /* of a pair, by this recording */
    double seconds;      /* of each */
    size_t candidates;
    diagnosis_candidate candidate[PLAN_PIECES];
} diagnosis_experiment;

typedef struct diagnosis {
    const char *recording_path, *motor_path; /* borrowed; for what is told */
    diagnosis_verdict verdict;
    size_t rows, rows_used, rows_held_out, outliers;
    size_t rows_clipped; /* a current sensor stands at the end of its range there: not used */
    size_t causes;
    diagnosis_cause cause[DIAGNOSIS_CAUSES];
    double nominal, extended, noise_floor, gain; /* percent, percent, percent, 1 */
    double sensor_noise_A;                       /* rms per phase */
    double within_digits; /* percent: the extended model with what may move unnamed as well */
    double free_nominal_percent, free_extended_percent; /* free run of all rows; NAN where it was lost */
    diagnosis_estimate estimate[DIAGNOSIS_ESTIMATES];
    diagnosis_covariance covariance;
    diagnosis_structure structure;
    diagnosis_learned learned; /* where the verdict is partly or unexplained */
    diagnosis_experiment experiment;
    char next_experiment[640];
    char sentence[512]; /* what is wrong, how sure, what it gains */
    size_t hypotheses;
    diagnosis_hypothesis hypothesis[DIAGNOSIS_HYPOTHESES];
    size_t runs;
    diagnosis_run run[DIAGNOSIS_GROUPS];
    diagnosis_method method_nominal, method_extended;
    motor extended_motor;
    averaged_drive nominal_drive, extended_drive;
    /* Series, one entry per row of the recording; NAN where there is no prediction. */
    vec_ab *error_nominal, *error_extended; /* A, one cycle */
    vec_ab *free_nominal, *free_extended;   /* A, free-running current */
    unsigned char *held_out;                /* 1: the row was not fitted */
} diagnosis;

void diagnosis_free(diagnosis *d);

const char *diagnosis_verdict_id(diagnosis_verdict v);

#endif
