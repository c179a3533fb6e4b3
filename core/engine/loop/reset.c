/* Tells the integrator that its history and cached forces are invalid. */
#include "core/engine/loop/loop.h"

void hk_step_reset(hk_loop *loop, hk_reason why) {
  const hk_integrator *method = loop->method;
  if (loop->dynamics->constrain) loop->dynamics->constrain->forget(loop->dynamics);
  if (!method->reset) return;
  const hk_instance *outer = hk_enter(loop->integrator);
  method->reset(loop->integrator->self, why);
  hk_leave(loop->integrator, outer);
}
