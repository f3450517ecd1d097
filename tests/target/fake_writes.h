/*
 * The order of the writes to a bank of memory in place of registers, and the reads in between.
 */
#ifndef TESTS_TARGET_FAKE_WRITES_H
#define TESTS_TARGET_FAKE_WRITES_H

#include <stdbool.h>
#include <stdint.h>

/* For a bank: from the start, and each access. Too many writes end the test. */
void fake_writes_begin(void);
void fake_writes_note(const volatile void *reg, uint32_t value);
void fake_writes_read(void);

/* Forgets the order of the writes so far: a firmware that runs would fill it. */
void fake_forget(void);

/*
 * Position in the order of all writes of the first (last) that set all of `mask` in reg to `value`; -1:
 * never.
 */
int32_t fake_first_write(const volatile void *reg, uint32_t mask, uint32_t value);
int32_t fake_last_write(const volatile void *reg, uint32_t mask, uint32_t value);

/* Reads of any register between two writes: time that passed. */
uint32_t fake_reads_between(int32_t from, int32_t to);

/* True if a write ever set one of these bits. */
bool fake_ever_set(const volatile void *reg, uint32_t bits);

#endif
