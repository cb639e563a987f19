// Makes Eigen compute on arm64 as on amd64, in the same order and with one rounding an operation, so that a diagnosis
// gives the same bits. Included before every source for arm64 (cmake/libraries.cmake), and by Eigen once more as its
// plugin. Eigen's own pow() of arrays is less exact with it: use std::pow.
#ifndef ECS_EIGEN_AS_ON_AMD64
#define ECS_EIGEN_AS_ON_AMD64
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA  // pmadd: arch/NEON/PacketMath.h
// The kernel of matrix products: arch/NEON/GeneralBlockPanelKernel.h.
#define vfmaq_n_f64(sum, a, b) vaddq_f64(sum, vmulq_n_f64(a, b))
#define vfmaq_laneq_f64(sum, a, b, lane) vaddq_f64(sum, vmulq_laneq_f64(a, b, lane))
#define EIGEN_DENSEBASE_PLUGIN "cmake/eigen_as_on_amd64.hpp"
#else  // between the definition of this macro and the choice of four rows a step in place of six by it
#undef EIGEN_HAS_SINGLE_INSTRUCTION_MADD
#endif
