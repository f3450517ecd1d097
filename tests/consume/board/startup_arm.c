/*
 * A user's start-up for any Cortex-M that QEMU's mps2 boards run: vector table, variables, main; then main's result
 * to whoever runs the emulator. memcpy and memset, which a C library would bring, are at the end.
 */
#include <stddef.h>
#include <stdint.h>

extern uint32_t link_stack_top, link_data_load, link_data_start, link_data_end, link_bss_start, link_bss_end;

int main(void);
void reset(void);
void *memcpy(void *to, const void *from, size_t size);
void *memset(void *to, int value, size_t size);

/* Semihosting: SYS_EXIT_EXTENDED with the status as an application's own. */
static void leave(uint32_t status)
{
    const uint32_t block[2] = {0x20026, status};
    register uint32_t operation __asm("r0") = 0x20;
    register const uint32_t *argument __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
    for (;;) {
    }
}

static void fault(void)
{
    leave(99);
}

void reset(void)
{
    const uint32_t *from = &link_data_load;
    for (volatile uint32_t *to = &link_data_start; to < &link_data_end; to++) {
        *to = *from++;
    }
    for (volatile uint32_t *to = &link_bss_start; to < &link_bss_end; to++) {
        *to = 0;
    }
    leave((uint32_t)main());
}

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {&link_stack_top, (void *)reset,
                                                                             (void *)fault, (void *)fault};

void *memcpy(void *to, const void *from, size_t size)
{
    volatile unsigned char *t = to;
    for (const unsigned char *f = from; size > 0; size--) {
        *t++ = *f++;
    }
    return to;
}

void *memset(void *to, int value, size_t size)
{
    for (volatile unsigned char *t = to; size > 0; size--) {
        *t++ = (unsigned char)value;
    }
    return to;
}

/* What clang calls in their place. */
void __aeabi_memcpy4(void *to, const void *from, size_t size);
void __aeabi_memcpy8(void *to, const void *from, size_t size);
void __aeabi_memclr4(void *to, size_t size);
void __aeabi_memclr8(void *to, size_t size);

void __aeabi_memcpy4(void *to, const void *from, size_t size)
{
    memcpy(to, from, size);
}

void __aeabi_memcpy8(void *to, const void *from, size_t size)
{
    memcpy(to, from, size);
}

void __aeabi_memclr4(void *to, size_t size)
{
    memset(to, 0, size);
}

void __aeabi_memclr8(void *to, size_t size)
{
    memset(to, 0, size);
}
