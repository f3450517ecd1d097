/*
 * How a command reaches the PWM, and how a drive reads its currents, where that is not once a control cycle and with three sensors.
 * The keys are in [pwm] and [sensors] of a motor file or an import map, and as one line each in the comments of a recording. A pulse pattern
 * is in [control] of a scenario and in those comments.
 */
#ifndef SIM_HOST_DATA_PWM_UPDATES_H
#define SIM_HOST_DATA_PWM_UPDATES_H

#include "../base/vector.h"
#include "toml_table.h"

#include <stdbool.h>
#include <stdio.h>

enum { PWM_UPDATES_MOST = 64, PATTERN_PULSES_LEAST = 3, PATTERN_PULSES_MOST = 15 };

typedef struct pwm_updates {
    int periods; /* PWM periods in a control cycle: the command is put out at the start of each; >= 1 */
    bool
        turned; /* held = "rotor": each time turned on by the speed; else it is constant in the stator frame */
    double
        delay_cycles; /* from the sample to the first update, 0 to < 1: until then the last command stays */
    bool
        two_lowest; /* shunts = "two_lowest": of three currents the two of the lower duties are measured, the third is minus their sum */
    int pulses; /* of a pulse pattern in a turn, in place of duties; 0: duties. Only in a scenario's [control] and in comments */
} pwm_updates;

/* Once a cycle, at its start, with three sensors: a zeroed struct says the same. */
static inline pwm_updates pwm_updates_plain(void)
{
    return (pwm_updates){.periods = 1};
}

static inline bool pwm_updates_is_plain(const pwm_updates *p)
{
    return p->periods <= 1 && !p->turned && p->delay_cycles == 0.0 && !p->two_lowest && p->pulses == 0;
}

/* From the tables [pwm] and [sensors]; either may be NULL. */
pwm_updates pwm_updates_read(toml_table *pwm, toml_table *sensors);

/* Both tables as TOML; nothing where all is plain. */
void pwm_updates_print(FILE *out, const pwm_updates *p);

/* As comment lines of a recording, each ended by a line end: "[pwm] periods_per_cycle = 8, held = "rotor", delay_cycles = 0.04". */
void pwm_updates_comment(const pwm_updates *p, char *text, size_t size);

/* Takes a comment line, without its '#', if it is one of these. False: it is, and is no such line; then *p is as it was. */
bool pwm_updates_take_comment(pwm_updates *p, const char *line, size_t length, bool *taken);

/*
 * The mean voltage of a cycle in the stator's frame. `now`: its command, in the stator's frame at the sample; `before`: that of the
 * cycle before, at the sample then; by turn_rad the rotor turns in a cycle.
 *
 *     u = sum over the updates j of (share of the cycle) command e^{j turn_rad t_j}
 *
 * with t_j, in cycles since the command's sample, the time at which it was put out.
 */
vec_ab pwm_updates_mean(const pwm_updates *p, vec_ab now, vec_ab before, double turn_rad);

/* The command that the legs have when its cycle ends, in the stator's frame at its sample; as above. */
vec_ab pwm_updates_last(const pwm_updates *p, vec_ab command, double turn_rad);

#endif
