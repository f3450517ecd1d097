/*
 * An Arduino core's main, for one turn of the loop.
 */
#include "Arduino.h"

#include <cstdio>

void setup();
void loop();

serial Serial;

void serial::begin(unsigned long)
{
}

void serial::print(const char *text)
{
    std::printf("%s", text);
}

void serial::print(long value)
{
    std::printf("%ld", value);
}

void serial::println(long value)
{
    std::printf("%ld\n", value);
}

void delay(unsigned long)
{
}

int main()
{
    setup();
    loop();
    return 0;
}
