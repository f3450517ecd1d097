/* iqfoc patterns: optimal pulse patterns over the modulation index. */
#include "patterns/patterns.h"

#include "base/json_file.h"
#include "command.h"
#include "options.h"

#include <math.h>
#include <stdio.h>

typedef struct request {
    const char *motor_path, *directory, *json_path;
    size_t numbers;
    double pulses[PATTERNS_RESULTS_MOST];
    double on_time_us, dead_time_us, frequency_Hz;
} request;

static request asked = {.pulses = {7.0}, .numbers = 1};

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file: weights by its saliency, distortion of its rated current",
     .text = &asked.motor_path},
    {"pulses", 0, "N[,N...]", "pulses of a leg in a turn, odd, 3 to 15, rising; default 7",
     .number = asked.pulses, .count = &asked.numbers, .most = PATTERNS_RESULTS_MOST,
     .low = PATTERNS_PULSES_LEAST, .high = PATTERNS_PULSES_MOST},
    {"on-time-us", 0, "T", "least time between two edges of a leg at its output; default 0",
     .number = &asked.on_time_us, .low = 0.0, .high = 1000.0},
    {"dead-time-us", 0, "T", "dead time, added to that time; default 0", .number = &asked.dead_time_us,
     .low = 0.0, .high = 1000.0},
    {"frequency", 0, "HZ",
     "fundamental frequency at six-step, for these times; default: the motor's at its rated\n"
     "flux and nominal DC link",
     .number = &asked.frequency_Hz, .low = 0.1, .high = 1e5},
    {"output", 'o', "DIR", "write index.html and iqfoc_pattern.h, the angles in IQ24, into DIR",
     .text = &asked.directory},
    {"json", 0, "F", "write the patterns to file F; - is stdout, without the text", .text = &asked.json_path,
     .written = true},
    {.name = NULL}};

const command_about about_patterns = {
    "patterns",
    "[--motor M.toml] [--pulses N[,N...]] [--on-time-us T] [--dead-time-us T] [--frequency HZ]\n"
    "       [-o DIR] [--json F]",
    "Finds the switching angles of least current distortion with N pulses a turn, for modulation\n"
    "indices from 0.3 to 0.99 of six-step, and compares them with space vectors of as many pulses.",
    specs};

static bool usable(const options *o, const request *r, error *e)
{
    for (size_t n = 0; n < r->numbers; n++) {
        if (fmod(r->pulses[n], 2.0) != 1.0 || (n > 0 && r->pulses[n] <= r->pulses[n - 1])) {
            return error_input(e, NULL, 0, 0, "patterns: --pulses has %g; expected odd numbers, rising",
                               r->pulses[n]);
        }
    }
    if (r->on_time_us + r->dead_time_us > 0.0 && r->motor_path == NULL && !(r->frequency_Hz > 0.0)) {
        return error_input(e, NULL, 0, 0, "patterns: a least time needs --frequency HZ or --motor M.toml");
    }
    return options_at_most(o, 0, e);
}

static bool find_each(const request *r, const motor *m, patterns_result *result, error *e)
{
    bool ok = true;
    for (size_t n = 0; n < r->numbers && ok; n++) {
        const patterns_request wanted = {.m = m,
                                         .pulses = (int)r->pulses[n],
                                         .on_time_s = 1e-6 * r->on_time_us,
                                         .dead_time_s = 1e-6 * r->dead_time_us,
                                         .six_step_Hz = r->frequency_Hz};
        ok = patterns_find(&wanted, &result[n], e);
    }
    return ok;
}

static bool find(const request *r, error *e)
{
    motor m;
    patterns_result result[PATTERNS_RESULTS_MOST];
    if (r->motor_path != NULL && !motor_read(r->motor_path, &m, e)) {
        return false;
    }
    out_folder f = {0};
    bool ok =
        out_folder_open(&f, r->directory, e) && find_each(r, r->motor_path != NULL ? &m : NULL, result, e) &&
        (r->directory == NULL || (patterns_page(result, r->numbers, f.stage, e) &&
                                  patterns_header(result, r->numbers, f.stage, e))) &&
        json_file_place(&f, r->json_path, r->json_path != NULL ? patterns_json(result, r->numbers) : NULL, e);
    ok = out_folder_close(&f, ok, e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        patterns_print(result, r->numbers, stdout);
        if (r->directory != NULL) {
            printf("\n  page: %s/index.html, firmware's table: %s/iqfoc_pattern.h\n", r->directory,
                   r->directory);
        }
    }
    return ok;
}

int cmd_patterns(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_patterns, argc, argv);
    const bool ok = options_read(&o, &e) && (o.helped || (usable(&o, &asked, &e) && find(&asked, &e)));
    return ok ? STATUS_DONE : error_print(&e);
}
