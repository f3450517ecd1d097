/*
 * Numbers as text, both ways exact: the shortest decimal form that reads back to the same double, and strict
 * reading with a dot as the decimal mark whatever the locale.
 *
 * Implemented with C++17's std::to_chars and std::from_chars (number.cpp), which do just this, correctly
 * rounded, at about 50 ns a number; printf("%.17g") and strtod cost five to ten times that, follow the
 * locale, and print 0.1 as 0.10000000000000001.
 */
#ifndef SIM_HOST_BASE_NUMBER_H
#define SIM_HOST_BASE_NUMBER_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    NUMBER_TEXT_SIZE = 32 /* the longest, "-2.2250738585072014e-308", is 24 characters and a 0 */
};

typedef enum number_result {
    NUMBER_OK,
    NUMBER_EMPTY,
    NUMBER_NOT_A_NUMBER,     /* text that is no decimal number, or has something after it */
    NUMBER_NOT_FINITE,       /* nan, inf, infinity */
    NUMBER_NOT_REPRESENTABLE /* 1e999, 1e-999 */
} number_result;

/* Of a value in so many digits, for people, or "-" where it is none: standstill has no ratio of frequencies. Returns `text`. */
const char *number_or_dash(double value, int digits, char text[NUMBER_TEXT_SIZE]);

/* "3.1 %", or "not measured" where the value is no number. Returns `text`. */
const char *number_percent(double percent, char text[NUMBER_TEXT_SIZE]);

/* Writes the shortest text of a value, 0-terminated, and returns its length: also "nan", "inf", "-inf". */
size_t number_text(double value, char text[NUMBER_TEXT_SIZE]);

/* Reads exactly `length` bytes. *value is set only on NUMBER_OK. A leading + is allowed, spaces are not. */
number_result number_parse(const char *text, size_t length, double *value);

/* What number_parse missed, for a message: "is not a number", "is empty" ... */
const char *number_complaint(number_result result);

#ifdef __cplusplus
}
#endif

#endif
