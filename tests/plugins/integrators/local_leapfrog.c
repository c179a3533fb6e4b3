/* local_leapfrog on networks of springs of two kinds, most of them linear, of rest length 0. Its own step is driven,
 * and the growth read off its matrix (tests/support/step_matrix.h). */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/engine.h"
#include "tests/support/fake_system.h"
#include "tests/support/step_matrix.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST = 12, EDGES = 3 * MOST };

typedef struct network {
  size_t n, edges, stiff; /* the first `stiff` edges */
  uint32_t pair[EDGES][2];
  double k[EDGES], rest, drag; /* N/m; m; 1/s */
  double pull;                 /* 1/s^2, of every particle to 0 */
  hk_element_list list;
} network;

static uint64_t state_of_random;

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1). */
static double uniform(void) {
  uint64_t z = state_of_random += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static void apply(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                  double *dy) {
  const network *w = context;
  (void)t, (void)y, (void)dy;
  for (size_t e = 0; e < w->edges; e++) {
    const double *xi = x + 3 * w->pair[e][0], *xj = x + 3 * w->pair[e][1];
    double d[3] = {xj[0] - xi[0], xj[1] - xi[1], xj[2] - xi[2]}, l = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    double k = w->rest > 0 ? w->k[e] * (1 - w->rest / l) : w->k[e];
    for (size_t c = 0; c < 3; c++) {
      a[3 * w->pair[e][0] + c] += k * d[c];
      a[3 * w->pair[e][1] + c] -= k * d[c];
    }
  }
  for (size_t c = 0; c < 3 * w->n; c++) a[c] -= w->pull * x[c] + w->drag * v[c];
}

static fake_system *system_of(network *w) {
  fake_system *f = fake_system_create(&(fake_problem){w->n, 0, HK_DEPENDS_ON_X | HK_DEPENDS_ON_V, apply, w});
  w->list = (hk_element_list){.force = "springs", .acts = true};
  w->list.elements = (hk_elements){.node = {w->edges, 2, &w->pair[0][0]}, .values = 1};
  w->list.elements.stiffness = (hk_per_tuple){w->edges, w->k};
  w->list.elements.rest = (hk_per_tuple){1, &w->rest};
  f->model.element_lists = 1;
  f->model.element_list = &w->list;
  return f;
}

static void join(network *w, uint32_t i, uint32_t j, double k) {
  w->pair[w->edges][0] = i;
  w->pair[w->edges][1] = j;
  w->k[w->edges++] = k;
}

/* Stiff springs on some of the particles, then soft ones on all. */
static network random_network(double ratio) {
  network w = {.n = 6 + (size_t)(uniform() * (MOST - 6))};
  size_t stiff = 1 + (size_t)(uniform() * 4);
  for (uint32_t i = 0; i < stiff; i++) join(&w, i, i + 1, ratio * (0.6 + 0.4 * uniform()));
  w.stiff = w.edges;
  for (uint32_t i = 0; i + 1 < w.n; i++) join(&w, i, i + 1, 0.5 + 0.5 * uniform());
  for (uint32_t i = 0; i + 2 < w.n; i++) join(&w, i, i + 2, uniform());
  return w;
}

/* The largest eigenvalue of the soft springs, by 2000 steps of power iteration: to some 1e-4, from below. */
static double softest(const network *w) {
  network soft = {.n = w->n, .edges = w->edges - w->stiff};
  memcpy(soft.pair, w->pair + w->stiff, soft.edges * sizeof *w->pair);
  memcpy(soft.k, w->k + w->stiff, soft.edges * sizeof *w->k);
  double x[3 * MOST], a[3 * MOST], length = 0;
  for (size_t c = 0; c < 3 * w->n; c++) x[c] = uniform() - 0.5;
  for (int k = 0; k < 2000; k++) {
    memset(a, 0, sizeof a);
    apply(&soft, 0, x, x, NULL, a, NULL);
    length = 0;
    for (size_t c = 0; c < 3 * w->n; c++) length += a[c] * a[c];
    length = sqrt(length);
    for (size_t c = 0; c < 3 * w->n; c++) x[c] = -a[c] / length;
  }
  return length;
}

static void scale(network *w, double by) {
  for (size_t e = 0; e < w->edges; e++) w->k[e] *= by;
}

/* The largest squared frequency, in steps of 1 s, at which the method grants the other springs no growth. */
static double granted(const fake_method *m) {
  double low = 0, high = 4.01;
  while (high - low > 1e-6) {
    double middle = (low + high) / 2;
    if (hk_integrator_of(m->plugin)->split.coupled_growth(m->self, 1, sqrt(middle), 0, 0) <= 1 + 1e-9)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* The method divided, with the soft springs at `part` of the limit that it states. NULL system: nothing is stiff. */
static fake_method open_at(network *w, double part) {
  double soft = softest(w), at = 1;
  fake_method m = {0};
  for (int round = 0; round < 3; round++) { /* what is granted depends on the division, little on the scale */
    scale(w, part * at / soft);
    soft = part * at;
    fake_system *f = system_of(w);
    for (size_t c = 0; c < 6 * w->n; c++) f->system.X[c] = uniform() - 0.5;
    m = fake_method_open("local_leapfrog", f);
    assert_int_equal(hk_integrator_of(m.plugin)->split.select_fast(m.self, &f->system), HK_OK);
    at = granted(&m);
    if (round == 2) return m;
    fake_method_close(&m);
    fake_system_destroy(f);
  }
  return m;
}

static void close_at(fake_method *m) {
  fake_system *f = m->system;
  fake_method_close(m);
  fake_system_destroy(f);
}

/* Spring ratios of 10 to 1e6, at 0.999 of the limit: up to 700 short steps, in and out of resonance. A pull of 1e-6
 * makes the modes without stiffness, whose double roots rounding would split, distinct. Without the shift of the stiff
 * modes (delta = 1) 11 of 120 grow, by up to a factor of 2.1 a step. */
static void no_step_below_the_stated_limit_grows(void **state) {
  size_t divided = 0;
  (void)state;
  for (int trial = 0; trial < 120; trial++) {
    network w = random_network(pow(10, 1 + 5 * uniform()));
    w.pull = 1e-6;
    fake_method m = open_at(&w, 0.999);
    double growth = m.system->system.split->fast ? step_growth(&m) : 1;
    divided += m.system->system.split->fast != NULL;
    if (!(growth < 1 + 1e-9)) fail_msg("scene %d grows by %g a step", trial, growth - 1);
    close_at(&m);
  }
  if (divided < 80) fail_msg("%zu of 120 scenes divided", divided);
}

/* The limit is that of the worst scene: some grow at twice it. */
static void the_stated_limit_is_no_excuse(void **state) {
  size_t growing = 0;
  (void)state;
  for (int trial = 0; trial < 40; trial++) {
    network w = random_network(pow(10, 2 + 3 * uniform()));
    w.pull = 1e-6;
    fake_method m = open_at(&w, 2);
    growing += m.system->system.split->fast && step_growth(&m) > 1 + 1e-6;
    close_at(&m);
  }
  assert_true(growing > 10);
}

static double energy(const network *w, const double *X) {
  double sum = 0;
  const double *v = X + 3 * w->n;
  for (size_t c = 0; c < 3 * w->n; c++) sum += v[c] * v[c] / 2 + w->pull * X[c] * X[c] / 2;
  for (size_t e = 0; e < w->edges; e++)
    for (size_t c = 0; c < 3; c++) sum += w->k[e] / 2 * pow(X[3 * w->pair[e][0] + c] - X[3 * w->pair[e][1] + c], 2);
  return sum;
}

/* A chain of 12 with three stiff springs in the middle, which moves as its soft springs say. */
static network chain(double ratio) {
  network w = {.n = MOST, .pull = 0.01};
  for (uint32_t i = 4; i < 7; i++) join(&w, i, i + 1, ratio);
  w.stiff = w.edges;
  for (uint32_t i = 0; i + 1 < w.n; i++) join(&w, i, i + 1, 1);
  return w;
}

static void bend(const network *w, double *X) {
  for (size_t i = 0; i < w->n; i++) {
    double s = i <= 4 ? (double)i : i < 7 ? 4 : (double)i - 3; /* stiff springs are not stretched */
    X[3 * i] = cos(0.4 * s), X[3 * i + 1] = sin(0.3 * s), X[3 * i + 2] = 0.1 * s;
  }
}

/* RMS distance of the positions at 40 s, after `steps` equal steps, to `reference`, into which they may go. */
static double end_of(const char *method, network w, size_t steps, double *reference, bool keep) {
  fake_system *f = system_of(&w);
  double *X = f->system.X, sum = 0;
  bend(&w, X);
  fake_method m = fake_method_open(method, f);
  fake_method_run(&m, 40, steps);
  for (size_t c = 0; c < 3 * w.n; c++) {
    sum += pow(X[c] - reference[c], 2);
    if (keep) reference[c] = X[c];
  }
  fake_method_close(&m);
  fake_system_destroy(f);
  return sqrt(sum / (3 * (double)w.n));
}

/* Against rk4, whose error at a fifth of the fastest period's radian is below 1e-6; the start lets the stiff springs
 * ring by their stretch under the pull of the soft ones, 5e-6, which long steps do not show. Drag on everything in the
 * second case. The error of leapfrog at the same step, where the stiff springs are soft enough for it, is of the same
 * size. */
static void order_is_two_and_the_error_that_of_the_long_step(void **state) {
  (void)state;
  for (int dragged = 0; dragged < 2; dragged++) {
    network w = chain(2e5), soft = chain(40);
    w.drag = soft.drag = dragged ? 0.05 : 0;
    double exact[3 * MOST] = {0}, exact_soft[3 * MOST] = {0}, error[3];
    end_of("rk4", w, 200000, exact, true);
    end_of("rk4", soft, 40000, exact_soft, true);
    for (int k = 0; k < 3; k++) error[k] = end_of("local_leapfrog", w, 400 << k, exact, false);
    double plain = end_of("leapfrog", soft, 1600, exact_soft, false);
    for (int k = 0; k < 2; k++) {
      double order = log2(error[k] / error[k + 1]);
      if (!(fabs(order - 2) <= 0.15)) fail_msg("order %g of %g, %g, %g", order, error[0], error[1], error[2]);
    }
    if (!(error[2] < 3 * plain)) fail_msg("error %g, leapfrog's %g", error[2], plain);
  }
}

/* 1e5 steps at 0.9 of the limit. The energy of a symplectic step, as seen at its ends, swings by (h w)^2/4 of itself,
 * at most by 1 at this step; it must not drift: the mean over the last tenth is that over the first. */
static void energy_stays_over_1e5_steps_and_momentum_to_rounding(void **state) {
  (void)state;
  network w = chain(3000);
  w.pull = 0;
  fake_method m = open_at(&w, 0.81);
  double *X = m.system->system.X, mean[10] = {0}, momentum[3] = {0}, most = 0;
  assert_non_null(m.system->system.split->fast);
  memset(X, 0, 6 * w.n * sizeof *X);
  bend(&w, X);
  double start = energy(&w, X);
  for (size_t k = 0; k < 100000; k++) {
    assert_int_equal(fake_method_step(&m, 1, NULL), HK_OK);
    double now = energy(&w, X);
    mean[k / 10000] += now / 10000;
    most = fmax(most, now);
  }
  for (size_t c = 0; c < 3 * w.n; c++) momentum[c % 3] += X[3 * w.n + c];
  for (int c = 0; c < 3; c++) /* 1e5 steps of 12 roundings of velocities around 1 */
    if (!(fabs(momentum[c]) < 1e-10)) fail_msg("momentum %g", momentum[c]);
  if (!(fabs(mean[9] / mean[0] - 1) < 0.02 && most < 3 * start))
    fail_msg("energy %g, mean %g at first, %g at last, at most %g", start, mean[0], mean[9], most);
  close_at(&m);
}

/* Up to the rounding of 100 steps on positions of a few metres: leapfrog adds the same terms in another order. */
static void where_nothing_is_stiff_it_is_leapfrog(void **state) {
  (void)state;
  network w = chain(1);
  double X[3 * MOST] = {0};
  end_of("leapfrog", w, 100, X, true);
  assert_true(end_of("local_leapfrog", w, 100, X, false) < 1e-13);
}

/* ---- what its flags say ---- */

/* How far a step of h changes the symplectic form: the largest entry of M^T J M - J for its derivative M, by central
 * differences of 1e-6 m and m/s. The start is bent so that stiff springs turn. */
static double form_changed(const char *method, network w, double h) {
  enum { SIZE = 6 * MOST };
  static double M[SIZE][SIZE], start[SIZE];
  const double d = 1e-6;
  double worst = 0;
  fake_system *f = system_of(&w);
  fake_method m = fake_method_open(method, f);
  bend(&w, start);
  for (size_t k = 0; k < SIZE; k++) start[k] += 0.3 * uniform();
  for (size_t k = 0; k < 2 * SIZE; k++) {
    memcpy(f->system.X, start, sizeof start);
    f->system.X[k / 2] += k % 2 ? -d : d;
    m.plugin->integrator->reset(m.self, HK_STATE_CHANGED);
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    for (size_t r = 0; r < SIZE; r++) M[k / 2][r] = k % 2 ? (M[k / 2][r] - f->system.X[r]) / (2 * d) : f->system.X[r];
  }
  for (size_t a = 0; a < SIZE; a++)
    for (size_t b = 0; b < SIZE; b++) {
      double sum = 0;
      for (size_t r = 0; r < SIZE / 2; r++) sum += M[a][r] * M[b][r + SIZE / 2] - M[a][r + SIZE / 2] * M[b][r];
      worst = fmax(worst, fabs(sum - (b == a + SIZE / 2) + (a == b + SIZE / 2)));
    }
  fake_method_close(&m);
  fake_system_destroy(f);
  return worst;
}

/* The acceleration that long steps are made with is no gradient of an energy by the positions: with linear springs it
 * is one after a change of coordinates that mixes those of stiff springs, with others not even that. Of leapfrog the
 * differences show 1e-9. */
static void it_is_reversible_and_not_symplectic(void **state) {
  (void)state;
  network linear = chain(3000), turning = chain(3000), soft = chain(1);
  turning.rest = soft.rest = 0.2;
  double by_linear = form_changed("local_leapfrog", linear, 0.5);
  double by_turning = form_changed("local_leapfrog", turning, 0.5), plain = form_changed("leapfrog", soft, 0.5);
  print_message("the symplectic form is off by %.1e, %.1e where springs turn; leapfrog %.1e\n", by_linear, by_turning,
                plain);
  assert_true(plain < 1e-7 && by_linear > 1e-2 && by_turning > 1e-2);
  fake_system *f = system_of(&linear);
  fake_method m = fake_method_open("local_leapfrog", f);
  assert_int_equal(m.plugin->integrator->flags & (HK_SYMPLECTIC | HK_REVERSIBLE), HK_REVERSIBLE);
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* ---- in the engine: pins, damping, gravity, springs of a rest length ---- */

enum { ROPE = 40 };

/* A rope with stiff springs here and there, one of them on a slide, one of which gets another beside it at 0.3 s. */
static void open_rope(test_engine *e, const char *method, double dt) {
  static const double across[3] = {0, 1, 0};
  uint32_t soft[ROPE][2], stiff[3][2] = {{12, 13}, {13, 14}, {30, 31}}, late[1][2] = {{13, 14}};
  test_engine_open(e);
  e->options.integrator = method;
  e->options.dt = dt;
  e->scene->duration = 0.4;
  for (uint32_t i = 1; i <= ROPE; i++) {
    test_particle(e, 0.025 * i, 0, 0.002 * (i % 3), 0.01);
    if (i > 1) soft[i - 2][0] = i - 1, soft[i - 2][1] = i;
  }
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_PLANE, 12, across);
  test_pin(e, HK_PIN_LINE, 31, (const double[3]){0, 0, 1});
  test_plugin(e, HK_FORCE, "gravity");
  hk_plugin_spec *springs[3] = {test_plugin(e, HK_FORCE, "springs"), test_plugin(e, HK_FORCE, "springs"),
                                test_plugin(e, HK_FORCE, "springs")};
  test_edges(e, springs[0], (const uint32_t(*)[2])soft, ROPE - 1);
  test_edges(e, springs[1], (const uint32_t(*)[2])stiff, 3);
  test_edges(e, springs[2], (const uint32_t(*)[2])late, 1);
  for (int k = 0; k < 3; k++) {
    test_number(e, springs[k], "k", k ? 2e6 : 500);
    test_number(e, springs[k], "damping", 0.05);
  }
  springs[2]->from = 0.3;
  test_run(e);
}

static void end_of_rope(const char *method, double dt, double x[3 * ROPE], double *step) {
  test_engine e;
  open_rope(&e, method, dt);
  test_advance(&e, 0.4);
  if (strcmp(method, "local_leapfrog") == 0) assert_non_null(e.run->dynamics.system.split->fast);
  memcpy(x, e.run->state.X, 3 * ROPE * sizeof *x);
  *step = e.run->step->length.dt;
  test_engine_close(&e);
}

static double distance(const double a[3 * ROPE], const double b[3 * ROPE]) {
  double sum = 0;
  for (size_t c = 0; c < 3 * ROPE; c++) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sqrt(sum / ROPE);
}

/* The chosen step is at least twenty times leapfrog's, and the error falls with its square. */
static void pins_slides_and_forces_that_come_late(void **state) {
  double exact[3 * ROPE], x[3][3 * ROPE], step[4], error[3];
  (void)state;
  end_of_rope("leapfrog", NAN, exact, &step[3]);
  end_of_rope("local_leapfrog", NAN, x[0], &step[0]);
  for (int k = 1; k < 3; k++) end_of_rope("local_leapfrog", step[0] / (k == 1 ? 2 : 4), x[k], &step[k]);
  for (int k = 0; k < 3; k++) error[k] = distance(x[k], exact);
  if (!(step[0] > 20 * step[3])) fail_msg("steps %g and %g s", step[0], step[3]);
  double order = log2(error[0] / error[2]) / 2;
  if (!(error[0] < 1e-3 && order > 1.7)) fail_msg("errors %g, %g, %g m", error[0], error[1], error[2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_step_below_the_stated_limit_grows),
      cmocka_unit_test(the_stated_limit_is_no_excuse),
      cmocka_unit_test(order_is_two_and_the_error_that_of_the_long_step),
      cmocka_unit_test(energy_stays_over_1e5_steps_and_momentum_to_rounding),
      cmocka_unit_test(where_nothing_is_stiff_it_is_leapfrog),
      cmocka_unit_test(it_is_reversible_and_not_symplectic),
      cmocka_unit_test(pins_slides_and_forces_that_come_late),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
