/*
 * The semihosting trap of a Cortex-M (port/emulated/semihost.h).
 */
#include "semihost.h"

intptr_t semihost_call(intptr_t operation, const void *arguments)
{
    register intptr_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = arguments;
    __asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}
