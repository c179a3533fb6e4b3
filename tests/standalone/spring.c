/* A particle on a spring, with the engine alone: no script, no scene, no run. The force is the constant below, leapfrog
 * an installed plugin, whose swings of frequency w are too fast by a part (w h)^2 / 24. usage: spring PLUGINS */
#include "core/engine/loop/loop.h"

#include <stdio.h>

static const double stiffness = 40, amplitude = 0.1, dt = 1e-3, end = 10.3; /* N/m, m, s, s */

static hk_status add(void *self, const hk_view *view, double *F) {
  (void)self;
  for (size_t e = 0; e < 3 * view->n; e++) F[e] -= stiffness * view->x[e];
  return HK_OK;
}

static const hk_force force = {.size = sizeof force, .flags = HK_DEPENDS_ON_X, .add = add};
static const hk_plugin spring = {
    .abi = HK_ABI, .kind = HK_FORCE, .name = "spring", .instance_size = 1, .force = &force};

int main(int count, char **argument) {
  double x[3] = {amplitude, 0, 0}, v[3] = {0}, mass = 1;
  uint32_t group = 0;
  hk_particles start = {.n = 1, .position = x, .velocity = v, .mass = &mass, .group = &group};
  hk_error error = {0};
  hk_shared shared = {.error = &error, .allocations_left = -1};
  hk_registry registry;             /* finds plugins */
  const hk_plugin *plugin[2];       /* what they export, as the host keeps it */
  hk_plugin_spec *specs[2] = {0};   /* with the values of its parameters */
  hk_plugins plugins = {0};         /* instances, at work */
  hk_state state = {0};             /* X = (x, v, ...), masses, ids */
  hk_pins pins = {0};               /* none */
  hk_dynamics dynamics = {0};       /* f(X, t) */
  hk_step_length step = {.dt = dt}; /* nobody changes it */
  hk_record record = {0};           /* what a verdict would rest on */
  hk_loop loop = {0};               /* goes from frame to frame */
  hk_status status = hk_registry_open(&registry, count > 1 ? argument[1] : ".", NULL, &error);
  if (status == HK_OK && !(plugin[0] = hk_registry_add(&registry, &spring, &error))) status = HK_NO_MEMORY;
  if (status == HK_OK) status = hk_registry_find(&registry, HK_INTEGRATOR, "leapfrog", false, &plugin[1], &error);
  for (int k = 0; k < 2 && status == HK_OK; k++) {
    specs[k] = hk_spec_create(plugin[k], k ? "leapfrog" : "spring", "", &error);
    status = specs[k] ? hk_plugins_add(&plugins, specs[k], &shared, NULL, &error) : HK_NO_MEMORY;
  }
  if (status == HK_OK) status = hk_state_open(&state, &start, NULL, &error);
  if (status == HK_OK) status = hk_dynamics_open(&dynamics, &state, &pins, &plugins, &shared);
  if (status == HK_OK) status = hk_dynamics_start(&dynamics);
  if (status == HK_OK) status = hk_dynamics_begin(&dynamics);
  if (status == HK_OK) hk_loop_open(&loop, &dynamics, &step, &record, 100); /* frames at k/100 s */
  if (status == HK_OK) status = hk_loop_frame(&loop);
  if (status == HK_OK) status = hk_loop_to(&loop, end);
  if (status != HK_OK) fprintf(stderr, "spring: %s\n", error.text);
  double w = sqrt(stiffness / mass), late = w * end * (w * dt) * (w * dt) / 24;
  double off = status == HK_OK ? state.X[0] - amplitude * cos(w * end) : NAN, own = -amplitude * late * sin(w * end);
  printf("at %g s off the exact oscillator by %.4g m; the method's error is %.4g m\n", end, off, own);
  hk_loop_close(&loop);
  hk_dynamics_close(&dynamics);
  hk_plugins_clear(&plugins);
  hk_state_close(&state);
  for (int k = 0; k < 2; k++) hk_spec_destroy(specs[k]);
  hk_registry_close(&registry);
  return fabs(off - own) < 1e-3 * fabs(own) ? 0 : 1;
}
