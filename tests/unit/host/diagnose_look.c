/* The diagnosis of a bench, and assertions about it (diagnose_look.h). */
#include "diagnose_look.h"

#include <string.h>
#include <unity.h>

diagnosis look(const bench *b, const char *skip)
{
    return look_without(b, skip ? hypotheses_of_cause(skip) : 0);
}

diagnosis look_without(const bench *b, hypothesis_set skip)
{
    motor file = bench_motor();
    recording r = bench_record(b);
    diagnosis d;
    error e = {0};
    diagnose_options options = {.skip = skip, .series = true};
    bool ok = diagnose(&d, &r, &file, &options, &e);
    TEST_ASSERT_TRUE_MESSAGE(ok, e.text);
    recording_free(&r);
    return d;
}

void holds(const diagnosis_cause *cause, const char *name, double truth)
{
    for (size_t k = 0; k < cause->parameters; k++) {
        const diagnosis_parameter *p = &cause->parameter[k];
        if (strcmp(p->name, name) == 0) {
            TEST_ASSERT_TRUE_MESSAGE(p->low <= truth && truth <= p->high, name);
            return;
        }
    }
    TEST_FAIL_MESSAGE(name);
}

void one_cause(const diagnosis *d, const char *id)
{
    TEST_ASSERT_EQUAL_size_t(1, d->causes);
    TEST_ASSERT_EQUAL_STRING(id, d->cause[0].id);
    TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d->verdict);
    TEST_ASSERT_TRUE(d->extended < 1.1 * d->noise_floor);
}
