#pragma once

/// Before a function whose loops are vectorised: it is compiled for AVX2, too, and the processor
/// chooses when the program starts. Neither version fuses a product with a sum, so that both give
/// the same bits. The sanitizers are not up yet when that choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define OCTURN_VECTOR_LEVELS __attribute__((target_clones("avx2", "default")))
#else
#define OCTURN_VECTOR_LEVELS
#endif
