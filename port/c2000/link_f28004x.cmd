/*
 * Memory of the F280049 (data sheet SPRS945, "Memory map"), in words of 16 bits: both banks of flash in one
 * piece, 128 Kwords; LS0 to LS4 for functions that run from RAM, LS5 to LS7 for variables, M1 for the stack.
 * The last words of flash, M1 and RAM are left free: the core prefetches beyond the last instruction (errata
 * SPRZ439).
 */
--entry_point=code_start
--stack_size=0x300

MEMORY
{
    BEGIN   : origin = 0x080000, length = 0x000002
    FLASH   : origin = 0x080002, length = 0x01FFEE
    STACK   : origin = 0x000400, length = 0x0003F8
    RAMCODE : origin = 0x008000, length = 0x002800
    RAMDATA : origin = 0x00A800, length = 0x001800
    RESET   : origin = 0x3FFFC0, length = 0x000002
}

SECTIONS
{
    codestart   : > BEGIN
    .text       : > FLASH, ALIGN(4)
    .cinit      : > FLASH, ALIGN(4)
    .const      : > FLASH, ALIGN(4)
    .switch     : > FLASH, ALIGN(4)
    .init_array : > FLASH, ALIGN(4)
    .binit      : > FLASH, ALIGN(4)
    .ovly       : > FLASH, ALIGN(4)
    /* Copied by the run-time library before variables are initialised. */
    .TI.ramfunc : LOAD = FLASH, RUN = RAMCODE, table(BINIT), ALIGN(4)
    .stack      : > STACK
    .bss        : > RAMDATA
    .data       : > RAMDATA
    .sysmem     : > RAMDATA
    .reset      : > RESET, TYPE = DSECT
}
