/*
 * Uncertainty of a dead time from an unknown resistance. Both reduce the voltage against the current. If a recording has few levels of
 * current, an unknown on-resistance of the inverter changes v_dead by several percent with almost no error reduction, so no search names
 * it.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_RESISTANCE_TRADE_H
#define SIM_HOST_DIAGNOSE_TELL_RESISTANCE_TRADE_H

#include "diagnose/result.h"
#include "diagnose/session.h"

/*
 * For a named dead time without a resistance: fits the resistance as well, and widens the dead time's intervals accordingly. Lists the
 * resistance as not distinguishable if it would differ by more than its reporting threshold. False: out of memory.
 */
bool resistance_trade_tell(session *w, diagnosis *d);

#endif
