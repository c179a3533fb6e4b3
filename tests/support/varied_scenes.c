#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

const char *const varied_method[VARIED_ALL] = {
    "leapfrog",          "symplectic_euler",   "rk4", "euler", "midpoint", "trapezoid", "backward_euler",
    "implicit_midpoint", "implicit_trapezoid", "bdf2"};

void varied_tetrahedron(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0.1, 0, 0, 1);
  test_particle(e, 1, 0.2, -0.1, p[2]);
  test_particle(e, 0.3, 1.1, 0, 0.5);
  test_particle(e, 0.2, 0.3, 0.9, 1.5);
  for (size_t k = 0; k < 9; k++) e->scene->particles.velocity[k] = p[3] * sin(1.7 * (double)k);
  test_pin(e, HK_PIN_FIXED, 4, NULL);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 1}, {1, 4}}, 4);
  test_number(e, springs, "k", p[0]);
  test_number(e, springs, "rest", 0.8);
  test_number(e, springs, "damping", p[1]);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "d", 0.4);
  hk_plugin_spec *pull = test_plugin(e, HK_FORCE, "central");
  test_number(e, pull, "strength", 3);
  test_number(e, pull, "softening", 0.2);
  test_number(e, pull, "power", -2);
}

static void open_one(const varied_runs *r, test_engine *e, size_t k, double by) {
  double p[VARIED_PARAMETERS];
  memcpy(p, r->p, sizeof p);
  p[k] += by;
  test_engine_open(e);
  r->scene(e, p);
  e->scene->duration = 100;
  e->scene->fps = 10;
  test_exact_integrator(e, r->integrator);
  e->options.dt = r->dt;
  test_run(e);
}

void varied_open(varied_runs *r, varied_scene *scene, const char *integrator, const double p[VARIED_PARAMETERS],
                 size_t count, double dt) {
  *r = (varied_runs){.scene = scene, .integrator = integrator, .dt = dt, .count = count};
  memcpy(r->p, p, sizeof r->p);
  open_one(r, &r->base, 0, 0);
  for (size_t k = 0; k < count; k++) {
    double by = 1e-5 * p[k];
    open_one(r, &r->more[k], k, by);
    open_one(r, &r->less[k], k, -by);
    r->by[k] = (hk_varied){&r->more[k].run->dynamics, &r->less[k].run->dynamics, by, NULL};
  }
  hk_error error = {0};
  if (hk_sensitivity_open(&r->base.run->loop, &r->s, &error) != HK_OK) fail_msg("%s", error.text);
}

void varied_run(varied_runs *r, double t) {
  hk_error error = {0};
  test_advance(&r->base, t);
  if (hk_sensitivity_finish(r->s, &error) != HK_OK) fail_msg("%s", error.text);
}

void varied_keep(varied_runs *r, size_t stride) {
  hk_sensitivity *s = r->s;
  size_t size = s->wide;
  double *Z = calloc(size, sizeof *Z);
  s->kept = realloc(s->kept, (s->steps / stride + 1) * size * sizeof *s->kept);
  s->tape = realloc(s->tape, stride * s->each * sizeof *s->tape);
  assert_true(Z && s->kept && s->tape);
  memcpy(Z, s->start, 6 * s->n * sizeof *Z);
  for (size_t k = 0; k < s->steps; k += stride) {
    memcpy(s->kept + k / stride * size, Z, size * sizeof *Z);
    size_t end = k + stride < s->steps ? k + stride : s->steps;
    assert_int_equal(hk_sensitivity_record(s, k, end, Z), HK_OK);
  }
  s->stride = stride;
  free(Z);
}

void varied_end(const varied_runs *r, size_t k, double by, double t, double *X) {
  test_engine e;
  open_one(r, &e, k, by);
  test_advance(&e, t);
  memcpy(X, e.run->state.X, 6 * e.run->state.model.n * sizeof *X);
  test_engine_close(&e);
}

void varied_close(varied_runs *r) {
  hk_sensitivity_close(r->s);
  test_engine_close(&r->base);
  for (size_t k = 0; k < r->count; k++) {
    test_engine_close(&r->more[k]);
    test_engine_close(&r->less[k]);
  }
}

hk_status varied_keep_tangents(void *context, double t, const double *X, const double *tangents) {
  varied_tangents *kept = context;
  (void)t;
  memcpy(kept->last, tangents, kept->numbers * sizeof *tangents);
  memcpy(kept->X, X, 6 * kept->n * sizeof *X);
  return HK_OK;
}
