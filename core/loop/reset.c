/* The word to the integrator that what it remembers is void. */
#include "core/loop/loop.h"

void hk_step_reset(hk_loop *loop, hk_reason why) {
  const hk_integrator *method = loop->step->method;
  if (method->reset) method->reset(loop->integrator->self, why);
}
