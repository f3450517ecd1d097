/*
 * What a sketch of this tree uses of an Arduino core, on a machine that has none: main.cpp lets Serial write to the standard output.
 */
#ifndef ARDUINO_H
#define ARDUINO_H

struct serial {
    void begin(unsigned long baud);
    void print(const char *text);
    void print(long value);
    void println(long value);
};
extern serial Serial;

void delay(unsigned long milliseconds);

#endif
