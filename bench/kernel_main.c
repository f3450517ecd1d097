/*
 * Counts the instructions of a user's kernel (bench/kernel.h), from entry to return.
 */
#include "console.h"
#include "counter_qemu.h"
#include "kernel.h"

/* Called once as the kernel and once as a bare return from the same place: the difference, and that one instruction, is the kernel's own. */
static __attribute__((noipa)) uint32_t ticks_of(void (*called)(const bench_input_t *),
                                                const bench_input_t *input)
{
    const uint32_t before = counter_read();
    called(input);
    return counter_read() - before;
}

void bench_bare(const bench_input_t *input);
__asm(".text\n.globl bench_bare\n.type bench_bare, %function\n"
#ifdef __arm__
      ".thumb_func\nbench_bare: bx lr\n"
#else
      "bench_bare: ret\n"
#endif
);

int main(void)
{
    static bench_input_t input;
    uint32_t least = UINT32_MAX;
    uint32_t greatest = 0;
    uint32_t sum = 0;
    counter_start();
    bench_input_restart();
    for (uint32_t k = 0; k < BENCH_INPUT_COUNT; k++) {
        bench_input_draw(&input);
        const uint32_t bare = counter_units(ticks_of(bench_bare, &input));
        const uint32_t units = counter_units(ticks_of(bench_kernel, &input)) - bare + 1;
        least = units < least ? units : least;
        greatest = units > greatest ? units : greatest;
        sum += units;
    }
    console_text("bench_kernel ");
    console_unsigned(least);
    console_text(" ");
    console_unsigned(sum);
    console_text(" ");
    console_unsigned(greatest);
    console_text("\nend\n");
    return 0;
}
