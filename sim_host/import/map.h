/*
 * The map of a foreign log (interfaces.md, "Map of a foreign log"): which of its columns is what, in which
 * unit, and what it does not hold.
 */
#ifndef SIM_HOST_IMPORT_MAP_H
#define SIM_HOST_IMPORT_MAP_H

#include "data/pwm_updates.h"
#include "log_binary.h"
#include "quantity.h"

#include <stdio.h>

enum { MAP_NAME_SIZE = 128 };

/*
 * One entry of [columns]. scale * number + offset is the value in `unit`. Of an angle, `zero` is the value, in
 * its unit, at which theta_e is 0, and `per_turn` the counts of a turn.
 */
typedef struct map_column {
    bool there;
    char from[MAP_NAME_SIZE];
    double scale, offset;
    const quantity_unit *unit; /* of the quantity's dimension */
    double per_turn, zero;
    bool mechanical; /* angle and speed: to be multiplied by the pole pairs */
    double ahead;    /* u_d_V, u_q_V: cycles by which the angle they are turned with is ahead of theta_e */
    long line, at;   /* its line in the map's file; 0 if it was made here */
} map_column;

typedef struct map_pwm {
    bool there;           /* of duties in counts */
    double frame, centre; /* counts of a duty from 0 to 1; the count of a duty of 0.5 */
    bool inverted;
} map_pwm;

typedef struct import_map {
    const char *path; /* for messages; NULL if it was made here */
    log_format format;
    binary_format binary; /* type = "binary" */
    map_column column[QUANTITY_COUNT];
    map_pwm pwm;
    bool updates_stated; /* [pwm] or [sensors] say how commands reach the PWM */
    pwm_updates updates;
    double rate_Hz; /* of control cycles; 0: from t_s */
    long decimation, decimation_line;
    double shift_cycles; /* the command in row k acts from cycle k + shift_cycles on */
    bool has_fixed_u_dc, has_fixed_omega, has_fixed_theta;
    double u_dc_V, omega_e_rad_s, theta_e_rad;
} import_map;

/* A map without a column, all else as if absent. */
import_map map_blank(void);

/* A column as if written `key = "from"`. `from` is cut to what fits. */
void map_put(import_map *m, quantity q, const char *from, const char *unit_word);

/* Opens a log as the map says: text, or packed binary rows. */
bool map_open_log(const import_map *m, log_table *t, const char *path, error *e);

/* Reads and checks; on failure *e holds file, line, column and what was expected. */
bool map_read(const char *path, import_map *m, error *e);

/* The line of one column, or all of the map, as TOML. */
void map_print_column(FILE *out, const import_map *m, quantity q);
void map_print(FILE *out, const import_map *m);

#endif
