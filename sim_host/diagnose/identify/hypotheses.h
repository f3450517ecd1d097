/*
 * The hypotheses: each cause as the directions in which it moves the coordinates, how common it is, and how
 * small it may be. The rows stand in data/causes.def.
 *
 * A cause may have several (which phase, which order, how many cycles); they exclude one another. Effects
 * without a name in interfaces.md have theirs too: they compete, so that no named cause is taken for them, but
 * are never named.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_HYPOTHESES_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_HYPOTHESES_H

#include "coordinates.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Directions in which more than one coordinate moves; the others are the coordinates themselves. */
enum {
    COLUMN_L = P_COUNT, /* both inductances alike */
    COLUMN_GAIN_A,      /* gain of sensor a against the two others, their mean kept */
    COLUMN_GAIN_BC,     /* gain of sensor b against c, their mean kept */
    COLUMN_COUNT,
    HYPOTHESIS_COLUMNS = 8,
    HYPOTHESIS_SHAPES = 3
};

typedef enum hypothesis_id {
#define HYPOTHESIS(H, ...) H,
#include "data/causes.def"
    H_COUNT
} hypothesis_id;

/* What is held against `least`. */
typedef enum hypothesis_measure {
    SIZE_LENGTH,     /* root sum square along its columns */
    SIZE_DIFFERENCE, /* of two columns: alike they are another cause */
    SIZE_LAST,       /* the last column: the others alone are another cause */
    SIZE_RATES, /* root sum square of the rates: a value that does not move is the same cause without them */
    SIZE_FROM_WHOLE, /* of the last column from the nearest whole number, which is another hypothesis */
    SIZE_BENDS,      /* all columns but the first two, which alone are a saliency */
    SIZE_SPREAD,     /* of the coordinates about their mean: three that are alike are another cause */
    SIZE_SENSORS     /* the same, but of two sensors what they share counts beside a difference */
} hypothesis_measure;

/* A simpler cause that lies inside: of those that hold the same, one may stand in a set. */
enum { HOLDS_RESISTANCE = 1, HOLDS_INDUCTANCE = 2, HOLDS_IRON = 8 };

/* What it scales or delays: some of these together move along a line on which nothing changes. */
enum {
    SCALES_RESISTANCE = 1,
    SCALES_INDUCTANCE = 2,
    SCALES_FLUX = 4,
    SCALES_VOLTAGE = 8,
    SCALES_CURRENT = 16,
    DELAYS_VOLTAGE = 32,
    DELAYS_A_SHARE = 64
};

/* What a recording must hold for it to be seen. */
typedef enum hypothesis_need {
    NEEDS_NOTHING,
    NEEDS_TURNING,
    NEEDS_POLES_ONCE, /* turning, and pole pairs enough that once per electrical turn is no other order */
    NEEDS_POLES_TWICE,
    NEEDS_MAGNET, /* turning, too */
    NEEDS_THREE_SENSORS,
    NEEDS_A_COUNT, /* of rows (measure/): no fit searches for it */
    NEEDS_TEMPERATURE
} hypothesis_need;

/* Which columns' sum has a sign. */
enum { SIGN_FIRST = 1, SIGN_LAST = 2 };

typedef struct hypothesis {
    cause_id cause;
    const char *words; /* for people */
    size_t columns;
    int column[HYPOTHESIS_COLUMNS]; /* directions that are fitted */
    size_t fixed;                   /* so many of them, the first, are not fitted but set to 1 */
    double surprise; /* what choosing it must pay beyond its parameters, in chi square: rarer causes more */
    /* The smallest size that is worth a name, in z: below it the motor file is right for every practical purpose,
     * and second-order effects of a real inverter (ripple, quantised duties) begin. */
    double least;
    hypothesis_measure size;
    unsigned holds; /* HOLDS_ */
    unsigned role;  /* SCALES_, DELAYS_ */
    hypothesis_need needs;
    unsigned positive; /* SIGN_: the sum of these columns is positive, */
    double most;       /* and at most this; 0: no bound */
    bool one_vector;   /* the columns are the parts of one vector, whose length is its size */
    /* Coordinates that shape its law: fitted with it once it stands, they say nothing of their own, and keep their
     * values when it goes. */
    size_t shapes;
    coordinate_id shape[HYPOTHESIS_SHAPES];
    bool silent;   /* fits so much that where it wins nothing is said of it */
    bool in_whole; /* fitted with the whole drive (whole_fit.h) */
    double loose;  /* share of its value that its law may be off by: an interval says no less */
} hypothesis;

extern const hypothesis hypothesis_table[H_COUNT];

/* The share of its effect to which a cause's law holds at an operating point, one standard deviation. */
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

/*
 * Whether a hypothesis may join a set: one entry per cause, none that contains another, and no three that
 * together move along a line on which nothing changes (all of R, L, psi and the voltage scaled alike; or all
 * voltages, fluxes and current sensors).
 */
bool hypothesis_joins(hypothesis_set set, hypothesis_id id);

/* Whether a's directions hold all of b's: then it fits as well by construction, which says nothing. */
bool hypothesis_contains(hypothesis_id a, hypothesis_id b);

/* How far z stands from the motor file along a hypothesis, in the measure of `least`. */
double hypothesis_size(hypothesis_id h, const double z[P_COUNT]);

/* The columns of which its size is the length; none, where that is another measure or not all of them are fitted. */
size_t hypothesis_length(hypothesis_id h, int column[HYPOTHESIS_COLUMNS]);

/* Whether every member of the set is large enough to be worth a name; of_least: as in coordinate_frame. */
bool hypotheses_count(hypothesis_set set, const double z[P_COUNT], double of_least);

/* True if every effect of the set with a fixed sign or bounded size is within its bound. */
bool hypotheses_physical(hypothesis_set set, const double z[P_COUNT]);

/*
 * How unusual the sizes are, as -2 log of a normal prior: it decides where the data cannot, between flux and
 * voltage gain beside a current gain, say, for the smaller deviations.
 */
double hypotheses_unusual(hypothesis_set set, const double z[P_COUNT]);

/* Moves z along a column. */
void column_move(int column, double by, double z[P_COUNT]);

/* Whether these rows can show a column at all. */
bool column_shows(int column, const diagnose_rows *r);

/* Whether it is a rate, per second, of another column's coordinate. */
bool column_is_rate(int column);

/* Where z stands along a column. */
double column_value(int column, const double z[P_COUNT]);

/* Sets the coordinates that a hypothesis moves to what `from` holds along its directions, and to nothing beside
 * them; from a z of nought, takes them back to the motor file's. */
void hypothesis_copy(hypothesis_id h, const double from[P_COUNT], double to[P_COUNT]);
extern const double hypothesis_nominal[P_COUNT];

/* Takes back to the motor file's what a hypothesis moves, but for the mean of both inductances. */
void hypothesis_leave_mean(hypothesis_id h, double z[P_COUNT]);

/* Whether one of its coordinates stands at a physical bound (coordinate_range). */
bool hypothesis_at_bound(const coordinate_frame *f, hypothesis_id h, const double z[P_COUNT]);

/* Marks the coordinates that a hypothesis moves; leaves the other marks as they are. */
void hypothesis_mark(hypothesis_id h, bool moved[P_COUNT]);

/* Which hypotheses this recording allows (needs temperature, a moving rotor, three sensors ...). */
hypothesis_set hypotheses_possible(const diagnose_rows *r, const coordinate_frame *f);

/* The set of all entries of a cause, and whether a set holds one of them. */
hypothesis_set hypotheses_of(cause_id cause);
bool hypotheses_hold(hypothesis_set set, cause_id cause);

/* Those of a set whose cause has a name in interfaces.md. */
hypothesis_set hypotheses_named(hypothesis_set set);

/* The hypotheses of a cause id; 0 if there is none of that name. */
hypothesis_set hypotheses_of_cause(const char *cause);

#endif
