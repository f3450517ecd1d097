// What operator new and an uncaught bad_alloc call (memory.h).
#include "memory.h"

#include "error.h"
#include "leftovers.h"

#include <exception>
#include <new>
#include <unistd.h>

extern "C" void memory_out(void)
{
    static const char line[] = "iqfoc: out of memory\n";
    leftovers_remove();
    if (write(STDERR_FILENO, line, sizeof line - 1) < 0) {
        // Nobody listens; the status says it too.
    }
    _exit(STATUS_FAILED);
}

extern "C" void memory_end_when_out(void)
{
    std::set_new_handler(memory_out);
    // Eigen's own allocations throw without asking the handler, and nothing here throws anything else.
    std::set_terminate(memory_out);
}
