/*
 * The order of the writes to a bank of memory (fake_writes.h).
 */
#include "fake_writes.h"

#include <stdlib.h>

#define LENGTH 8192

typedef struct entry {
    const volatile void *reg;
    uint32_t value;
    uint32_t reads_before; /* since the start */
} entry_t;

static entry_t entries[LENGTH];
static int32_t entry_count;
static uint32_t read_count;

void fake_writes_begin(void)
{
    entry_count = 0;
    read_count = 0;
}

void fake_writes_note(const volatile void *reg, uint32_t value)
{
    if (entry_count == LENGTH) {
        abort();
    }
    const entry_t entry = {reg, value, read_count};
    entries[entry_count++] = entry;
}

void fake_writes_read(void)
{
    read_count++;
}

void fake_forget(void)
{
    entry_count = 0;
}

int32_t fake_first_write(const volatile void *reg, uint32_t mask, uint32_t value)
{
    for (int32_t k = 0; k < entry_count; k++) {
        if (entries[k].reg == reg && (entries[k].value & mask) == value) {
            return k;
        }
    }
    return -1;
}

int32_t fake_last_write(const volatile void *reg, uint32_t mask, uint32_t value)
{
    for (int32_t k = entry_count - 1; k >= 0; k--) {
        if (entries[k].reg == reg && (entries[k].value & mask) == value) {
            return k;
        }
    }
    return -1;
}

uint32_t fake_reads_between(int32_t from, int32_t to)
{
    return entries[to].reads_before - entries[from].reads_before;
}

bool fake_ever_set(const volatile void *reg, uint32_t bits)
{
    for (int32_t k = 0; k < entry_count; k++) {
        if (entries[k].reg == reg && (entries[k].value & bits) != 0) {
            return true;
        }
    }
    return false;
}
