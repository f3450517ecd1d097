/*
 * Counts the instructions of a library's job (bench/peers/peer.h), and compares its duties with those in double precision.
 */
#include <math.h>

#include "console.h"
#include "counter_qemu.h"
#include "peer.h"

#ifndef PEER_INPUTS
#define PEER_INPUTS 4096
#endif

#define LSB    16777216.0
#define PI     3.14159265358979323846
#define ROOT_3 1.73205080756887729353

/* The coprocessor access register: full access to the FPU. */
#define CPACR     (*(volatile uint32_t *)0xE000ED88u)
#define CPACR_FPU (UINT32_C(0xF) << 20)

void peer_bare(void);
__asm(".text\n.globl peer_bare\n.type peer_bare, %function\n.thumb_func\npeer_bare: bx lr\n");

/* The same call of the job and of a bare return: the difference, and that one instruction, is the job's own. */
static __attribute__((noipa)) uint32_t ticks_job(void (*called)(void))
{
    const uint32_t before = counter_read();
    called();
    return counter_read() - before;
}

/* Marsaglia's xorshift with 13, 17, 5: even over -limit ... limit - 1, a power of two. */
static int32_t draw(int32_t limit)
{
    static uint32_t state = UINT32_C(20161219);
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return (int32_t)(state >> 5 & (uint32_t)(2 * limit - 1)) - limit;
}

typedef struct reference {
    double integral_d;
    double integral_q;
} reference_t;

static void reference_job(reference_t *state, int32_t i_a, int32_t i_b, int32_t theta, double duty[3])
{
    const double alpha = i_a / LSB;
    const double beta = (i_a + 2.0 * i_b) / LSB / ROOT_3;
    const double c = cos(2.0 * PI * (theta / LSB));
    const double s = sin(2.0 * PI * (theta / LSB));
    const double e_d = PEER_I_REF_D - (alpha * c + beta * s);
    const double e_q = PEER_I_REF_Q - (beta * c - alpha * s);
    const double u_d = PEER_KP * e_d + state->integral_d;
    const double u_q = PEER_KP * e_q + state->integral_q;
    state->integral_d += PEER_KI * e_d;
    state->integral_q += PEER_KI * e_q;
    const double x = (u_d * c - u_q * s) / PEER_U_DC;
    const double y = (u_d * s + u_q * c) / PEER_U_DC;
    const double phase[3] = {x, (ROOT_3 * y - x) / 2.0, (-ROOT_3 * y - x) / 2.0};
    const double high = fmax(phase[0], fmax(phase[1], phase[2]));
    const double low = fmin(phase[0], fmin(phase[1], phase[2]));
    for (int k = 0; k < 3; k++) {
        duty[k] = 0.5 + phase[k] - (high + low) / 2.0;
    }
}

static __attribute__((noinline)) int run(void)
{
    reference_t reference = {0.0, 0.0};
    uint32_t least = UINT32_MAX;
    uint32_t greatest = 0;
    uint32_t sum = 0;
    double error = 0.0;
    counter_start();
    peer_start();
    for (uint32_t k = 0; k < PEER_INPUTS; k++) {
        const int32_t i_a = draw(INT32_C(1) << 24);
        const int32_t i_b = draw(INT32_C(1) << 24);
        const int32_t theta = draw(INT32_C(1) << 23);
        double duty[3];
        double exact[3];
        peer_input(i_a, i_b, theta);
        const uint32_t bare = counter_units(ticks_job(peer_bare));
        const uint32_t units = counter_units(ticks_job(peer_job)) - bare + 1;
        least = units < least ? units : least;
        greatest = units > greatest ? units : greatest;
        sum += units;
        peer_duties(duty);
        reference_job(&reference, i_a, i_b, theta, exact);
        for (int phase = 0; phase < 3; phase++) {
            error = fmax(error, fabs(duty[phase] - exact[phase]));
        }
    }
    console_text("job ");
    console_unsigned(least);
    console_text(" ");
    console_unsigned(sum);
    console_text(" ");
    console_unsigned(greatest);
    console_text(" ");
    console_unsigned((uint32_t)fmin(error * LSB * 10.0 + 0.5, 4e9));
    console_text("\nend\n");
    return 0;
}

int main(void)
{
    CPACR |= CPACR_FPU;
    __asm volatile("dsb\n\tisb" ::: "memory");
    return run();
}
