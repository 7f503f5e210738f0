/// Run-time choice of instruction set for hot loops, left to the compiler.
#pragma once

/// Two ways to build a hot free function for AVX-512, AVX2 and the baseline, of which the loader picks one. With
/// -ffp-contract=off all three give the same bits. The CMake option OUTCROP_SIMD builds for AVX2 or the baseline alone, to
/// test and measure them. Sanitizers cannot run the loader's choice; they get the baseline.
///
/// OUTCROP_SIMD_CLONES, in front of a definition: for loops that the compiler turns into vectors.
///
/// OUTCROP_SIMD_WIDTHS(signature, body): for vectors of one's own, of kWidth floats: 16, 8 or 4, as many as a register
/// holds. (GCC 12 takes wider vectors, but compares them float by float.)
#define OUTCROP_SIMD_BODY(width, signature, ...) \
  signature {                                    \
    constexpr int kWidth = width;                \
    __VA_ARGS__                                  \
  }
#define OUTCROP_SIMD_512 __attribute__((target("arch=x86-64-v4")))
#define OUTCROP_SIMD_256 __attribute__((target("arch=x86-64-v3")))

#if !defined(__GNUC__) || defined(__clang__) || !defined(__x86_64__) || defined(__SANITIZE_ADDRESS__) || \
    defined(__SANITIZE_THREAD__) || defined(OUTCROP_SIMD_BASELINE)
#define OUTCROP_SIMD_CLONES
#define OUTCROP_SIMD_WIDTHS(signature, ...) OUTCROP_SIMD_BODY(4, signature, __VA_ARGS__)
#elif defined(OUTCROP_SIMD_AVX2)
#define OUTCROP_SIMD_CLONES OUTCROP_SIMD_256
#define OUTCROP_SIMD_WIDTHS(signature, ...) OUTCROP_SIMD_256 OUTCROP_SIMD_BODY(8, signature, __VA_ARGS__)
#else
#define OUTCROP_SIMD_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define OUTCROP_SIMD_WIDTHS(signature, ...)                             \
  OUTCROP_SIMD_512 OUTCROP_SIMD_BODY(16, signature, __VA_ARGS__)        \
  OUTCROP_SIMD_256 OUTCROP_SIMD_BODY(8, signature, __VA_ARGS__)         \
  __attribute__((target("default"))) OUTCROP_SIMD_BODY(4, signature, __VA_ARGS__)
#endif
