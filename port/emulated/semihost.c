/*
 * The emulator's console by semihosting (semihost.h).
 */
#include "semihost.h"

/* fopen's modes as SYS_OPEN numbers them. */
#define MODE_READ  0
#define MODE_WRITE 4

/* ":tt" is the console: standard input or output, by the mode. */
static intptr_t opened(intptr_t mode)
{
    static const char console[] = ":tt";
    const struct {
        const char *name;
        intptr_t mode;
        intptr_t length;
    } arguments = {console, mode, 3};
    return semihost_call(SEMIHOST_OPEN, &arguments);
}

/* Both calls take a handle, a block and its length, and return how many bytes were left over. */
static uint32_t transfer(intptr_t operation, intptr_t handle, const void *block, uint32_t count)
{
    const struct {
        intptr_t handle;
        const void *block;
        uint32_t count;
    } arguments = {handle, block, count};
    return count - (uint32_t)semihost_call(operation, &arguments);
}

uint32_t semihost_receive(uint8_t *bytes, uint32_t count)
{
    static intptr_t handle;
    if (handle == 0) {
        handle = opened(MODE_READ);
    }
    return transfer(SEMIHOST_READ, handle, bytes, count);
}

void semihost_send(const uint8_t *bytes, uint32_t count)
{
    static intptr_t handle;
    if (handle == 0) {
        handle = opened(MODE_WRITE);
    }
    while (count > 0) {
        const uint32_t sent = transfer(SEMIHOST_WRITE, handle, bytes, count);
        bytes += sent;
        count -= sent;
    }
}
