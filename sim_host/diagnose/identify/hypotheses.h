/*
 * The hypotheses of a diagnosis. A hypothesis is a way in which a cause may act: the directions in which it moves the coordinates,
 * how common it is, and its reporting threshold. Their rows are in data/causes.def.
 *
 * A cause may have several hypotheses (which phase, which order, how many cycles), which exclude one another. Effects without a name
 * in interfaces.md have hypotheses too. They compete with the causes, so that no cause is named in their place, but they are never
 * named.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_HYPOTHESES_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_HYPOTHESES_H

#include "coordinates.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Columns in which more than one coordinate moves; the other columns are the coordinates themselves. */
enum {
    COLUMN_L = P_COUNT, /* both inductances by the same amount */
    COLUMN_GAIN_A,      /* gain of sensor a against the two others, their mean kept */
    COLUMN_GAIN_BC,     /* gain of sensor b against c, their mean kept */
    COLUMN_COUNT,
    HYPOTHESIS_COLUMNS = 8,
    HYPOTHESIS_SHAPES = 6
};

typedef enum hypothesis_id {
#define HYPOTHESIS(H, ...) H,
#include "data/causes.def"
    H_COUNT
} hypothesis_id;

/* How the size of a hypothesis is measured, to be compared with `least`. */
typedef enum hypothesis_measure {
    SIZE_LENGTH,     /* root sum square of its columns */
    SIZE_DIFFERENCE, /* difference of two columns: equal ones are another cause */
    SIZE_LAST,       /* the last column: without it, the others are another cause */
    SIZE_RATES,      /* root sum square of the rates; with constant values it is another hypothesis */
    SIZE_FROM_WHOLE, /* distance of the last column from a whole number, which is another hypothesis */
    SIZE_BENDS,      /* root sum square of all columns but the first two, which alone are a saliency */
    SIZE_SPREAD,     /* of the coordinates about their mean: three equal ones are another cause */
    SIZE_SENSORS     /* the same; of two sensors the common part counts too, if they differ */
} hypothesis_measure;

/* Hypotheses that share a HOLDS_ bit exclude one another: each contains the same simpler cause. */
enum { HOLDS_RESISTANCE = 1, HOLDS_INDUCTANCE = 2, HOLDS_IRON = 8 };

/* What a hypothesis scales or delays. Some of these together may change nothing that a recording shows (hypothesis_joins). */
enum {
    SCALES_RESISTANCE = 1,
    SCALES_INDUCTANCE = 2,
    SCALES_FLUX = 4,
    SCALES_VOLTAGE = 8,
    SCALES_CURRENT = 16,
    DELAYS_VOLTAGE = 32,
    DELAYS_A_SHARE = 64
};

/* What a recording must have to show the hypothesis. */
typedef enum hypothesis_need {
    NEEDS_NOTHING,
    NEEDS_TURNING,
    NEEDS_POLES_ONCE, /* turning, and over two pole pairs: once per electrical turn is an order of its own */
    NEEDS_POLES_TWICE,
    NEEDS_MAGNET, /* turning, and a magnet */
    NEEDS_THREE_SENSORS,
    NEEDS_A_COUNT, /* found by a count of rows (measure/), not by a fit */
    NEEDS_A_TRIAL, /* found by a fit that a search does not propose (weigh/map_choice.h) */
    NEEDS_TEMPERATURE
} hypothesis_need;

/* Columns whose sum has a known sign. */
enum { SIGN_FIRST = 1, SIGN_LAST = 2 };

typedef struct hypothesis {
    cause_id cause;
    const char *words; /* description in the report */
    size_t columns;
    int column[HYPOTHESIS_COLUMNS]; /* directions in which it moves the coordinates */
    size_t fixed;                   /* the first ones of them, which are set to 1 and not fitted */
    double surprise; /* price in chi square beyond that of its parameters; higher for rarer causes */
    /*
     * Reporting threshold, in z. Below it the motor file is right for practical purposes, and second-order effects of a real inverter
     * (ripple, quantised duties) begin.
     */
    double least;
    hypothesis_measure size;
    unsigned holds; /* HOLDS_ */
    unsigned role;  /* SCALES_, DELAYS_ */
    hypothesis_need needs;
    unsigned positive; /* SIGN_: the sum of these columns is positive, */
    double most;       /* and at most this; 0: no bound */
    bool one_vector;   /* the columns are the parts of one vector, whose length is its size */
    /*
     * Shape parameters of its model, such as a knee current. They are fitted together with the effect, mean nothing without it, and
     * keep their values when it is taken out.
     */
    size_t shapes;
    coordinate_id shape[HYPOTHESIS_SHAPES];
    size_t shape_of[HYPOTHESIS_SHAPES]; /* the column whose effect it shapes: the first one if not given */
    bool silent;                        /* fits many effects, so that it is not reported if it wins */
    bool in_whole;                      /* fitted with the whole drive (whole_fit.h) */
    double loose; /* model error as a share of the value: least half-width of its interval */
} hypothesis;

extern const hypothesis hypothesis_table[H_COUNT];

/* Model error of each cause at an operating point, as a share of its effect; one standard deviation. */
extern const double law_holds_to[CAUSE_COUNT];

static inline const cause_row *hypothesis_cause(hypothesis_id h)
{
    return &cause_table[hypothesis_table[h].cause];
}

/* A set of hypotheses as bits. */
typedef uint64_t hypothesis_set;
#define HYPOTHESIS_BIT(id) (UINT64_C(1) << (id))

static inline bool hypothesis_in(hypothesis_set set, hypothesis_id h)
{
    return (set & HYPOTHESIS_BIT(h)) != 0;
}

/* The first member of a set that has one. A loop over all: for (hypothesis_set rest = set; rest != 0; rest &= rest - 1). */
static inline hypothesis_id hypothesis_first(hypothesis_set set)
{
    return (hypothesis_id)__builtin_ctzll(set);
}

/* What one factor on the drive scales, while no current changes: R, inductance, psi_f, all voltages. */
enum { HYPOTHESES_SCALED = 4 };
extern const hypothesis_id hypotheses_scaled[HYPOTHESES_SCALED];

/* Whether a hypothesis is of one of these causes. */
bool hypothesis_is_scaled(hypothesis_id h);

/* Whether a set moves the size of one of these: of the inductance also as two inductances or a flux map, not by its fall alone. */
bool hypotheses_move_scaled(hypothesis_set set, size_t scaled);

/*
 * Whether a hypothesis may join a set. A set has one hypothesis per cause and none that contains another. It gets no roles that
 * together can change without any change of the recording: R, L, psi_f and voltage by one factor, or all voltages, fluxes and current
 * sensors. A set of the whole drive may have such roles already, as priors determine their size; then others join it as well.
 */
bool hypothesis_joins(hypothesis_set set, hypothesis_id id);

/* Whether a's directions include all of b's: then a fits at least as well by construction, which is no evidence. */
bool hypothesis_contains(hypothesis_id a, hypothesis_id b);

/* How far z is from the motor file along a hypothesis, measured by its `size`. */
double hypothesis_size(hypothesis_id h, const double z[P_COUNT]);

/*
 * Whether its size may be smaller than it is fitted. What is not fitted has none to doubt. A map of parts is tried only where much
 * saturates, and the parts' energies trade with the currents that shape them: their own intervals say nothing of what they take.
 */
static inline bool hypothesis_size_is_doubted(hypothesis_id h)
{
    return hypothesis_table[h].fixed < hypothesis_table[h].columns &&
           hypothesis_table[h].needs != NEEDS_A_TRIAL;
}

/*
 * The columns whose root sum square is its size; returns how many. 0: its size is another measure, or some of its columns are not
 * fitted.
 */
size_t hypothesis_length(hypothesis_id h, int column[HYPOTHESIS_COLUMNS]);

/* Whether every member of the set reaches its reporting threshold times of_least (coordinate_frame). */
bool hypotheses_count(hypothesis_set set, const double z[P_COUNT], double of_least);

/* True if every effect of the set with a fixed sign or bounded size is within its bound. */
bool hypotheses_physical(hypothesis_set set, const double z[P_COUNT]);

/*
 * How unusual the sizes are, as -2 log of a normal prior. Where the data cannot decide, such as between flux and voltage gain
 * together with a current gain, this prior decides for the smaller deviations.
 */
double hypotheses_unusual(hypothesis_set set, const double z[P_COUNT]);

/*
 * Whether an inductance that falls with the current differs from the motor file's one at every current up to the rated one, by its
 * reporting threshold times of_least or more.
 */
bool hypothesis_saturation_is_off(const double z[P_COUNT], double of_least);

/*
 * How many causes there are in a set beyond one a member, by their values: a saturation of an inductance that the motor file has at no
 * current, and three sensors whose gains have more in common than chance leaves of three errors.
 */
size_t hypotheses_more_causes(hypothesis_set set, const double z[P_COUNT], double of_least);

/* Moves z along a column. */
void column_move(int column, double by, double z[P_COUNT]);

/* Whether these rows can show a column at all. */
bool column_shows(int column, const diagnose_rows *r);

/* Whether a column is the rate, per second, of another column's coordinate. */
bool column_is_rate(int column);

/* The value of z along a column. */
double column_value(int column, const double z[P_COUNT]);

/*
 * Replaces the coordinates that a hypothesis moves: they get the part of `from` along its directions, and nothing outside these. With
 * hypothesis_nominal as `from` they return to the motor file's values.
 */
void hypothesis_copy(hypothesis_id h, const double from[P_COUNT], double to[P_COUNT]);
extern const double hypothesis_nominal[P_COUNT];

/* Returns what the hypotheses of a set move to the motor file's values. */
void hypotheses_leave(hypothesis_set set, double z[P_COUNT]);

/* Returns what a hypothesis moves to the motor file's values, but keeps the mean of both inductances. */
void hypothesis_leave_mean(hypothesis_id h, double z[P_COUNT]);

/* Whether one of its coordinates is at a physical bound (coordinate_range). */
bool hypothesis_at_bound(const coordinate_frame *f, hypothesis_id h, const double z[P_COUNT]);

/* Marks the coordinates that a hypothesis moves; leaves the other marks as they are. */
void hypothesis_mark(hypothesis_id h, bool moved[P_COUNT]);

/* The same of each member of a set. */
void hypotheses_mark(hypothesis_set set, bool moved[P_COUNT]);

/* Which hypotheses this recording allows (needs temperature, a moving rotor, three sensors ...). */
hypothesis_set hypotheses_possible(const diagnose_rows *r, const coordinate_frame *f);

/* The hypotheses of a cause: of one that is known when this is compiled, a constant. */
static inline hypothesis_set hypotheses_of(cause_id cause)
{
#define HYPOTHESIS(H, ID, ...) | (cause == CAUSE_##ID ? HYPOTHESIS_BIT(H) : 0)
    return 0
#include "data/causes.def"
        ;
}

/* Whether a set contains one of them. */
static inline bool hypotheses_hold(hypothesis_set set, cause_id cause)
{
    return (set & hypotheses_of(cause)) != 0;
}

/* The members of a set whose cause has a name in interfaces.md. */
hypothesis_set hypotheses_named(hypothesis_set set);

/* The hypotheses of the cause with this id; 0 if there is no such cause. */
hypothesis_set hypotheses_of_cause(const char *cause);

#endif
