/* Calls in a simulator's process, which must not end when a C++ part (toml++) is out of memory. */
#ifndef SIM_HOST_FMU_FMU_GUARDED_H
#define SIM_HOST_FMU_FMU_GUARDED_H

#include "base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the call returns. If it throws std::bad_alloc: false with *e set; what it had allocated until then is lost. */
bool fmu_guarded(bool (*call)(void *context, error *e), void *context, error *e);

#ifdef __cplusplus
}
#endif

#endif
