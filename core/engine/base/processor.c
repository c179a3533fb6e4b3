/* Asks the processor, for all of hooke and its plugins: loops for wider vectors are chosen by this answer
 * (core/plugin/widest.h), which hk_host.lanes hands on. HOOKE_LANES=2 or 4 in the environment takes narrower ones than
 * the processor has, so that what another machine computes can be seen on this one. */
#include "core/engine/base/base.h"

#include <stdlib.h>

static int of_processor(void) {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return 2;
  bool wide =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  return wide ? 8 : 4;
#else
  return 2;
#endif
}

int hk_processor_lanes(void) {
  const char *asked = getenv("HOOKE_LANES");
  int most = of_processor(), wanted = asked ? atoi(asked) : most;
  return (wanted == 2 || wanted == 4) && wanted < most ? wanted : most;
}
