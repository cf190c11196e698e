#pragma once

/// Marks a function whose loops are vectorised: it is compiled for the baseline and for AVX2, and
/// the processor chooses one when the program starts (an ifunc resolver). Neither version fuses a
/// product with a sum, so that both give the same bits. Without effect under sanitizers, which are
/// not initialised yet when the resolver runs.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define OCTURN_VECTOR_LEVELS __attribute__((target_clones("avx2", "default")))
#else
#define OCTURN_VECTOR_LEVELS
#endif
