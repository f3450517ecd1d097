/*
 * What a dead time and a resistance can trade. Both take voltage against the current; where the recording shows
 * few levels of current, an inverter's on-resistance that the file does not know moves v_dead by several percent
 * and brings next to nothing, so that no search names it.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_RESISTANCE_TRADE_H
#define SIM_HOST_DIAGNOSE_TELL_RESISTANCE_TRADE_H

#include "diagnose/choose/session.h"
#include "diagnose/result.h"

/*
 * Beside a named dead time without a resistance: fits the resistance as well, widens the dead time's intervals to
 * what they would then be, and lists the resistance as what it is confused with where it would be off by what is
 * worth a name. False: out of memory.
 */
bool resistance_trade_tell(session *w, diagnosis *d);

#endif
