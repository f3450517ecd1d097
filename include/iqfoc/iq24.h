/*
 * IQ24: the library's number, and its elementary arithmetic.
 *
 * An iq24_t is a signed 32-bit integer that stands for integer / 2^24 (Q7.24): -128 ... +127.99999994 in
 * steps of 2^-24 = 5.96e-8, called one LSB here and in every error bound of the library. Angles are in turns,
 * so that one turn is 2^24 and a wrap is a mask.
 *
 * Suffixes say what happens out of range: _wrap keeps the low 32 bits (two's complement), _sat stops at IQ24_MAX or
 * IQ24_MIN. No function here has undefined behaviour for any argument within its stated precondition; without a
 * stated precondition, for any argument at all.
 *
 * Wrapping is done by computing the exact value in 64 bits and cutting it in iq24_wrap(), never by letting a
 * 32-bit operation overflow. Compilers for 32-bit cores reduce that to the one 32-bit instruction, and
 * clang -fsanitize=undefined,integer has nothing to report.
 *
 * C99 leaves two things to the compiler: the bits that shift into a negative number from the left, and the result of
 * converting a value that does not fit a signed type. Nothing here depends on either. Only iq24_asr32, iq24_asr64 and
 * iq24_wrap do these operations, in well-defined steps, at no cost: with gcc 12.2 (-O1, -O2, -Os, -O3) and clang 14
 * (-O2) for Cortex-M4 and RV32IM, every function of IQ24 has as many instructions as with a plain >> and a plain
 * cast. Exact-width types are two's complement by definition, so that ^ and ~ are safe on them.
 */
#ifndef IQFOC_IQ24_H
#define IQFOC_IQ24_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>

/*
 * The target's own implementation of the hooks below: the compiler says what it targets, and iqfoc/target/ has a
 * header for it. A header of your own instead: -DIQFOC_TARGET_HEADER='"my_dsp.h"'; that defines the hooks it has and
 * leaves the others.
 */
#ifdef IQFOC_TARGET_HEADER
#include IQFOC_TARGET_HEADER
#else
#include "target/choose.h"
#endif

/*
 * IQ24() folds constants of type double. If double has only the 24-bit mantissa of a float, every constant would
 * silently change: such a compiler is refused here.
 */
#if DBL_MANT_DIG < 53
#error                                                                                                       \
    "iqfoc: double has less than 53 bits on this target, so that IQ24(x) would be wrong; compile with 64-bit double (avr-gcc 10 and later: -mdouble=64; TI C28x: --abi=eabi)"
#endif
#define IQ24_ASSUME_TEXT_                                                                                    \
    "iqfoc: constants like 0.1 have type float here, so that IQ24(x) would be wrong; compile without "       \
    "-fsingle-precision-constant"
#if defined(__cplusplus)
static_assert(sizeof(0.1) > sizeof(0.1F), IQ24_ASSUME_TEXT_);
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
_Static_assert(sizeof(0.1) > sizeof(0.1F), IQ24_ASSUME_TEXT_);
#else
/* C99 has no static assertion but an array of invalid size. */
typedef char iq24_assume_compiled_without_fsingle_precision_constant[sizeof(0.1) > sizeof(0.1F) ? 1 : -1];
#endif

/* A cast that C++ compilers do not call old-fashioned, for macros that users expand. */
#ifdef __cplusplus
#define IQ24_CAST_(type, x) static_cast<type>(x)
#else
#define IQ24_CAST_(type, x) ((type)(x))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/*
 * For the steps of a control cycle: inlined whatever their size. Only then is a method that is a constant also one for the
 * compiler, and does a vector stay in registers from one step to the next.
 */
#if defined(__GNUC__)
#define IQFOC_STEP static inline __attribute__((always_inline))
#else
#define IQFOC_STEP static inline
#endif

/* Hook: a condition that is seldom true. A core with slow branches lets the compiler move its code out of the usual path. */
#ifndef IQ24_RARE
#define IQ24_RARE(condition) (condition)
#endif

/* Hook: the exact 64-bit product of two int32_t. Every product of IQ24 goes through it. */
#ifndef IQ24_MUL64
#define IQ24_MUL64(a, b) ((int64_t)(a) * (int64_t)(b))
#endif

/* Hook: a sum and such a product, where the target has one instruction for both. */
#ifndef IQ24_MAC64
#define IQ24_MAC64(sum, a, b) ((sum) + IQ24_MUL64(a, b))
#endif

/* Hook: the sum of two such products, modulo 2^64. */
#ifndef IQ24_SUM64
#define IQ24_SUM64(a, b, c, d) IQ24_MAC64(IQ24_MUL64(a, b), c, d)
#endif

/*
 * Hooks: floor(a b / 2^32), the high word of the product; the same added to c, modulo 2^32; the high word to
 * nearest, ties up, and that added to c. |a b| <= 2^62, so the high word is within 2^30.
 */
#ifndef IQ24_HIGH
#define IQ24_HIGH(a, b) iq24_wrap(iq24_asr64(IQ24_MUL64(a, b), 32))
#endif
#ifndef IQ24_HIGH_ADD
#define IQ24_HIGH_ADD(c, a, b) iq24_add_wrap(c, IQ24_HIGH(a, b))
#endif
/* The high word added to c where the sum is known to fit: a plain sum but where the core has one instruction for both. */
#ifndef IQ24_HIGH_PLUS
#define IQ24_HIGH_PLUS(c, a, b) ((c) + IQ24_HIGH(a, b))
#endif
/* The high word of -a b added to c, modulo 2^32. a is not IQ24_MIN. */
#ifndef IQ24_HIGH_SUB
#define IQ24_HIGH_SUB(c, a, b) IQ24_HIGH_ADD(c, -(a), b)
#endif
#ifndef IQ24_HIGH_ROUND
#define IQ24_HIGH_ROUND(a, b) iq24_high_round_of(IQ24_MUL64(a, b))
#endif
#ifndef IQ24_HIGH_ROUND_ADD
#define IQ24_HIGH_ROUND_ADD(c, a, b) iq24_add_wrap(c, IQ24_HIGH_ROUND(a, b))
#endif

/* Hook: x = first and y = second, where first and second are neighbours in memory, in this order. */
#ifndef IQ24_LOAD_PAIR
#define IQ24_LOAD_PAIR(x, y, first, second)                                                                  \
    do {                                                                                                     \
        (x) = (first);                                                                                       \
        (y) = (second);                                                                                      \
    } while (0)
#endif

/* Hook: loads after this line stay after it. A load that the compiler moves far ahead of its use occupies a register. */
#ifndef IQ24_LOAD_FROM_HERE
#define IQ24_LOAD_FROM_HERE()                                                                                \
    do {                                                                                                     \
    } while (0)
#endif

/* Hook: exchanges two variables, whose difference fits, if low is above high. */
#ifndef IQ24_ORDER
#define IQ24_ORDER(low, high)                                                                                \
    do {                                                                                                     \
        if ((high) < (low)) {                                                                                \
            const iq24_t l_ = (high);                                                                        \
            (high) = (low);                                                                                  \
            (low) = l_;                                                                                      \
        }                                                                                                    \
    } while (0)
#endif

/* Hook: x held to the range of a signed number of `bits` bits, a constant from 1 to 31. */
#ifndef IQ24_HOLD_BITS
#define IQ24_HOLD_BITS(x, bits) iq24_hold_bits(x, bits)
#endif

typedef int32_t iq24_t;     /* Q7.24 */
typedef int64_t iq24_acc_t; /* Q15.48: a sum of products of iq24_t before rounding */

#define IQ24_FRACTION_BITS 24
#define IQ24_ONE           IQ24_CAST_(iq24_t, 16777216)
#define IQ24_MAX           INT32_MAX /* 128 - 2^-24 */
#define IQ24_MIN           INT32_MIN /* -128 */

/*
 * IQ24(x): the iq24_t nearest to the constant x, ties away from zero. x is a constant floating expression with -128 -
 * 2^-25 < x < 128 - 2^-25; it is evaluated more than once, and folds at compile time. A constant out of range is a
 * division by zero: an error where a constant is needed, elsewhere a warning, which -Werror makes one. The remainder
 * of the truncation is exact, unlike x * 2^24 + 0.5, which is itself rounded before it is truncated.
 */
#define IQ24(x) (IQ24_NEAREST_(x) / IQ24_IS_IN_RANGE_(x))
#define IQ24_NEAREST_(x)                                                                                     \
    IQ24_CAST_(iq24_t, IQ24_CUT_(x) + (IQ24_SCALED_(x) - IQ24_CUT_(x) >= 0.5) -                              \
                           (IQ24_SCALED_(x) - IQ24_CUT_(x) <= -0.5))
#define IQ24_IS_IN_RANGE_(x) (((IQ24_SCALED_(x) > -2147483648.5) && (IQ24_SCALED_(x) < 2147483647.5)) ? 1 : 0)
#define IQ24_SCALED_(x)      ((x)*16777216.0)
#define IQ24_CUT_(x)         IQ24_CAST_(iq24_t, IQ24_SCALED_(x))

/*
 * x 2^bits of constants, 0 <= bits <= 62, for numbers in other formats: like IQ24() nothing that the target
 * computes.
 */
#define IQ24_RAISED_(x, bits) ((x)*1.0 * (INT64_C(1) << (bits)))

/* floor(x / 2^bits), 0 <= bits <= 31. */
static inline int32_t iq24_asr32(int32_t x, uint32_t bits)
{
    return x < 0 ? ~(~x >> bits) : x >> bits; /* ~x = -1 - x >= 0 */
}

/* floor(x / 2^bits), 0 <= bits <= 63. */
static inline int64_t iq24_asr64(int64_t x, uint32_t bits)
{
    return x < 0 ? ~(~x >> bits) : x >> bits;
}

/* The two's complement number of these 32 bits. */
static inline iq24_t iq24_from_bits(uint32_t bits)
{
    return bits <= INT32_MAX ? (iq24_t)bits : -(iq24_t)(UINT32_MAX - bits) - 1;
}

/* The low 32 bits of x as a two's complement number: x itself where it fits, else x modulo 2^32. */
static inline iq24_t iq24_wrap(int64_t x)
{
#ifdef __FRAMAC__
    /* The same value in a form that a proof over ranges can follow (docs/proofs.md); no build has this. */
    if (x >= INT32_MIN && x <= INT32_MAX) {
        return (iq24_t)x;
    }
#endif
    return iq24_from_bits((uint32_t)x); /* modulo 2^32, by definition of the conversion */
}

/*
 * floor(x / 2^bits), wrapped, 1 <= bits <= 31: iq24_wrap(iq24_asr64(x, bits)) on the two halves of x.
 *
 * Spelt on halves because a compiler that knows the range of x would else keep the result in 64 bits and
 * multiply by it with three instructions more (gcc 12.2, Cortex-M4).
 */
static inline iq24_t iq24_shift_wrap(int64_t x, uint32_t bits)
{
#ifdef __FRAMAC__
    return iq24_wrap(iq24_asr64(x, bits));
#else
    const uint32_t high = (uint32_t)((uint64_t)x >> 32);
    const uint32_t low = (uint32_t)((uint64_t)x & UINT32_MAX);
    return iq24_from_bits(((high & (UINT32_MAX >> (32 - bits))) << (32 - bits)) | (low >> bits));
#endif
}

/* floor(x / 2^32): the high word. */
static inline int32_t iq24_high_of(int64_t x)
{
#ifdef __FRAMAC__
    return iq24_wrap(iq24_asr64(x, 32));
#else
    return iq24_from_bits((uint32_t)((uint64_t)x >> 32));
#endif
}

/*
 * x / 2^32 to nearest, ties up, |x| <= 2^62: the high word, and one more where the low word is at least half of it.
 * Less than a 64-bit sum on a core without a carry.
 */
static inline int32_t iq24_high_round_of(int64_t x)
{
    const uint32_t low = (uint32_t)((uint64_t)x & UINT32_MAX);
    return iq24_wrap(iq24_asr64(x, 32)) + (int32_t)(low >> 31);
}

/* high 2^32 + low. Or, not plus: the halves do not overlap, and stay in their registers. */
static inline int64_t iq24_acc_join(int32_t high, uint32_t low)
{
    return (int64_t)high * INT64_C(0x100000000) | (int64_t)low;
}

/* x where it fits, else the nearer of IQ24_MIN and IQ24_MAX. */
static inline iq24_t iq24_sat(int64_t x)
{
    /* x fits exactly if cutting it changes nothing. Else its sign alone decides: MAX ^ -1 = MIN. */
    iq24_t low = iq24_wrap(x);
    return low == x ? low : (IQ24_MAX ^ iq24_wrap(iq24_asr64(x, 63)));
}

/* ---- Sums: exact, then wrapped or saturated. Scale: any, the same for all. ---- */
/* Range: |a| and |b| <= 2^31, so a sum or difference is within 2^32 and exact in 64 bits. */

static inline iq24_t iq24_add_wrap(iq24_t a, iq24_t b)
{
    return iq24_wrap((int64_t)a + b);
}

static inline iq24_t iq24_sub_wrap(iq24_t a, iq24_t b)
{
    return iq24_wrap((int64_t)a - b);
}

static inline iq24_t iq24_add_sat(iq24_t a, iq24_t b)
{
    return iq24_sat((int64_t)a + b);
}

static inline iq24_t iq24_sub_sat(iq24_t a, iq24_t b)
{
    return iq24_sat((int64_t)a - b);
}

/* -a; -IQ24_MIN saturates to IQ24_MAX. */
static inline iq24_t iq24_neg_sat(iq24_t a)
{
    /*@ assert either: a == -2147483648 || a > -2147483648; */
    return -(a + (a == IQ24_MIN)); /* -(MIN + 1) = MAX; no branch on the targets */
}

/* |a|; |IQ24_MIN| saturates to IQ24_MAX. */
static inline iq24_t iq24_abs_sat(iq24_t a)
{
    return a < 0 ? iq24_neg_sat(a) : a;
}

static inline iq24_t iq24_min(iq24_t x, iq24_t y)
{
    return x < y ? x : y;
}

static inline iq24_t iq24_max(iq24_t x, iq24_t y)
{
    return x > y ? x : y;
}

/* lo <= x <= hi. */
static inline bool iq24_within(iq24_t x, iq24_t lo, iq24_t hi)
{
    return x >= lo && x <= hi;
}

/* x limited to lo ... hi. Precondition: lo <= hi. */
static inline iq24_t iq24_clamp(iq24_t x, iq24_t lo, iq24_t hi)
{
    iq24_t floored = x < lo ? lo : x;
    return floored > hi ? hi : floored;
}

/*
 * x held to -2^(bits-1) ... 2^(bits-1) - 1, 1 <= bits <= 31. x fits if all its bits from the sign's on are equal: one
 * comparison in place of two.
 */
static inline int32_t iq24_hold_bits(int32_t x, uint32_t bits)
{
    const int32_t greatest = (INT32_C(1) << (bits - 1)) - 1;
#ifdef __FRAMAC__ /* the same value in a form that a proof over ranges can follow; no build has this */
    return iq24_clamp(x, -greatest - 1, greatest);
#else
    const int32_t sign = iq24_asr32(x, 31);
    return iq24_asr32(x, bits - 1) == sign ? x : greatest ^ sign;
#endif
}

/* iq24_clamp(x, -2^bits, 2^bits), 1 <= bits <= 30: what fits bits + 1 bits, and one more where that is exceeded above. */
#define IQ24_HOLD_POWER(x, bits) iq24_one_more_above(x, IQ24_HOLD_BITS(x, (bits) + 1))
static inline iq24_t iq24_one_more_above(iq24_t x, iq24_t held)
{
    return x > held ? held + 1 : held;
}

/*
 * ---- Sums of products ----
 * Scaling: Q7.24 * Q7.24 = Q15.48, exact; only iq24_acc_round and iq24_acc_sat round, once for the whole sum.
 * Precondition of mac: the true sum lies in -32768 <= sum < 32768 (|acc| <= 2^63); of round and sat,
 * 2^-25 below that. One product is at most 2^62 (16384.0), so any two products meet it, unless both are
 * IQ24_MIN * IQ24_MIN and are added; n products meet it if their factors are below sqrt(32768 / n) in
 * magnitude, as per-unit values (below 8) are for n <= 512.
 */
static inline iq24_acc_t iq24_acc_mul(iq24_t a, iq24_t b)
{
    return IQ24_MUL64(a, b); /* |product| <= 2^31 * 2^31 = 2^62 */
}

static inline iq24_acc_t iq24_acc_mac(iq24_acc_t acc, iq24_t a, iq24_t b)
{
    return IQ24_MAC64(acc, a, b);
}

/* Half an LSB. A sum that starts from it is rounded by iq24_acc_trunc: one instruction less than by round. */
#define IQ24_ACC_HALF (INT64_C(1) << (IQ24_FRACTION_BITS - 1))

/* floor(sum), wrapping. Error below 1 LSB where it fits; <= 0.5 LSB if the sum started from IQ24_ACC_HALF. */
static inline iq24_t iq24_acc_trunc(iq24_acc_t acc)
{
    return iq24_shift_wrap(acc, IQ24_FRACTION_BITS);
}

/* The sum to the nearest iq24_t, ties up, wrapping. Error <= 0.5 LSB where it fits. */
static inline iq24_t iq24_acc_round(iq24_acc_t acc)
{
    return iq24_acc_trunc(acc + IQ24_ACC_HALF);
}

/* The sum to the nearest iq24_t, ties up, saturating. Error <= 0.5 LSB where it fits. */
static inline iq24_t iq24_acc_sat(iq24_acc_t acc)
{
    return iq24_sat(iq24_asr64(acc + IQ24_ACC_HALF, IQ24_FRACTION_BITS));
}

/*
 * ---- High words: floor(a b / 2^32), c plus it, the nearest, ties up, and c plus that ----
 * For factors whose formats have 32 bits to spare: one instruction on cores that have it. Never overflow, but
 * for the sums, which wrap.
 */
static inline int32_t iq24_mul_high(int32_t a, int32_t b)
{
    return IQ24_HIGH(a, b);
}

static inline int32_t iq24_mac_high(int32_t c, int32_t a, int32_t b)
{
    return IQ24_HIGH_ADD(c, a, b);
}

static inline int32_t iq24_mul_high_round(int32_t a, int32_t b)
{
    return IQ24_HIGH_ROUND(a, b);
}

static inline int32_t iq24_mac_high_round(int32_t c, int32_t a, int32_t b)
{
    return IQ24_HIGH_ROUND_ADD(c, a, b);
}

/*
 * ---- Products ----
 * Range: |a b| <= 2^62; with the half LSB of rounding (2^23) still below 2^63, so every step before the wrap
 * or the saturation is exact. The full 64-bit product is rounded once: error below 1 LSB (trunc) or <= 0.5
 * LSB (round, sat).
 */

/* floor(a b), wrapping. */
static inline iq24_t iq24_mul_trunc(iq24_t a, iq24_t b)
{
    return iq24_acc_trunc(IQ24_MUL64(a, b));
}

/* a b to nearest, ties up, wrapping. */
static inline iq24_t iq24_mul_round(iq24_t a, iq24_t b)
{
    return iq24_acc_round(IQ24_MUL64(a, b));
}

/* a b to nearest, ties up, saturating. */
static inline iq24_t iq24_mul_sat(iq24_t a, iq24_t b)
{
    return iq24_acc_sat(IQ24_MUL64(a, b));
}

/*
 * a b / 2^bits to nearest, ties up, wrapping, 1 <= bits <= 31: a product of two formats in a third, whose
 * fractional bits are those of a and b less `bits`. Error <= 0.5 unit where it fits.
 */
static inline int32_t iq24_mul_shift(int32_t a, int32_t b, uint32_t bits)
{
    return iq24_shift_wrap(IQ24_MUL64(a, b) + (INT64_C(1) << (bits - 1)), bits);
}

#ifdef __cplusplus
}
#endif

#endif
