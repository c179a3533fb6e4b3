/* What births and deaths cost at a million particles: 250,000 are born and as many die per second, about a thousand in
 * a step of 1/240 s. Beside the times of the emitter alone and of the emitter with what the host does for births and
 * deaths, the step of the same particles without a source. Least of several parts of the runs, which take turns. */
#include "core/engine/base/base.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { PARTICLES = 1000000, PARTS = 12, STEPS = 4 };

static const double life = 4, dt = 1.0 / 240, warm = 12;

typedef struct bench {
  test_engine e;
  hk_plugin_spec *emitter;
  double best, best_emitter, emitter_before;
  size_t frame;
} bench;

static void add_forces(bench *b, int which) {
  if (which > 0) test_plugin(&b->e, HK_FORCE, "gravity");
  if (which > 0) test_number(&b->e, test_plugin(&b->e, HK_FORCE, "drag"), "rate", 0.5);
  if (which > 1) test_number(&b->e, test_plugin(&b->e, HK_FORCE, "central"), "strength", 1);
}

/* Where `source`, bursts of the ages that a stream would have fill the scene at once: particles die from the start on.
 */
static void open_bench(bench *b, bool source, int forces, int threads) {
  *b = (bench){.best = INFINITY, .best_emitter = INFINITY};
  test_engine_open(&b->e);
  b->e.scene->threads = threads;
  b->e.scene->fps = 1 / dt / STEPS;
  b->e.scene->duration = 1e3;
  b->e.options.dt = dt;
  b->emitter = test_plugin(&b->e, HK_SOURCE, "emitter");
  test_number(&b->e, b->emitter, "rate", source ? PARTICLES / life : 0);
  test_number(&b->e, b->emitter, "burst", PARTICLES);
  test_list(&b->e, b->emitter, "burst_at", (double[]){0}, 1);
  test_text(&b->e, b->emitter, "shape", "ball");
  test_number(&b->e, b->emitter, "cone", 20);
  test_number(&b->e, b->emitter, "speed_spread", 0.2);
  test_number(&b->e, b->emitter, "capacity", 4 * PARTICLES);
  if (source) test_number(&b->e, b->emitter, "lifetime", life);
  if (source) test_number(&b->e, b->emitter, "lifetime_spread", 1);
  add_forces(b, forces);
  test_run(&b->e);
}

static void advance(bench *b, size_t frames, bool counts) {
  const hk_instance *source = test_instance(&b->e, b->emitter);
  double begin = hk_clock(), seconds = source->seconds;
  b->frame += frames;
  test_advance(&b->e, (double)(b->frame * STEPS) * dt);
  if (!counts) return;
  b->best = fmin(b->best, (hk_clock() - begin) / (double)(frames * STEPS));
  b->best_emitter = fmin(b->best_emitter, (source->seconds - seconds) / (double)(frames * STEPS));
}

int main(void) {
  for (int threads = 1; threads <= 2; threads++)
    for (int forces = 1; forces <= 2; forces++) {
      bench with, without;
      open_bench(&with, true, forces, threads);
      open_bench(&without, false, forces, threads);
      advance(&with, (size_t)warm, false);
      advance(&without, (size_t)warm, false);
      for (int part = 0; part < PARTS; part++) {
        advance(&with, 1, true);
        advance(&without, 1, true);
      }
      printf("%d threads, %s: step %.2f ms with births, %.2f ms without; emitter, births and deaths %.2f ms, %.1f %%; "
             "%zu particles\n",
             threads, forces == 1 ? "gravity and drag" : "gravity, drag and a pull", 1e3 * with.best,
             1e3 * without.best, 1e3 * with.best_emitter, 100 * with.best_emitter / with.best,
             hk_run_view(with.e.run)->n);
      test_engine_close(&with.e);
      test_engine_close(&without.e);
    }
  return 0;
}
