/* Bad news, made and read by Python (interface.h). */
#include "base/error.h"

#include "interface.h"

#include <stdlib.h>

error *py_error_new(void)
{
    return calloc(1, sizeof(error));
}

void py_error_free(error *e)
{
    free(e);
}

int py_error_status(const error *e)
{
    return e->status;
}

const char *py_error_text(const error *e)
{
    return e->text;
}
