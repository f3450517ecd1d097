/* The table of hypotheses and what their columns move (hypotheses.h). */
#include "hypotheses.h"

#include <math.h>
#include <string.h>

#define LIST(...)  __VA_ARGS__
#define COUNT(...) (sizeof((const int[]){__VA_ARGS__}) / sizeof(int))

const hypothesis hypothesis_table[H_COUNT] = {
#define HYPOTHESIS(H, ID, text, list, ...)                                                                   \
    [H] = {.cause = CAUSE_##ID, .words = (text), .columns = COUNT list, .column = {LIST list}, __VA_ARGS__},
#include "data/causes.def"
};

const double law_holds_to[CAUSE_COUNT] = {
#define LAW_HOLDS(ID, share) [CAUSE_##ID] = (share),
#include "data/causes.def"
};

const hypothesis_id hypotheses_scaled[HYPOTHESES_SCALED] = {H_RESISTANCE, H_INDUCTANCE, H_FLUX,
                                                            H_VOLTAGE_GAIN};

/* All roles of a line together can change without any change of the recording. */
static const unsigned exclusive[][3] = {
    {DELAYS_VOLTAGE, DELAYS_A_SHARE},
    {SCALES_VOLTAGE, SCALES_FLUX, SCALES_INDUCTANCE},
    {SCALES_VOLTAGE, SCALES_FLUX, SCALES_CURRENT},
    {SCALES_VOLTAGE, SCALES_CURRENT, SCALES_INDUCTANCE},
    {SCALES_RESISTANCE, SCALES_CURRENT, SCALES_INDUCTANCE},
};

bool hypothesis_is_scaled(hypothesis_id h)
{
    bool scaled = false;
    for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
        scaled = scaled || hypothesis_table[hypotheses_scaled[k]].cause == hypothesis_table[h].cause;
    }
    return scaled;
}

bool hypotheses_move_scaled(hypothesis_set set, size_t scaled)
{
    const hypothesis_id h = hypotheses_scaled[scaled];
    return hypotheses_hold(set, hypothesis_table[h].cause) ||
           (h == H_INDUCTANCE &&
            (hypotheses_hold(set, CAUSE_SALIENCY) || hypotheses_hold(set, CAUSE_SATURATION_DQ)));
}

static bool hold_a_line(unsigned roles)
{
    bool hold = false;
    for (size_t k = 0; k < sizeof exclusive / sizeof *exclusive; k++) {
        const unsigned line = exclusive[k][0] | exclusive[k][1] | exclusive[k][2];
        hold = hold || (roles & line) == line;
    }
    return hold;
}

bool hypothesis_joins(hypothesis_set set, hypothesis_id id)
{
    const hypothesis *own = &hypothesis_table[id];
    unsigned roles = 0;
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        const hypothesis_id other = hypothesis_first(rest);
        const hypothesis *member = &hypothesis_table[other];
        if (other == id || member->cause == own->cause || (member->holds & own->holds) != 0) {
            return false;
        }
        roles |= member->role;
    }
    return hold_a_line(roles) || !hold_a_line(roles | own->role);
}

/* Whether a moves each coordinate that b moves. */
static bool moves_all_of(hypothesis_id a, hypothesis_id b)
{
    bool outer[P_COUNT] = {false};
    bool inner[P_COUNT] = {false};
    hypothesis_mark(a, outer);
    hypothesis_mark(b, inner);
    for (size_t k = 0; k < P_COUNT; k++) {
        if (inner[k] && !outer[k]) {
            return false;
        }
    }
    return true;
}

bool hypothesis_contains(hypothesis_id a, hypothesis_id b)
{
    const hypothesis *outer = &hypothesis_table[a];
    const hypothesis *inner = &hypothesis_table[b];
    if (outer->size == SIZE_BENDS) {
        /* The terms of a flux map include, to fourth order, an inductance that falls with the current. */
        return moves_all_of(a, b) || inner->cause == CAUSE_SATURATION;
    }
    /* The values of three phases include one of all. */
    return (outer->holds & inner->holds) != 0 &&
           ((inner->columns == 1 && outer->columns > 1) || moves_all_of(a, b));
}

/* Least difference of two gains that makes a mismatch, as a share of their root sum square. */
static const double LEAST_DIFFERENCE = 0.05;

/*
 * Size of a mismatch of two sensors; 0 if they are nearly equal. One gain common to all sensors is no mismatch: it is an R and an L
 * in another scale. Two sensors have no third to compare with, so the common part counts, but only if they differ.
 */
static double size_of_two(double a, double b)
{
    const double all = hypot(a, b);
    return fabs(a - b) >= LEAST_DIFFERENCE * all ? all : 0.0;
}

/* Distance of three values from one another: root sum square about their mean. */
static double spread(const double x[3])
{
    const double mean = (x[0] + x[1] + x[2]) / 3.0;
    double square = 0.0;
    for (int n = 0; n < 3; n++) {
        square += (x[n] - mean) * (x[n] - mean);
    }
    return sqrt(square);
}

/* The three coordinates that a hypothesis about phases moves, in their order. */
static void phases_of(hypothesis_id h, const double z[P_COUNT], double x[3])
{
    bool moved[P_COUNT] = {false};
    size_t n = 0;
    hypothesis_mark(h, moved);
    for (size_t k = 0; k < P_COUNT && n < 3; k++) {
        if (moved[k]) {
            x[n++] = z[k];
        }
    }
}

bool column_is_rate(int column)
{
    return column < P_COUNT && coordinate_table[column].rate;
}

double hypothesis_size(hypothesis_id h, const double z[P_COUNT])
{
    const hypothesis *hypo = &hypothesis_table[h];
    double at[HYPOTHESIS_COLUMNS] = {0.0};
    double square = 0.0;
    double rates = 0.0;
    double x[3] = {0.0};
    for (size_t k = 0; k < hypo->columns; k++) {
        at[k] = column_value(hypo->column[k], z);
        square += at[k] * at[k];
        rates += column_is_rate(hypo->column[k]) ? at[k] * at[k] : 0.0;
    }
    switch (hypo->size) {
    case SIZE_DIFFERENCE:
        return fabs(at[0] - at[1]);
    case SIZE_LAST:
        return (hypo->positive & SIGN_LAST) != 0 ? at[hypo->columns - 1] : fabs(at[hypo->columns - 1]);
    case SIZE_RATES:
        return sqrt(rates);
    case SIZE_FROM_WHOLE:
        return fabs(at[hypo->columns - 1] - round(at[hypo->columns - 1]));
    case SIZE_BENDS:
        return sqrt(fmax(square - at[0] * at[0] - at[1] * at[1], 0.0));
    case SIZE_SPREAD:
        phases_of(h, z, x);
        return spread(x);
    case SIZE_SENSORS:
        return at[2] == 0.0 ? size_of_two(at[0], at[1]) : spread(at);
    case SIZE_LENGTH:
    default:
        return sqrt(square);
    }
}

size_t hypothesis_length(hypothesis_id h, int column[HYPOTHESIS_COLUMNS])
{
    const hypothesis *hypo = &hypothesis_table[h];
    const bool is_length = hypo->size == SIZE_LENGTH || hypo->size == SIZE_BENDS || hypo->size == SIZE_RATES;
    size_t n = 0;
    for (size_t k = hypo->size == SIZE_BENDS ? 2 : 0; is_length && hypo->fixed == 0 && k < hypo->columns;
         k++) {
        if (hypo->size != SIZE_RATES || column_is_rate(hypo->column[k])) {
            column[n++] = hypo->column[k];
        }
    }
    return n;
}

bool hypotheses_count(hypothesis_set set, const double z[P_COUNT], double of_least)
{
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        const hypothesis_id h = hypothesis_first(rest);
        if (hypothesis_size(h, z) < of_least * hypothesis_table[h].least) {
            return false;
        }
    }
    return true;
}

bool hypotheses_physical(hypothesis_set set, const double z[P_COUNT])
{
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        const hypothesis *hypo = &hypothesis_table[hypothesis_first(rest)];
        double sum = 0.0;
        if (hypo->positive == 0) {
            continue;
        }
        sum += (hypo->positive & SIGN_FIRST) != 0 ? z[hypo->column[0]] : 0.0;
        sum += (hypo->positive & SIGN_LAST) != 0 ? z[hypo->column[hypo->columns - 1]] : 0.0;
        if (!(sum > 0.0) || (hypo->most > 0.0 && sum > hypo->most)) {
            return false;
        }
    }
    return true;
}

static const double USUAL_GAIN_OF_ALL = 0.02;

double hypotheses_unusual(hypothesis_set set, const double z[P_COUNT])
{
    double moved[P_COUNT] = {0.0};
    for (hypothesis_set rest = set; rest != 0; rest &= rest - 1) {
        hypothesis_copy(hypothesis_first(rest), z, moved);
    }
    if (hypothesis_in(set, H_INDUCTANCE) || hypothesis_in(set, H_SATURATION)) {
        moved[P_L_Q] = 0.0; /* both inductances move by the same amount: counted once */
    }
    double sum = 0.0;
    for (size_t id = 0; id < P_COUNT; id++) {
        const double usual = coordinate_table[id].usual;
        sum += moved[id] != 0.0 && usual > 0.0 ? moved[id] * moved[id] / (usual * usual) : 0.0;
    }
    if (moved[P_GAIN_C] != 0.0) {
        /* An error common to three sensors is rarer than one common to R and L. */
        double mean = (moved[P_GAIN_A] + moved[P_GAIN_B] + moved[P_GAIN_C]) / 3.0;
        sum += mean * mean / (USUAL_GAIN_OF_ALL * USUAL_GAIN_OF_ALL);
    }
    return sum;
}

bool hypothesis_saturation_is_off(const double z[P_COUNT], double of_least)
{
    const double at_none = column_value(COLUMN_L, z);
    const double at_rated = at_none - log1p(fmax(z[P_SATURATION], 0.0));
    const double off = fmax(at_rated, -at_none);
    return off > 0.0 && off >= of_least * hypothesis_table[H_INDUCTANCE].least;
}

/* Mean of three values over the deviation that they show, above which they have a part in common: t of 2 degrees of freedom, 0.95. */
static const double IN_COMMON = 4.303 / 1.732;

size_t hypotheses_more_causes(hypothesis_set set, const double z[P_COUNT], double of_least)
{
    const double gain[3] = {z[P_GAIN_A], z[P_GAIN_B], z[P_GAIN_C]};
    const double mean = fabs(gain[0] + gain[1] + gain[2]) / 3.0;
    const bool of_all = hypothesis_in(set, H_CURRENT_GAIN) && gain[2] != 0.0 &&
                        mean >= of_least * hypothesis_table[H_CURRENT_GAIN].least &&
                        mean > IN_COMMON * spread(gain) / sqrt(2.0);
    const bool is_off = hypothesis_in(set, H_SATURATION) && hypothesis_saturation_is_off(z, of_least);
    return (of_all ? 1U : 0U) + (is_off ? 1U : 0U);
}

/* A coordinate that a column moves, and its share of the step. The last of a list has share 0. */
typedef struct column_part {
    coordinate_id coordinate;
    double share;
} column_part;

enum { COLUMN_PARTS = 4 };

static const column_part joint[COLUMN_COUNT - P_COUNT][COLUMN_PARTS] = {
    [COLUMN_L - P_COUNT] = {{P_L_D, 1.0}, {P_L_Q, 1.0}},
    [COLUMN_GAIN_A - P_COUNT] = {{P_GAIN_A, 1.0}, {P_GAIN_B, -0.5}, {P_GAIN_C, -0.5}},
    [COLUMN_GAIN_BC - P_COUNT] = {{P_GAIN_B, 1.0}, {P_GAIN_C, -1.0}},
};

void column_move(int column, double by, double z[P_COUNT])
{
    if (column < P_COUNT) {
        z[column] += by;
        return;
    }
    for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
        z[part->coordinate] += by * part->share;
    }
}

/* Sets what a column moves to the motor file's values. */
static void column_clear(int column, double z[P_COUNT])
{
    if (column < P_COUNT) {
        z[column] = 0.0;
        return;
    }
    for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
        z[part->coordinate] = 0.0;
    }
}

double column_value(int column, const double z[P_COUNT])
{
    if (column < P_COUNT) {
        return z[column];
    }
    double along = 0.0;
    double length = 0.0;
    for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
        along += part->share * z[part->coordinate];
        length += part->share * part->share;
    }
    return along / length;
}

bool column_shows(int column, const diagnose_rows *r)
{
    return column >= P_COUNT || ((!coordinate_table[column].third_sensor || rows_show_three(r)) &&
                                 (!coordinate_table[column].of_noise || r->noise_shows));
}

const double hypothesis_nominal[P_COUNT] = {0.0};

void hypothesis_copy(hypothesis_id h, const double from[P_COUNT], double to[P_COUNT])
{
    const hypothesis *hypo = &hypothesis_table[h];
    for (size_t k = 0; k < hypo->columns; k++) {
        column_clear(hypo->column[k], to);
    }
    for (size_t k = 0; k < hypo->columns; k++) {
        column_move(hypo->column[k], column_value(hypo->column[k], from), to);
    }
}

void hypotheses_leave(hypothesis_set set, double z[P_COUNT])
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h)) {
            hypothesis_copy(h, hypothesis_nominal, z);
        }
    }
}

void hypothesis_leave_mean(hypothesis_id h, double z[P_COUNT])
{
    const double mean = 0.5 * (z[P_L_D] + z[P_L_Q]);
    hypothesis_copy(h, hypothesis_nominal, z);
    z[P_L_D] = z[P_L_Q] = mean;
}

bool hypothesis_at_bound(const coordinate_frame *f, hypothesis_id h, const double z[P_COUNT])
{
    bool moved[P_COUNT] = {false};
    bool at = false;
    hypothesis_mark(h, moved);
    for (coordinate_id id = 0; id < P_COUNT; id++) {
        double low;
        double high;
        coordinate_range(f, id, &low, &high);
        at = at || (moved[id] && z[id] != 0.0 && (z[id] <= low || z[id] >= high));
    }
    return at;
}

void hypothesis_mark(hypothesis_id h, bool moved[P_COUNT])
{
    for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
        const int column = hypothesis_table[h].column[k];
        if (column < P_COUNT) {
            moved[column] = true;
            continue;
        }
        for (const column_part *part = joint[column - P_COUNT]; part->share != 0.0; part++) {
            moved[part->coordinate] = true;
        }
    }
}

void hypotheses_mark(hypothesis_set set, bool moved[P_COUNT])
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h)) {
            hypothesis_mark(h, moved);
        }
    }
}

hypothesis_set hypotheses_possible(const diagnose_rows *r, const coordinate_frame *f)
{
    const bool turns = r->omega_max_rad_s * r->T_s > 1e-5;
    const bool there[] = {[NEEDS_NOTHING] = true,
                          [NEEDS_TURNING] = turns,
                          [NEEDS_POLES_ONCE] = turns && f->pole_pairs > 2,
                          [NEEDS_POLES_TWICE] = turns && f->pole_pairs > 1,
                          [NEEDS_MAGNET] = turns && f->nominal.psi_f_Wb != 0.0,
                          [NEEDS_THREE_SENSORS] = r->sensors == SENSORS_THREE,
                          [NEEDS_TEMPERATURE] = r->temperature_known};
    hypothesis_set all = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        all |= there[hypothesis_table[h].needs] ? HYPOTHESIS_BIT(h) : 0;
    }
    return all;
}

hypothesis_set hypotheses_named(hypothesis_set set)
{
    hypothesis_set named = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        named |= hypothesis_in(set, h) && hypothesis_cause(h)->named ? HYPOTHESIS_BIT(h) : 0;
    }
    return named;
}

hypothesis_set hypotheses_of_cause(const char *cause)
{
    hypothesis_set set = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_cause(h)->named && strcmp(hypothesis_cause(h)->id, cause) == 0) {
            set |= HYPOTHESIS_BIT(h);
        }
    }
    return set;
}
