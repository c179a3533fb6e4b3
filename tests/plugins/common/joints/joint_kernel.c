/* The kernel of joints against their elements one by one, in any order of the particles, damped or not, in space and in
 * a plane, on chosen particles, and the same on any number of threads. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t seed = 1;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

typedef struct setting {
  uint32_t n, strand; /* particles; of one chain */
  bool shuffle, damped, plane, some;
  int threads;
} setting;

typedef struct chains {
  test_engine e;
  hk_instance *force;
  hk_view view;
  uint32_t (*joint)[3];
  size_t joints;
  double *numbers;
} chains;

static void shuffle(uint32_t *id, uint32_t n) {
  for (uint32_t k = n - 1; k > 0; k--) {
    uint32_t other = (uint32_t)((noise() + 1) / 2 * k), swap = id[k];
    id[k] = id[other], id[other] = swap;
  }
}

static void open_chains(chains *c, const setting *s) {
  uint32_t *id = malloc(s->n * sizeof *id);
  *c = (chains){.joint = malloc(s->n * sizeof *c->joint), .numbers = malloc(s->n * sizeof(double))};
  test_engine_open(&c->e);
  for (uint32_t i = 0; i < s->n; i++) id[i] = i + 1, test_particle(&c->e, noise(), noise(), noise(), 1);
  for (size_t k = 0; k < 3 * s->n; k++) c->e.scene->particles.velocity[k] = noise();
  if (s->shuffle) shuffle(id, s->n);
  for (uint32_t i = 2; i < s->n; i++)
    if (i % s->strand >= 2) memcpy(c->joint[c->joints++], (uint32_t[]){id[i - 2], id[i - 1], id[i]}, sizeof *c->joint);
  hk_plugin_spec *spec = test_plugin(&c->e, HK_FORCE, "angle_springs");
  test_tuples(&c->e, spec, "joints", 3, &c->joint[0][0], c->joints);
  for (size_t k = 0; k < c->joints; k++) c->numbers[k] = 2 + noise();
  test_list(&c->e, spec, "k", c->numbers, c->joints);
  if (s->damped) test_list(&c->e, spec, "damping", c->numbers, c->joints);
  for (size_t k = 0; k < c->joints; k++) c->numbers[k] = s->plane ? 3 * noise() : k % 2 ? 0 : 1 + noise();
  test_list(&c->e, spec, "rest", c->numbers, c->joints);
  if (s->plane) test_vector(&c->e, spec, "normal", 0.3, -0.5, 0.7);
  if (s->some) {
    spec->only = malloc(s->n * sizeof *spec->only);
    for (uint32_t i = 0; i < s->n; i++)
      if (i % 7) spec->only[spec->only_count++] = i;
  }
  c->e.scene->threads = s->threads;
  c->e.options.dt = 1e-3;
  test_run(&c->e);
  c->force = test_instance(&c->e, spec);
  c->view = force_view(&c->e, c->force);
  free(id);
}

static void close_chains(chains *c) {
  test_engine_close(&c->e);
  free(c->joint);
  free(c->numbers);
}

/* - (k C + c dC/dt) dC of every element; returns the power of its second part. */
static double one_by_one(chains *c, double *F) {
  hk_elements list;
  double power = 0;
  hk_force_of(c->force->plugin)->elements.list(c->force->self, &c->view, &list);
  for (size_t k = 0; k < list.node.count; k++) {
    const uint32_t *node = hk_tuple(&list.node, k);
    double C, dC[3][3], rate = 0;
    list.evaluate(list.self, c->view.x, k, k + 1, &C, dC);
    for (int q = 0; q < 9; q++) rate += dC[q / 3][q % 3] * c->view.v[3 * (size_t)node[q / 3] + (size_t)(q % 3)];
    for (int q = 0; q < 9; q++)
      F[3 * (size_t)node[q / 3] + (size_t)(q % 3)] -=
          (hk_tuple_value(&list.stiffness, k) * C + hk_tuple_value(&list.damping, k) * rate) * dC[q / 3][q % 3];
    power -= hk_tuple_value(&list.damping, k) * rate * rate;
  }
  return power;
}

/* An angle is known to 4e-16 or so, and its gradient, 1/l, grows without bound where edges are short: deviations are
 * relative to the largest force, which is at those. */
static void compare(const setting *s) {
  chains c;
  open_chains(&c, s);
  double *F = calloc(3 * s->n, sizeof *F), *known = calloc(3 * s->n, sizeof *known), off = 0, scale = 0;
  double power = force_evaluate(c.force, &c.view, F), lost = one_by_one(&c, known);
  for (size_t k = 0; k < 3 * s->n; k++) off = fmax(off, fabs(F[k] - known[k])), scale = fmax(scale, fabs(known[k]));
  if (!(off <= 1e-13 * scale)) fail_msg("%u particles: forces differ by %g of %g", s->n, off, scale);
  if (!(fabs(power - lost) <= 1e-12 * fabs(lost))) fail_msg("power %.17g, known %.17g", power, lost);
  free(F);
  free(known);
  close_chains(&c);
}

static void the_kernel_is_the_sum_of_its_elements(void **state) {
  (void)state;
  const uint32_t sizes[] = {3, 5, 70, 1026, 5000}; /* one joint, a part of a block, more than one, more than a chunk */
  for (size_t k = 0; k < 5; k++)
    for (int kind = 0; kind < 16; kind++)
      compare(&(setting){sizes[k], kind & 8 ? 32 : UINT32_MAX, kind & 1, kind & 2, kind & 4, kind & 8, 2});
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  enum { N = 9000 };
  static double first[3 * N], F[3 * N];
  for (int mixed = 0; mixed < 2; mixed++)
    for (int threads = 1; threads < 4; threads++) {
      chains c;
      seed = 5;
      open_chains(&c, &(setting){N, UINT32_MAX, mixed, true, false, false, threads});
      force_evaluate(c.force, &c.view, F);
      if (threads == 1) memcpy(first, F, sizeof F);
      assert_memory_equal(first, F, sizeof F);
      close_chains(&c);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_kernel_is_the_sum_of_its_elements),
      cmocka_unit_test(threads_do_not_change_a_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
