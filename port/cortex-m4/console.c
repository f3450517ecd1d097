/*
 * Serial line and end of the emulated Cortex-M4 (port/emulated/console.h).
 */
#include "console.h"

#include "mps2_an386.h"
#include "semihost.h"

/* QEMU's line has no speed; any divisor that the UART accepts will do. */
#define BAUD_DIVISOR 16

static void uart_on(void)
{
    MPS2_UART0->bauddiv = BAUD_DIVISOR;
    MPS2_UART0->ctrl = MPS2_UART_CTRL_TX_ENABLE | MPS2_UART_CTRL_RX_ENABLE;
}

void console_send(int32_t byte)
{
    if (MPS2_UART0->ctrl == 0) {
        uart_on();
    }
    while ((MPS2_UART0->state & MPS2_UART_STATE_TX_FULL) != 0) {
    }
    MPS2_UART0->data = (uint32_t)byte & 0xFF;
}

int32_t console_receive(void)
{
    if (MPS2_UART0->ctrl == 0) {
        uart_on();
    }
    if ((MPS2_UART0->state & MPS2_UART_STATE_RX_FULL) == 0) {
        return -1;
    }
    return (int32_t)(MPS2_UART0->data & 0xFF);
}

/* The reason is "application exit", with a status. */
_Noreturn void console_exit(int32_t status)
{
    const uint32_t arguments[2] = {0x20026, (uint32_t)status};
    while ((MPS2_UART0->state & MPS2_UART_STATE_TX_FULL) != 0) {
    }
    for (;;) {
        (void)semihost_call(SEMIHOST_EXIT_EXTENDED, arguments);
    }
}
