// The instruction sets the kernels are compiled for, a subset of Highway's: what
// every processor has (one lane, no vectors), SSE4, AVX2 and AVX-512. Include
// before any header of Highway.
#pragma once

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
