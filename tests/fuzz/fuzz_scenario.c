/* Scenarios: accepted or refused in one line. */
#include "data/scenario.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    error e = {0};
    scenario s;
    if (scenario_read(fuzz_file(data, size), &s, &e)) {
        fuzz_expect(s.runs >= 1, "a scenario has a run");
        scenario_free(&s);
    } else {
        fuzz_expect_refusal(&e);
    }
    return 0;
}
