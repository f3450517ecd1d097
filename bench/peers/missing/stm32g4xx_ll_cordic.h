/*
 * In place of ST's header of this name: the CORDIC's registers as memory, because the emulator has no CORDIC. A write and two reads take the
 * instructions that they take on the chip. The sine and cosine come from the test's own mathematics, rounded to Q31.
 */
#ifndef PEER_LL_CORDIC_H
#define PEER_LL_CORDIC_H

#include <stdint.h>

typedef struct peer_cordic {
    volatile uint32_t wdata;
    volatile uint32_t rdata[2]; /* the chip has one register, which gives the cosine first */
} peer_cordic_t;

static peer_cordic_t peer_cordic_registers;
#define CORDIC (&peer_cordic_registers)

#define __HAL_RCC_CORDIC_CLK_ENABLE() ((void)0)
#define LL_CORDIC_Config(...)         ((void)0)
#define LL_CORDIC_WriteData(c, x)     ((void)((c)->wdata = (uint32_t)(x)))
/* In the order of the text: cosine, sine. */
enum { peer_cordic_first = __COUNTER__ + 1 };
#define LL_CORDIC_ReadData(c) ((c)->rdata[(__COUNTER__ - peer_cordic_first) & 1])

#endif
