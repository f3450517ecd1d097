/*
 * The rows of the optional modules and the drive services.
 */
#ifndef BENCH_SERVICES_H
#define BENCH_SERVICES_H

/* Counts and prints them, in the order of bench/table.py. */
void bench_services(void);

#endif
