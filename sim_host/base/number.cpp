// The C++ standard library's number conversions behind the C interface of number.h; nothing here can throw.
#include "number.h"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

extern "C" const char *number_or_dash(double value, int digits, char text[NUMBER_TEXT_SIZE])
{
    if (std::isfinite(value)) {
        std::snprintf(text, NUMBER_TEXT_SIZE, "%.*g", digits, value);
    } else {
        std::strcpy(text, "-");
    }
    return text;
}

extern "C" const char *number_percent(double percent, char text[NUMBER_TEXT_SIZE])
{
    if (std::isfinite(percent)) {
        std::snprintf(text, NUMBER_TEXT_SIZE, "%.3g %%", percent);
    } else {
        std::strcpy(text, "not measured");
    }
    return text;
}

extern "C" size_t number_text(double value, char text[NUMBER_TEXT_SIZE])
{
    const std::to_chars_result done = std::to_chars(text, text + NUMBER_TEXT_SIZE - 1, value);
    *done.ptr = '\0';
    return static_cast<size_t>(done.ptr - text);
}

#ifdef __cpp_lib_to_chars
static std::errc read_decimal(const char *first, const char *end, double &read, const char *&rest)
{
    const std::from_chars_result done = std::from_chars(first, end, read, std::chars_format::general);
    rest = done.ptr;
    return done.ec;
}
#else
// libc++ 14, which WebAssembly is built with, prints doubles but does not read them. Its strtod is correctly rounded and
// knows no locale; it takes more than a decimal number, and wants a 0 at the end.
static std::errc read_decimal(const char *first, const char *end, double &read, const char *&rest)
{
    const size_t length = static_cast<size_t>(end - first);
    const char *const bare = first + (*first == '-' ? 1 : 0);
    const bool is_hex = end - bare > 1 && bare[0] == '0' && (bare[1] | 0x20) == 'x';
    if (bare == end || is_hex || std::strchr("+- \t\n\v\f\r", *bare) != nullptr) {
        return std::errc::invalid_argument;
    }
    const std::string text(first, length);
    char *stop = nullptr;
    errno = 0;
    read = std::strtod(text.c_str(), &stop);
    rest = first + (stop - text.c_str());
    if (rest == first) {
        return std::errc::invalid_argument;
    }
    // Subnormal numbers set errno as well.
    const bool has_left = errno == ERANGE && (std::isinf(read) || read == 0.0);
    return has_left ? std::errc::result_out_of_range : std::errc();
}
#endif

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
    const char *rest = first;
    const std::errc code = read_decimal(first, end, read, rest);
    if (code == std::errc::invalid_argument || rest != end) {
        return NUMBER_NOT_A_NUMBER;
    }
    if (code == std::errc::result_out_of_range) {
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
