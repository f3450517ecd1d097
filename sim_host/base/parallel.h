/*
 * Runs independent tasks on all cores.
 */
#ifndef SIM_HOST_BASE_PARALLEL_H
#define SIM_HOST_BASE_PARALLEL_H

#include <stddef.h>

enum { PARALLEL_MOST = 16 };

/* How many run at once: the cores that are online, at most PARALLEL_MOST; IQFOC_JOBS in the environment says less. */
size_t parallel_workers(void);

/*
 * Calls job(context, index, worker) for every index below `count`, in any order, `worker` below parallel_workers().
 * Pieces must not write where others read. Where no thread can be had, the caller does it all.
 */
void parallel_for(size_t count, void (*job)(void *context, size_t index, size_t worker), void *context);

#endif
