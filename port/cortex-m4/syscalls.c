/*
 * What newlib wants of a system: text goes out by the UART, and that is all. For test programs that print.
 */
#include "console.h"

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

int _write(int file, const char *data, int length);
int _read(int file, char *data, int length);
int _close(int file);
int _lseek(int file, int offset, int whence);
int _fstat(int file, struct stat *status);
int _isatty(int file);
int _kill(int process, int signal);
int _getpid(void);
void *_sbrk(ptrdiff_t increment);
_Noreturn void _exit(int status);

int _write(int file, const char *data, int length)
{
    (void)file;
    for (int k = 0; k < length; k++) {
        console_send(data[k]);
    }
    return length;
}

int _read(int file, char *data, int length)
{
    (void)file;
    (void)data;
    (void)length;
    return 0;
}

int _close(int file)
{
    (void)file;
    errno = EBADF;
    return -1;
}

int _lseek(int file, int offset, int whence)
{
    (void)file;
    (void)offset;
    (void)whence;
    errno = ESPIPE;
    return -1;
}

int _fstat(int file, struct stat *status)
{
    (void)file;
    status->st_mode = S_IFCHR;
    return 0;
}

int _isatty(int file)
{
    (void)file;
    return 1;
}

int _kill(int process, int signal)
{
    (void)process;
    console_exit(signal);
}

int _getpid(void)
{
    return 1;
}

/* A heap for printf's buffer. */
void *_sbrk(ptrdiff_t increment)
{
    static char heap[16384];
    static size_t used;
    if (increment < 0 || (size_t)increment > sizeof heap - used) {
        errno = ENOMEM;
        return (void *)-1;
    }
    void *const start = &heap[used];
    used += (size_t)increment;
    return start;
}

_Noreturn void _exit(int status)
{
    console_exit(status);
}
