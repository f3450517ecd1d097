/*
 * The rows of what stands beside and around the cycle.
 */
#ifndef BENCH_BESIDE_H
#define BENCH_BESIDE_H

/* Counts and prints them, in the order of bench/table.py. */
void bench_beside(void);

#endif
