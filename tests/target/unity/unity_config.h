/*
 * Unity on an emulated board: text goes out by the UART.
 */
#ifndef TESTS_TARGET_UNITY_CONFIG_H
#define TESTS_TARGET_UNITY_CONFIG_H

#include "console.h"

#define UNITY_OUTPUT_CHAR(character) console_send(character)

#endif
