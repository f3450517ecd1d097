/* Foreign logs: a map is proposed for any text, and the text with that map gives a recording or a refusal. */
#include "fuzz.h"
#include "import/convert.h"
#include "import/propose.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    error e = {0};
    log_table t;
    const log_format unknown = LOG_FORMAT_UNKNOWN;
    if (!log_table_open(&t, fuzz_file(data, size), &unknown, &e)) {
        fuzz_expect_refusal(&e);
        log_table_close(&t);
        return 0;
    }
    proposal p;
    propose_map(&t, &p);
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    propose_print(out, &t, &p);
    fclose(out);
    fuzz_expect(length > 0, "something is proposed");
    free(text);

    recording r;
    if (convert_log(&t, &p.map, NULL, &r, &e)) {
        fuzz_expect(r.rows > 0, "a recording has rows");
        recording_free(&r);
    } else {
        fuzz_expect_refusal(&e);
    }
    log_table_close(&t);
    return 0;
}
