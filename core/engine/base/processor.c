/* Asks the processor, for all of hooke and its plugins: loops for wider vectors are chosen by this answer
 * (core/plugin/widest.h), which hk_host.lanes hands on. */
#include "core/engine/base/base.h"

int hk_processor_lanes(void) {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return 2;
  bool wide =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  return wide ? 8 : 4;
#else
  return 2;
#endif
}
