/*
 * The quantities that a column of a foreign log can have: the keys of a map's [columns], and the units each may have.
 */
#ifndef SIM_HOST_IMPORT_QUANTITY_H
#define SIM_HOST_IMPORT_QUANTITY_H

#include <stdbool.h>
#include <stddef.h>

/* Groups of components lie together and in the order a b c, d q, alpha beta, ab bc ca: callers count on it. */
typedef enum quantity {
    QUANTITY_T,
    QUANTITY_RUN,
    QUANTITY_I_A,
    QUANTITY_I_B,
    QUANTITY_I_C,
    QUANTITY_I_D,
    QUANTITY_I_Q,
    QUANTITY_I_ALPHA,
    QUANTITY_I_BETA,
    QUANTITY_U_A,
    QUANTITY_U_B,
    QUANTITY_U_C,
    QUANTITY_U_D,
    QUANTITY_U_Q,
    QUANTITY_U_ALPHA,
    QUANTITY_U_BETA,
    QUANTITY_U_AB,
    QUANTITY_U_BC,
    QUANTITY_U_CA,
    QUANTITY_D_A,
    QUANTITY_D_B,
    QUANTITY_D_C,
    QUANTITY_U_DC,
    QUANTITY_THETA,
    QUANTITY_OMEGA,
    QUANTITY_MID_A,
    QUANTITY_MID_B,
    QUANTITY_MID_C,
    QUANTITY_THETA_MECH,
    QUANTITY_TEMP,
    QUANTITY_COUNT
} quantity;

typedef enum dimension {
    DIMENSION_NUMBER, /* runs: no unit */
    DIMENSION_TIME,
    DIMENSION_CURRENT,
    DIMENSION_VOLTAGE,
    DIMENSION_DUTY,
    DIMENSION_ANGLE,
    DIMENSION_SPEED,
    DIMENSION_TEMPERATURE
} dimension;

/* "i_a_A", as in a map and, where the recording has the column, in its header. */
const char *quantity_key(quantity q);

dimension quantity_dimension(quantity q);

/* The quantity of a key, or QUANTITY_COUNT. */
quantity quantity_find(const char *key);

/*
 * The units that a dimension may have, the recording's own first. Each is worth `factor` of the first; an
 * angle's "count" has the factor 0: how many make a turn, only the map knows.
 */
typedef struct quantity_unit {
    const char *word;
    double factor;
} quantity_unit;

const quantity_unit *quantity_units(dimension d, size_t *count);

/* The unit of a word among those of a dimension, or NULL. */
const quantity_unit *quantity_unit_find(dimension d, const char *word);

#endif
