/*
 * What a voltage that no cause accounts for may depend on: the stated dictionary of docs/diagnosis_reference.md, evaluated for
 * one control cycle. An entry is a number; a term is an entry times a fitted value, as a voltage along d or q.
 */
#ifndef SIM_HOST_DIAGNOSE_LEARN_DICTIONARY_H
#define SIM_HOST_DIAGNOSE_LEARN_DICTIONARY_H

#include "base/vector.h"

#include <stdbool.h>
#include <stddef.h>

/* Orders of the electrical angle have a cosine and a sine, of constant size and in proportion to the speed. */
enum { DICTIONARY_ORDERS = 12, DICTIONARY_MECHANICAL = 2 };

typedef enum dictionary_entry {
    ENTRY_ONE,
    ENTRY_I_D,
    ENTRY_I_Q,
    ENTRY_I_D_I_D,
    ENTRY_I_D_I_Q,
    ENTRY_I_Q_I_Q,
    ENTRY_OMEGA,
    ENTRY_OMEGA_I_D,
    ENTRY_OMEGA_I_Q,
    ENTRY_OMEGA_I_D_I_D,
    ENTRY_OMEGA_I_D_I_Q,
    ENTRY_OMEGA_I_Q_I_Q,
    ENTRY_U_D,
    ENTRY_U_Q,
    ENTRY_U_D_BEFORE,
    ENTRY_U_Q_BEFORE,
    ENTRY_SIGN_D,
    ENTRY_SIGN_Q,
    ENTRY_TIME,
    ENTRY_TEMPERATURE,
    ENTRY_MECHANICAL,
    ENTRY_ANGLE = ENTRY_MECHANICAL + 2 * DICTIONARY_MECHANICAL,
    ENTRY_SPEED_ANGLE = ENTRY_ANGLE + 2 * DICTIONARY_ORDERS,
    ENTRIES = ENTRY_SPEED_ANGLE + 2 * DICTIONARY_ORDERS
} dictionary_entry;

/* One cycle, in the frame of the rotor at mid-cycle. */
typedef struct learn_cycle {
    vec_rotor middle;     /* electrical angle */
    vec_rotor mechanical; /* the same instant; known only if mech_known */
    bool mech_known;
    double half_turn_rad; /* of the electrical angle, in half a cycle */
    double omega_rad_s;
    vec_dq i_A; /* at the cycle's start, as predicted from the sample before: free of that sample's noise */
    vec_dq u_V, u_before_V;          /* commanded for this cycle, and for the one before */
    double elapsed_s, temperature_K; /* from the recording's means */
} learn_cycle;

/* What the cosines and sines stand for is their mean over the cycle. */
void dictionary_at(const learn_cycle *c, double entry[ENTRIES]);

/* "cos(9 theta_e)" */
void dictionary_name(size_t entry, char *out, size_t size);

/* Of the value of a term: a voltage over the entry's own unit. */
const char *dictionary_unit(size_t entry);

/* "the rotor's angle (electrical order 9)" */
void dictionary_words(size_t entry, char *out, size_t size);

/* What a picture of a term has for its axis, and its unit; the angle for all orders. */
const char *dictionary_axis(size_t entry);

/* Where the cycle lies on that axis, and what the voltage there is to be divided by: 1, or, for what grows with the
 * speed, the speed. */
double dictionary_place(size_t entry, const learn_cycle *c, double *over);

/* The place is an angle, 0 to 360 degrees. */
bool dictionary_turns(size_t entry);

#endif
