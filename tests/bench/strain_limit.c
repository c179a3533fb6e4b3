/* What strain limiting costs beside one evaluation of the forces: hang(128) with all of its springs limited. At the
 * start no spring is beyond its limit, and what counts is the time in which that is seen; in the fall some are. Both
 * sides are measured in turn, in the time of the one thread: the least of the repeats, or the mean over the steps of a
 * fall. */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/bench/plain.h"

enum { N = 128, MOST = 6 * N * N };

typedef struct edges {
  uint32_t (*pair)[2];
  size_t count;
} edges;

/* In the order of the springs, or in a random one. */
static edges all_edges(bool shuffled) {
  static const int offset[6][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 0}, {0, 2}};
  edges list = {memory(MOST, sizeof *list.pair), 0};
  uint64_t state = 1;
  for (int o = 0; o < 6; o++)
    for (int j = 0; j + offset[o][1] < N; j++)
      for (int i = 0; i < N; i++) {
        int other = i + offset[o][0];
        if (other < 0 || other >= N) continue;
        list.pair[list.count][0] = (uint32_t)(j * N + i + 1);
        list.pair[list.count++][1] = (uint32_t)((j + offset[o][1]) * N + other + 1);
      }
  for (size_t k = list.count - 1; shuffled && k > 0; k--) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    size_t other = (size_t)((state >> 33) % (k + 1));
    uint32_t swap[2];
    memcpy(swap, list.pair[k], sizeof swap);
    memcpy(list.pair[k], list.pair[other], sizeof swap);
    memcpy(list.pair[other], swap, sizeof swap);
  }
  return list;
}

static hk_instance *open_limited(test_engine *e, double k, bool shuffled, double limit, double end) {
  edges list = all_edges(shuffled);
  open_cloth(e, N, k);
  hk_plugin_spec *spec = test_plugin(e, HK_CORRECTOR, "strain_limit");
  test_edges(e, spec, (const uint32_t(*)[2])list.pair, list.count);
  test_number(e, spec, "limit", limit);
  free(list.pair);
  e->options.integrator = "leapfrog";
  e->scene->fps = 1 / end;
  e->options.until = end;
  test_run(e);
  return test_instance(e, spec);
}

static double evaluate(test_engine *e, double *dX) {
  hk_system *s = &e->run->dynamics.system;
  double begin = own();
  s->accelerations(s, s->t, s->X, s->X + 3 * s->n, s->X + 6 * s->n, dX, dX + 3 * s->n);
  return own() - begin;
}

static double correct(test_engine *e, hk_instance *c, bool *changed) {
  hk_view view = *hk_run_view(e->run);
  hk_system *s = &e->run->dynamics.system;
  hk_correction correction = {.h = 1e-4, .x = s->X, .v = s->X + 3 * s->n};
  view.host = &c->host;
  double begin = own();
  c->plugin->corrector->correct(c->self, &view, &correction);
  begin = own() - begin;
  *changed = correction.changed;
  return begin;
}

static void none_beyond(bool shuffled) {
  enum { REPEATS = 201 };
  test_engine e;
  double forces = INFINITY, correction = INFINITY;
  bool changed = false, moved = false;
  hk_instance *c = open_limited(&e, 1000, shuffled, 0.1, 1e-2);
  double *dX = memory(e.run->dynamics.system.size, sizeof *dX);
  for (int r = 0; r < REPEATS; r++) {
    forces = fmin(forces, evaluate(&e, dX));
    correction = fmin(correction, correct(&e, c, &moved));
    changed |= moved;
  }
  printf("none beyond, edges in %-16s evaluation %6.0f us, strain_limit %6.1f us: %4.1f %%%s\n",
         shuffled ? "random order:" : "order:", forces * 1e6, correction * 1e6, 100 * correction / forces,
         changed ? " (SOME WERE)" : "");
  free(dX);
  test_engine_close(&e);
}

/* Symplectic Euler by hand, so that both sides of every step are measured alike. */
static void fall(double k, double limit, double seconds) {
  test_engine e;
  double forces = 0, correction = 0;
  size_t steps = 0, corrected = 0;
  hk_instance *c = open_limited(&e, k, false, limit, 1);
  hk_system *s = &e.run->dynamics.system;
  double *dX = memory(s->size, sizeof *dX), h = 0.8 * e.run->step->dt_limit;
  for (; (double)steps * h < seconds; steps++) {
    bool moved;
    forces += evaluate(&e, dX);
    for (size_t q = 0; q < 3 * s->n; q++) s->X[3 * s->n + q] += h * dX[q], s->X[q] += h * s->X[3 * s->n + q];
    correction += correct(&e, c, &moved);
    corrected += moved;
  }
  hk_view view = *hk_run_view(e.run);
  hk_summary summary;
  hk_run_summary(e.run, &summary);
  printf(
      "k = %g N/m, limit %g, %zu steps to %g s, %zu corrected: evaluation %4.0f us, strain_limit %6.1f us: %5.1f %%; "
      "violated by %.1e m, %s\n",
      k, limit, steps, seconds, corrected, forces / (double)steps * 1e6, correction / (double)steps * 1e6,
      100 * correction / forces, c->plugin->corrector->violation(c->self, &view),
      summary.warnings ? summary.warning[0] : "no warnings");
  free(dX);
  test_engine_close(&e);
}

int main(void) {
  none_beyond(false);
  none_beyond(true);
  fall(1000, 0.1, 0.5);
  fall(100, 0.1, 0.5);
  fall(1000, 0.02, 0.5);
  return 0;
}
