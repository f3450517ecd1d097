/*
 * Prints the digests of golden vectors and closed loop. The same program on every machine and compiler;
 * tests/target/same_bits.sh compares what they print.
 */
#include "closed_loop.h"
#include "golden_vectors.h"

#include "iqfoc/cycle.h"

#ifdef IQFOC_ON_TARGET
#include "console.h"
#else
#include <inttypes.h>
#include <stdio.h>
static void console_text(const char *text)
{
    (void)fputs(text, stdout);
}
static void console_hex64(uint64_t number)
{
    (void)printf("%016" PRIx64, number);
}
static void console_unsigned(uint32_t number)
{
    (void)printf("%" PRIu32, number);
}
#endif

static void print(const char *name, uint64_t digest)
{
    console_text(name);
    console_text(" ");
    console_hex64(digest);
    console_text("\n");
}

int main(void)
{
    golden_vectors(print);
    const closed_loop_result_t run = closed_loop_run();
    print("closed_loop", run.digest);
    console_text("limited ");
    console_unsigned(run.limited);
    console_text("\nworst_error ");
    console_unsigned((uint32_t)run.worst_error);
    console_text("\n");
    /*
     * The run must have been one: nothing tripped or missed, some voltage shortened, the current at its reference:
     * within 2 % of the rated one (seen: see the test's log; the converters' step alone is 0.2 %).
     */
    const bool good = (run.status & ~IQFOC_STATUS_VOLTAGE_LIMIT) == 0 && run.limited > 100 &&
                      run.worst_error < IQ24(0.02) && run.worst_error > 0;
    console_text(good ? "end\n" : "the closed loop did not control\n");
    return good ? 0 : 1;
}
