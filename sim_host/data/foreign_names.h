/*
 * Column names of other programs, mapped to those of a recording: "Ia [mA]", "motor.foc.Iq_measured", "phase_current_a".
 */
#ifndef SIM_HOST_DATA_FOREIGN_NAMES_H
#define SIM_HOST_DATA_FOREIGN_NAMES_H

#include <stdbool.h>
#include <stddef.h>

typedef struct foreign_name {
    const char *key;  /* of a map's [columns]: "i_a_A", "i_q_A", "u_ab_V"; NULL: not known */
    const char *unit; /* "mA": from the name, or the usual unit of that program; NULL: unknown */
    bool mechanical;  /* the name says mechanical */
} foreign_name;

/* Looks a name up: case, points and underscores do not matter; a unit may follow, in brackets or not. */
foreign_name foreign_name_find(const char *name, size_t length);

/* A unit's word as this program spells it ("RPM" is "rpm", "1/min" too), or NULL. */
const char *foreign_unit_find(const char *word, size_t length);

#endif
