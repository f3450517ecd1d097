/*
 * Memory of the F28379D's first core (data sheet SPRS880, "Memory map"), in words of 16 bits: flash in one
 * piece, 256 Kwords; LS0 to LS4 for functions that run from RAM, GS0 to GS3 for variables, M1 for the stack.
 * The last words of flash and M1 are left free: the core prefetches beyond the last instruction (errata
 * SPRZ412). A part with less flash needs a shorter FLASH.
 */
--entry_point=code_start
--stack_size=0x300

MEMORY
{
    BEGIN   : origin = 0x080000, length = 0x000002
    FLASH   : origin = 0x080002, length = 0x03FFEE
    STACK   : origin = 0x000400, length = 0x0003F8
    RAMCODE : origin = 0x008000, length = 0x002800
    RAMDATA : origin = 0x00C000, length = 0x004000
    RESET   : origin = 0x3FFFC0, length = 0x000002
}

SECTIONS
{
    codestart   : > BEGIN
    .text       : > FLASH, ALIGN(8)
    .cinit      : > FLASH, ALIGN(8)
    .const      : > FLASH, ALIGN(8)
    .switch     : > FLASH, ALIGN(8)
    .init_array : > FLASH, ALIGN(8)
    .binit      : > FLASH, ALIGN(8)
    .ovly       : > FLASH, ALIGN(8)
    /* Copied by the run-time library before variables are initialised. */
    .TI.ramfunc : LOAD = FLASH, RUN = RAMCODE, table(BINIT), ALIGN(8)
    .stack      : > STACK
    .bss        : > RAMDATA
    .data       : > RAMDATA
    .sysmem     : > RAMDATA
    .reset      : > RESET, TYPE = DSECT
}
