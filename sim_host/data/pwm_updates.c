/* Commands on their way to the PWM (pwm_updates.h). */
#include "pwm_updates.h"

#include "../base/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const held_words[] = {"stator", "rotor"};
static const char *const shunt_words[] = {"three", "two_lowest"};

pwm_updates pwm_updates_read(toml_table *pwm, toml_table *sensors)
{
    pwm_updates p = pwm_updates_plain();
    if (pwm != NULL) {
        p.periods = (int)toml_integer_or(pwm, "periods_per_cycle", 1, PWM_UPDATES_MOST, 1);
        p.turned = toml_choice_or(pwm, "held", held_words, 2, 0) == 1;
        p.delay_cycles = toml_number_or(pwm, "delay_cycles", (toml_range){0.0, 0.99, false}, 0.0);
    }
    if (sensors != NULL) {
        p.two_lowest = toml_choice_or(sensors, "shunts", shunt_words, 2, 0) == 1;
    }
    return p;
}

static bool is_plain_pwm(const pwm_updates *p)
{
    return p->periods <= 1 && !p->turned && p->delay_cycles == 0.0;
}

void pwm_updates_print(FILE *out, const pwm_updates *p)
{
    char delay[NUMBER_TEXT_SIZE];
    number_text(p->delay_cycles, delay);
    if (!is_plain_pwm(p)) {
        fprintf(out, "\n[pwm]\nperiods_per_cycle = %d\nheld = \"%s\"\ndelay_cycles = %s\n", p->periods,
                held_words[p->turned ? 1 : 0], delay);
    }
    if (p->two_lowest) {
        fprintf(out, "\n[sensors]\nshunts = \"two_lowest\"\n");
    }
}

void pwm_updates_comment(const pwm_updates *p, char *text, size_t size)
{
    char delay[NUMBER_TEXT_SIZE];
    size_t used = 0;
    number_text(p->delay_cycles, delay);
    text[0] = '\0';
    if (!is_plain_pwm(p)) {
        const int n = snprintf(text, size, "[pwm] periods_per_cycle = %d, held = \"%s\", delay_cycles = %s\n",
                               p->periods, held_words[p->turned ? 1 : 0], delay);
        used = n > 0 ? (size_t)n : 0;
    }
    if (p->two_lowest && used < size) {
        (void)snprintf(text + used, size - used, "[sensors] shunts = \"two_lowest\"\n");
    } else if (p->pulses > 0) {
        (void)snprintf(text, size, "[control] modulation = \"pattern\", pulses = %d\n", p->pulses);
    }
}

/* "key = value" or "key = "value"" at *at, which goes past it and the comma behind it. */
static bool next_setting(const char **at, char key[32], char value[32])
{
    int used = 0;
    if (sscanf(*at, " %31[a-z_] = \"%31[^\"]\"%n", key, value, &used) == 2 && used > 0) {
        *at += used;
    } else if (sscanf(*at, " %31[a-z_] = %31[0-9.e+-]%n", key, value, &used) == 2 && used > 0) {
        *at += used;
    } else {
        return false;
    }
    *at += strspn(*at, ", ");
    return true;
}

/* A whole number from 1 to `most`; else 0 and false. */
static bool whole(double number, int most, int *to)
{
    *to = number >= 1.0 && number <= most ? (int)number : 0;
    return *to >= 1 && (double)*to == number;
}

static bool set(pwm_updates *p, const char *key, const char *value)
{
    double number = 0.0;
    const bool is_number = number_parse(value, strlen(value), &number) == NUMBER_OK;
    if (strcmp(key, "periods_per_cycle") == 0) {
        return whole(is_number ? number : 0.0, PWM_UPDATES_MOST, &p->periods);
    }
    if (strcmp(key, "delay_cycles") == 0) {
        p->delay_cycles = number;
        return is_number && number >= 0.0 && number < 1.0;
    }
    if (strcmp(key, "pulses") == 0) {
        return whole(is_number ? number : 0.0, PATTERN_PULSES_MOST, &p->pulses) &&
               p->pulses >= PATTERN_PULSES_LEAST && p->pulses % 2 != 0;
    }
    if (strcmp(key, "modulation") == 0) {
        return strcmp(value, "pattern") == 0;
    }
    const bool held = strcmp(key, "held") == 0;
    const char *const *words = held ? held_words : shunt_words;
    bool *flag = held ? &p->turned : &p->two_lowest;
    *flag = strcmp(value, words[1]) == 0;
    return (held || strcmp(key, "shunts") == 0) && (*flag || strcmp(value, words[0]) == 0);
}

/* The length of the table's name that a comment begins with, where more follows; else 0. */
static size_t table_at(const char *line, size_t length)
{
    static const char *const names[] = {"[pwm]", "[sensors]", "[control]"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const size_t head = strlen(names[k]);
        if (length > head && strncmp(line, names[k], head) == 0) {
            return head;
        }
    }
    return 0;
}

bool pwm_updates_take_comment(pwm_updates *p, const char *line, size_t length, bool *taken)
{
    char text[200];
    char key[32];
    char value[32];
    pwm_updates read = *p;
    *taken = false;
    while (length > 0 && (*line == ' ' || *line == '#')) {
        line++;
        length--;
    }
    while (length > 0 && strchr(" \r\n", line[length - 1]) != NULL) {
        length--;
    }
    const size_t head = table_at(line, length);
    if (head == 0) {
        return true;
    }
    if (length >= sizeof text) {
        return false;
    }
    memcpy(text, line, length);
    text[length] = '\0';
    const char *at = text + head;
    while (*at != '\0') {
        if (!next_setting(&at, key, value) || !set(&read, key, value)) {
            return false;
        }
    }
    *p = read;
    *taken = true;
    return true;
}

static void add(vec_ab *sum, vec_ab command, double share, double angle_rad)
{
    const double c = share * cos(angle_rad);
    const double s = share * sin(angle_rad);
    sum->alpha += c * command.alpha - s * command.beta;
    sum->beta += s * command.alpha + c * command.beta;
}

vec_ab pwm_updates_mean(const pwm_updates *p, vec_ab now, vec_ab before, double turn_rad)
{
    const double by = p->turned ? turn_rad : 0.0;
    const int periods = p->periods > 1 ? p->periods : 1;
    vec_ab sum = {0.0, 0.0};
    for (int j = 0; j < periods; j++) {
        const double from = (double)j / periods;
        const double to = (double)(j + 1) / periods;
        const double first = fmin(fmax(p->delay_cycles, from), to); /* when the new command comes */
        if (first > from) {
            add(&sum, before, first - from, by * (1.0 + from));
        }
        if (first < to) {
            add(&sum, now, to - first, by * first);
        }
    }
    return sum;
}

vec_ab pwm_updates_last(const pwm_updates *p, vec_ab command, double turn_rad)
{
    const int periods = p->periods > 1 ? p->periods : 1;
    const double at = fmax((double)(periods - 1) / periods, p->delay_cycles);
    vec_ab last = {0.0, 0.0};
    add(&last, command, 1.0, p->turned ? turn_rad * at : 0.0);
    return last;
}
