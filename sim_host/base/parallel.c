/* Threads that fetch the next piece until none is left (parallel.h). */
#include "parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct crew {
    atomic_size_t next;
    size_t count;
    void (*job)(void *context, size_t index, size_t worker);
    void *context;
} crew;

typedef struct hand {
    crew *crew;
    size_t worker;
} hand;

size_t parallel_workers(void)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    const char *said = getenv("IQFOC_JOBS");
    const long jobs = said ? strtol(said, NULL, 10) : 0;
    const long most = jobs > 0 && jobs < cores ? jobs : cores;
    return most < 1 ? 1 : most > PARALLEL_MOST ? PARALLEL_MOST : (size_t)most;
}

static void *work(void *argument)
{
    const hand *own = argument;
    crew *all = own->crew;
    for (size_t k = atomic_fetch_add(&all->next, 1); k < all->count; k = atomic_fetch_add(&all->next, 1)) {
        all->job(all->context, k, own->worker);
    }
    return NULL;
}

void parallel_for(size_t count, void (*job)(void *context, size_t index, size_t worker), void *context)
{
    crew all = {.count = count, .job = job, .context = context};
    hand hands[PARALLEL_MOST];
    pthread_t thread[PARALLEL_MOST];
    const size_t cores = parallel_workers();
    const size_t wanted = count < cores ? count : cores;
    size_t started = 0;
    atomic_init(&all.next, 0);
    for (size_t k = 1; k < wanted; k++) {
        hands[k] = (hand){&all, k};
        if (pthread_create(&thread[started], NULL, work, &hands[k]) != 0) {
            break;
        }
        started++;
    }
    hands[0] = (hand){&all, 0};
    work(&hands[0]);
    for (size_t k = 0; k < started; k++) {
        pthread_join(thread[k], NULL);
    }
}
