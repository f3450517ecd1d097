/* A JSON tree by its form (json.h). */
#include "json.h"

#include <stdarg.h>

typedef struct packer {
    const char *offset;
    va_list args;
    bool whole; /* no part was missing */
} packer;

static char next(packer *p)
{
    while (*p->offset == ' ' || *p->offset == ',' || *p->offset == ':') {
        p->offset++;
    }
    return *p->offset != '\0' ? *p->offset++ : '\0';
}

static json_t *packed(packer *p, char kind);

static json_t *packed_object(packer *p)
{
    json_t *object = json_object();
    for (char kind = next(p); kind == 's'; kind = next(p)) {
        const char *key = va_arg(p->args, const char *);
        json_t *value = packed(p, next(p));
        const bool may_miss = *p->offset == '*';
        p->offset += may_miss ? 1 : 0;
        if (value != NULL || !may_miss) {
            p->whole = json_object_set_new(object, key, value) == 0 && p->whole;
        }
    }
    return object;
}

static json_t *packed_array(packer *p)
{
    json_t *array = json_array();
    for (char kind = next(p); kind != ']' && kind != '\0'; kind = next(p)) {
        p->whole = json_array_append_new(array, packed(p, kind)) == 0 && p->whole;
    }
    return array;
}

static json_t *packed(packer *p, char kind)
{
    switch (kind) {
    case '{':
        return packed_object(p);
    case '[':
        return packed_array(p);
    case 's':
        return json_string(va_arg(p->args, const char *));
    case 'i':
        return json_integer(va_arg(p->args, int));
    case 'I':
        return json_integer(va_arg(p->args, json_int_t));
    case 'f':
        return json_real(va_arg(p->args, double));
    case 'b':
        return json_boolean(va_arg(p->args, int) != 0);
    case 'n':
        return json_null();
    case 'o':
        return va_arg(p->args, json_t *);
    default: /* no form that json.h knows */
        return NULL;
    }
}

json_t *json_pack(const char *form, ...)
{
    packer p = {.offset = form, .whole = true};
    va_start(p.args, form);
    json_t *value = packed(&p, next(&p));
    va_end(p.args);
    if (!p.whole) {
        json_free(value);
        return NULL;
    }
    return value;
}
