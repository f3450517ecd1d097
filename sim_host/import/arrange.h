/*
 * Finds the meaning of a log's columns: polarity of the currents and of each phase, order of the phases, the
 * angle's direction and zero, a mechanical angle, inverted commands, the shift between command and current. All of
 * it is tried by the plain voltage equation; of what fits about as well as the best, the one with the fewest
 * changes is taken. A converter's zero that the map leaves in the currents is found first.
 */
#ifndef SIM_HOST_IMPORT_ARRANGE_H
#define SIM_HOST_IMPORT_ARRANGE_H

#include "diagnose/check/voltage_equation.h"

/* rad; an angle zero nearer than this is a matter of the diagnosis (angle_offset), not of the map. */
#define ARRANGE_ZERO_LEAST 0.15

/* What a log leaves to be tried: phases that were made of dq or line-to-line values have no order. */
typedef struct arrange_freedom {
    bool current_phases, voltage_phases, angle;
    int derived;   /* the phase whose current is not in the log, or VOLTAGE_NONE_DERIVED */
    int per_angle; /* pole pairs, if the angle may be a mechanical one; else 1 */
} arrange_freedom;

typedef struct arrangement {
    voltage_arrangement a; /* i_sign holds the reversal of all currents, too */
    bool inverted;         /* all commands reversed: inverted compare counts */
    double left;           /* share of the voltage's power that the equation leaves */
    bool negative;         /* the inductances that fit are negative */
    int changes;
    bool polarity_open; /* without a turning magnet: currents or commands are reversed */
} arrangement;

typedef struct arrange_result {
    double offset_A[3]; /* what a phase's column holds at no current; 0 where the log does not say */
    arrangement as_mapped, best;
    voltage_fit fit; /* of the best */
    size_t tried;
} arrange_result;

/* Takes the offsets that it finds from the recording's currents. */
arrange_result arrange_find(recording *rec, const arrange_freedom *f);

#endif
