// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSimdTargets_h
#define FFDSimdTargets_h

// The instruction sets that the vector kernels are compiled for, of those that Highway knows; the
// best one that the machine has is chosen when a kernel is called first. To be included before any
// header of Highway.
//
// Each target takes a minute to compile, hence only those that differ: SSSE3 is little better than
// SSE2, and what AVX3_ZEN4 and AVX3_SPR add to AVX3_DL (16-bit floats, dot products) no kernel
// uses. AVX3_DL counts where bytes of several registers are permuted: a file that does so defines
// FFD_PERMUTES_BYTES before it includes this one. SVE and RVV cannot be used: their vectors have no
// size at compile time, and ours are members of structures. NEON takes the place of SVE; other
// vector units, and new ones, are served by Highway's fallback in plain C++.
//
// On Arm that leaves one target, which every 64-bit processor has, and nothing to choose at run
// time. Highway is told so by the name that it has for systems that cannot tell: otherwise it asks
// GCC for "+crypto" function by function, which constructors that the compiler makes do not get.
#ifdef __GNUC__
// Highway 1.0 evaluates the macro below without some of its names: no warning (-Wundef).
#pragma GCC system_header
#endif
#ifdef FFD_PERMUTES_BYTES
#define HWY_WANT_AVX3_DL
#define FFD_BYTE_PERMUTATIONS HWY_AVX3_DL
#else
#define FFD_BYTE_PERMUTATIONS 0
#endif
#define HWY_DISABLED_TARGETS                                                                       \
  (~(HWY_SCALAR | HWY_EMU128 | HWY_SSE2 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | FFD_BYTE_PERMUTATIONS | \
    HWY_NEON_WITHOUT_AES | HWY_NEON | HWY_PPC8 | HWY_WASM))
#if (defined(__aarch64__) || defined(__arm__)) && !defined(TOOLCHAIN_MISS_SYS_AUXV_H)
#define TOOLCHAIN_MISS_SYS_AUXV_H
#endif
#include <hwy/detect_targets.h>

// Highway 1.0 (Debian 12) does not have these.
#ifndef HWY_SSE2
#define HWY_SSE2 0
#endif
#ifndef HWY_NEON_WITHOUT_AES
#define HWY_NEON_WITHOUT_AES 0
#endif

#endif
