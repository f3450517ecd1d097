/*
 * A kernel of a user's own, counted by `./dev bench --core CORE --kernel FILE.c`.
 */
#ifndef BENCH_KERNEL_H
#define BENCH_KERNEL_H

#include "inputs.h"

/* What is counted, for each of the inputs. */
void bench_kernel(const bench_input_t *input);

#endif
