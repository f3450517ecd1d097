// Calls whose lack of memory is an error (fmu_guarded.h).
#include "fmu_guarded.h"

#include <new>

extern "C" bool fmu_guarded(bool (*call)(void *context, error *e), void *context, error *e)
{
    try {
        return call(context, e);
    } catch (const std::bad_alloc &) {
        *e = error{};
        return error_failure(e, 0, "out of memory");
    }
}
