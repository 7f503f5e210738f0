/// Run-time choice of instruction set for hot loops, left to the compiler.
#pragma once

/// Put in front of a hot free function: the compiler builds it for AVX-512, AVX2 and the baseline and the loader picks one.
/// With -ffp-contract=off all three give the same bits. Sanitizers cannot run the loader's choice; there it is empty.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(OUTCROP_NO_CLONES)
#define OUTCROP_SIMD_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define OUTCROP_SIMD_CLONES
#endif
