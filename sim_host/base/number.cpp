// The C++ standard library's number conversions behind the C interface of number.h; nothing here can throw.
#include "number.h"

#include <charconv>
#include <cmath>
#include <system_error>

extern "C" size_t number_text(double value, char text[NUMBER_TEXT_SIZE])
{
    const std::to_chars_result done = std::to_chars(text, text + NUMBER_TEXT_SIZE - 1, value);
    *done.ptr = '\0';
    return static_cast<size_t>(done.ptr - text);
}

extern "C" number_result number_parse(const char *text, size_t length, double *value)
{
    const char *first = text;
    const char *const end = text + length;
    if (first == end) {
        return NUMBER_EMPTY;
    }
    // from_chars knows no leading plus; "+-1" must not slip through as -1.
    if (*first == '+') {
        first++;
        if (first == end || *first == '-') {
            return NUMBER_NOT_A_NUMBER;
        }
    }
    double read = 0.0;
    const std::from_chars_result done = std::from_chars(first, end, read, std::chars_format::general);
    if (done.ec == std::errc::invalid_argument || done.ptr != end) {
        return NUMBER_NOT_A_NUMBER;
    }
    if (done.ec == std::errc::result_out_of_range) {
        return NUMBER_NOT_REPRESENTABLE;
    }
    if (!std::isfinite(read)) {
        return NUMBER_NOT_FINITE;
    }
    *value = read;
    return NUMBER_OK;
}

extern "C" const char *number_complaint(number_result result)
{
    switch (result) {
    case NUMBER_OK:
        return "is a number";
    case NUMBER_EMPTY:
        return "is empty";
    case NUMBER_NOT_A_NUMBER:
        return "is not a number";
    case NUMBER_NOT_FINITE:
        return "is not finite";
    case NUMBER_NOT_REPRESENTABLE:
        return "is too large or too small for a double";
    }
    return "is not a number";
}
