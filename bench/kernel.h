/*
 * A user's kernel, counted by `./dev bench --core CORE --kernel FILE.c`.
 */
#ifndef BENCH_KERNEL_H
#define BENCH_KERNEL_H

#include "inputs.h"

/* Called once for each input; its instructions are counted. */
void bench_kernel(const bench_input_t *input);

#endif
