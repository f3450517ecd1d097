/* Opening and reading the recorder's line (line.h). */
#define _DEFAULT_SOURCE /* cfmakeraw, B230400 and faster */
#include "line.h"

#include "../base/inputs.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

static bool speed_of(long baud, speed_t *speed)
{
    static const struct {
        long baud;
        speed_t speed;
    } speeds[] = {
        {9600, B9600},       {19200, B19200},     {38400, B38400},     {57600, B57600},
        {115200, B115200},   {230400, B230400},   {460800, B460800},   {500000, B500000},
        {921600, B921600},   {1000000, B1000000}, {1500000, B1500000}, {2000000, B2000000},
        {3000000, B3000000}, {4000000, B4000000},
    };
    for (size_t k = 0; k < sizeof speeds / sizeof speeds[0]; k++) {
        if (speeds[k].baud == baud) {
            *speed = speeds[k].speed;
            return true;
        }
    }
    return false;
}

static bool terminal_set(const line *l, long baud, error *e)
{
    struct termios settings;
    speed_t speed;
    if (!speed_of(baud, &speed)) {
        return error_input(e, NULL, 0, 0, "record: --baud %ld is no speed of this system's serial lines",
                           baud);
    }
    if (tcgetattr(l->file, &settings) != 0) {
        return error_failure(e, errno, "%s: its settings cannot be read", l->name);
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    if (cfsetspeed(&settings, speed) != 0 || tcsetattr(l->file, TCSANOW, &settings) != 0) {
        return error_failure(e, errno, "%s: cannot be set to %ld baud", l->name, baud);
    }
    return true;
}

static bool socket_open(line *l, error *e)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (strlen(l->name) >= sizeof address.sun_path) {
        return error_input(e, l->name, 0, 0, "the path is too long for a socket");
    }
    memcpy(address.sun_path, l->name, strlen(l->name));
    l->file = socket(AF_UNIX, SOCK_STREAM, 0);
    if (l->file < 0 || connect(l->file, (const struct sockaddr *)&address, sizeof address) != 0) {
        return error_input(e, l->name, 0, 0, "cannot be connected to: %s", strerror(errno));
    }
    return true;
}

bool line_open(line *l, const char *name, long baud, error *e)
{
    struct stat about;
    *l = (line){.name = name, .file = -1};
    if (stat(name, &about) != 0) {
        return error_input(e, name, 0, 0, "cannot be opened: %s", strerror(errno));
    }
    if (S_ISSOCK(about.st_mode)) {
        return socket_open(l, e);
    }
    if (S_ISDIR(about.st_mode)) {
        return error_input(e, name, 0, 0, "is a directory; expected a serial device, socket, pipe or file");
    }
    l->file = open(name, O_RDONLY | O_NOCTTY | O_NONBLOCK);
    if (l->file < 0) {
        return error_input(e, name, 0, 0, "cannot be opened: %s", strerror(errno));
    }
    if (!inputs_note(l->file, name, e)) {
        return false;
    }
    l->size = S_ISREG(about.st_mode) ? (long)about.st_size : 0;
    return isatty(l->file) == 0 || terminal_set(l, baud, e);
}

bool line_read(line *l, uint8_t *octets, size_t size, int wait_ms, size_t *count, bool *closed, error *e)
{
    struct pollfd wait = {.fd = l->file, .events = POLLIN};
    *count = 0;
    *closed = false;
    const int ready = poll(&wait, 1, wait_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR)) {
        return true;
    }
    const ssize_t got = ready < 0 ? -1 : read(l->file, octets, size);
    if (got >= 0) {
        *count = (size_t)got;
        *closed = got == 0;
        return true;
    }
    if (errno == EAGAIN || errno == EINTR) {
        return true;
    }
    /* A pseudo-terminal whose other end is gone says EIO, an unplugged adapter ENODEV or ENXIO. */
    if (errno == EIO || errno == ENODEV || errno == ENXIO || errno == ECONNRESET) {
        *closed = true;
        return true;
    }
    return error_failure(e, errno, "%s: cannot be read", l->name);
}

void line_close(line *l)
{
    if (l->file >= 0) {
        (void)close(l->file);
        l->file = -1;
    }
}
