/*
 * Serial line and end of the emulated RV32 (port/emulated/console.h).
 */
#include "console.h"

#include "virt.h"

void console_send(int32_t byte)
{
    while ((VIRT_UART_STATUS & VIRT_UART_STATUS_TX_EMPTY) == 0) {
    }
    VIRT_UART_DATA = (uint8_t)(byte & 0xFF);
}

int32_t console_receive(void)
{
    return (VIRT_UART_STATUS & VIRT_UART_STATUS_RECEIVED) == 0 ? -1 : VIRT_UART_DATA;
}

_Noreturn void console_exit(int32_t status)
{
    while ((VIRT_UART_STATUS & VIRT_UART_STATUS_TX_EMPTY) == 0) {
    }
    VIRT_TEST = status == 0 ? 0x5555 : 0x3333 | (uint32_t)status << 16;
    for (;;) {
    }
}
