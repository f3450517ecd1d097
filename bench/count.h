/*
 * Counting of one function, for the benchmark's own sources.
 */
#ifndef BENCH_COUNT_H
#define BENCH_COUNT_H

#include "inputs.h"
#include "kernels.h"

#ifdef IQFOC_BENCH_DWT
#include "counter_dwt.h"
#elif defined IQFOC_BENCH_CYCLES
#include "counter_cycles.h"
#else
#include "counter_qemu.h"
#endif

/*
 * count_<name>: the units that one call of `function` takes. The call through a pointer whose value the
 * compiler cannot know is the same code for the function and for the bare return, whose type differs from it:
 * that is sound as bench_nothing is written in assembler and touches neither arguments nor result.
 */
#define COUNT(name, result, function, parameters, arguments)                                                 \
    typedef result(*name##_function) parameters;                                                             \
    static BENCH_APART uint32_t ticks_##name(name##_function called, const bench_input_t *in)                \
    {                                                                                                        \
        (void)in;                                                                                            \
        const uint32_t before = counter_read();                                                              \
        called arguments;                                                                                    \
        return counter_read() - before;                                                                      \
    }                                                                                                        \
    static uint32_t count_##name(const bench_input_t *in)                                                    \
    {                                                                                                        \
        const uint32_t bare = counter_units(ticks_##name((name##_function)bench_nothing, in));               \
        return counter_units(ticks_##name(function, in)) - bare + 1;                                         \
    }

/* Counts over all inputs, and prints the line of a row. */
void bench_report(const char *name, uint32_t (*count)(const bench_input_t *));

#endif
