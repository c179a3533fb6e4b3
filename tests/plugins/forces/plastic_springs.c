/* Springs that yield and break: return mapping by hand and against differences, the area of a loop and the energy of
 * runs in closed form, with several methods; breaks, deaths, checkpoints and threads. */
#include "core/engine/contract/contract.h"
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double K = 100, YIELD = 0.05, H = 25; /* N/m, -, N/m; of springs 1 m long: they flow at 5 N */

static hk_plugin_spec *plastic(test_engine *e, const uint32_t (*edge)[2], size_t count) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "plastic_springs");
  test_edges(e, spec, edge, count);
  test_number(e, spec, "k", K);
  test_number(e, spec, "yield", YIELD);
  test_number(e, spec, "hardening", H);
  return spec;
}

static void launch(test_engine *e, uint32_t id, double x) { e->scene->particles.velocity[3 * (size_t)(id - 1)] = x; }

static double evolve(const hk_instance *springs, const hk_view *view, bool *changed) {
  hk_evolution report = {0};
  assert_int_equal(hk_force_of(springs->plugin)->internal.evolve(springs->self, view, 1e-3, &report), HK_OK);
  *changed = report.changed;
  return report.dissipated;
}

static double energy_of(const hk_instance *springs, const hk_view *view) {
  return springs->plugin->force->energy(springs->self, view);
}

/* Along x from the origin. */
static hk_instance *open_pair(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 1), test_particle(e, 1, 0, 0, 1);
  hk_plugin_spec *spec = plastic(e, (const uint32_t[][2]){{1, 2}}, 1);
  e->options.dt = 1e-3;
  test_run(e);
  return test_instance(e, spec);
}

/* 0.15 m longer: the trial force 15 N is 10 N too large, so 10/(100 + 25) = 0.08 m flow and 7 N = 5 N + 25 N/m 0.08 m
 * are left; 0.245 J are stored, 5 0.08 + 25 0.08^2/2 = 0.48 J lost. Then 0.14 m lie between flow in both senses. */
static void the_flow_by_hand(void **state) {
  (void)state;
  test_engine e;
  bool changed;
  double F[6];
  hk_instance *springs = open_pair(&e);
  hk_view view = force_view(&e, springs);
  double x[6] = {0, 0, 0, 1.15, 0, 0};
  view.x = x;
  for (int turn = 0; turn < 2; turn++) { /* before and after the flow is accepted; 1e-14: rounding of numbers near 1 */
    force_evaluate(springs, &view, F);
    assert_true(fabs(F[0] - 7) < 1e-13 && fabs(F[3] + 7) < 1e-13);
    assert_true(fabs(energy_of(springs, &view) - (turn ? 0.245 : 0.725)) < 1e-14);
    assert_true(fabs(evolve(springs, &view, &changed) - (turn ? 0 : 0.48)) < 1e-14 && !changed);
  }
  x[3] = 1.15 - 0.139;
  assert_true(fabs(evolve(springs, &view, &changed)) < 1e-14);
  x[3] = 1.15 - 0.141;
  assert_true(evolve(springs, &view, &changed) > 1e-3 * 7 * K / (K + H) * (1 - 1e-9));
  test_engine_close(&e);
}

/* The loop 0, a, -a, 0 in small steps: its area by the trapezoidal rule, whose error at the two kinds of kinks is below
 * k dl^2, is what was dissipated and what is stored at its end; the former is f_y g + H g^2/2 of all flow g, with
 * (k a - f_y)/(k + H) on the way out and (2 k a - 2 f_y - 2 H g)/(k + H) on the way back. */
static void the_area_of_a_loop_is_what_is_dissipated(void **state) {
  (void)state;
  enum { STEPS = 4000 };
  const double a = 0.15, corner[] = {0, a, -a, 0}, out = (K * a - 5) / (K + H),
               back = (2 * K * a - 2 * (5 + H * out)) / (K + H);
  test_engine e;
  double F[6], lost = 0, area = 0, last = 0, x[6] = {0};
  bool changed;
  hk_instance *springs = open_pair(&e);
  hk_view view = force_view(&e, springs);
  view.x = x;
  for (int leg = 0; leg < 3; leg++)
    for (int k = 1; k <= STEPS; k++) {
      double dl = (corner[leg + 1] - corner[leg]) / STEPS;
      x[3] = 1 + corner[leg] + k * dl;
      force_evaluate(springs, &view, F);
      area += (F[0] + last) / 2 * dl;
      last = F[0];
      lost += evolve(springs, &view, &changed);
    }
  double flow = out + back, closed = 5 * flow + H * flow * flow / 2;
  print_message("dissipated %.9f J, in closed form %.9f J; area less what is stored %.9f J\n", lost, closed,
                area - energy_of(springs, &view));
  assert_true(fabs(K * a - 5) > 0 && fabs(last) < 5 + H * flow); /* the last leg is elastic */
  assert_true(fabs(lost - closed) < 1e-11);
  assert_true(fabs(area - energy_of(springs, &view) - lost) < 4 * K * pow(2 * a / STEPS, 2));
  test_engine_close(&e);
}

enum { N = 6, S = 7 };

static void force_and_jacobian_are_derivatives_while_it_flows(void **state) {
  (void)state;
  static const double start[N][3] = {{0, 0, 0},       {1, 0.2, -0.1},  {0.3, 1.1, 0},
                                     {0.2, 0.3, 0.9}, {1.2, 1.3, 1.1}, {2, 1, 1}};
  static const uint32_t edge[S][2] = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {4, 2}, {4, 5}, {5, 6}};
  test_engine e;
  bool changed;
  double x[3 * N];
  test_engine_open(&e);
  for (int i = 0; i < N; i++) test_particle(&e, start[i][0], start[i][1], start[i][2], 1 + i);
  hk_plugin_spec *spec = plastic(&e, edge, S);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  view.x = x;
  for (int turn = 0; turn < 4; turn++) {
    for (int q = 0; q < 3 * N; q++) x[q] = e.run->state.X[q] + 0.2 * sin(1.7 * q + 3 * turn);
    double whole = energy_of(springs, &view);
    assert_true(force_gradient_error(springs, &view) < FORCE_DIFFERENCES);
    assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
    double lost = evolve(springs, &view, &changed);
    assert_true(lost > 0.01 && !changed && fabs(energy_of(springs, &view) + lost - whole) < 1e-13 * whole);
  }
  test_engine_close(&e);
}

/* ---- runs ---- */

/* A mass of 1 kg thrown at 3 m/s against a wall that a spring of 1 m joins it to. */
static void open_thrown(test_engine *e, const char *method, double dt) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 1), test_particle(e, 1, 0, 0, 1);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  launch(e, 2, 3);
  plastic(e, (const uint32_t[][2]){{1, 2}}, 1);
  test_plugin(e, HK_INTEGRATOR, method);
  e->scene->duration = 2;
  e->scene->fps = 20;
  e->options.dt = dt;
  test_run(e);
}

/* Of 4.5 J the first stretch leaves (f_y + H g)^2/2k stored and has lost f_y g + H g^2/2, which gives g. The balance
 * closes but for (h w)^2 = 1e-4 of the kinetic energy with methods of order 2, of which it gets the change of the force
 * alone, and for the kinks of the steps that the yield point lies in, k (h v)^2 = 1e-5 of it at most. */
static void a_thrown_mass_loses_what_the_flow_takes(void **state) {
  (void)state;
  static const struct {
    const char *method;
    double dt, drift;
  } cases[] = {{"leapfrog", 1e-3, 3e-5}, {"rk4", 1e-3, 1e-5}, {"implicit_midpoint", 1e-3, 3e-5}, {"bdf2", 1e-3, 1e-3}};
  double b = 5 * (1 + H / K), c = (H + H * H / K) / 2, g = (sqrt(b * b + 4 * c * (4.5 - 25 / (2 * K))) - b) / (2 * c);
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    test_engine e;
    hk_summary s;
    open_thrown(&e, cases[k].method, cases[k].dt);
    test_advance(&e, 0.3); /* a quarter of a swing later it is on its way back */
    assert_true(test_velocity(&e, 2)[0] < 0);
    double first = e.run->record.dissipated, closed = 5 * g + H * g * g / 2;
    test_advance(&e, 2);
    hk_run_close(e.run, &e.error);
    hk_run_summary(e.run, &s);
    print_message("%-18s first stretch %.7f J, in closed form %.7f J; in all %.4f J, drift %.1e\n", cases[k].method,
                  first, closed, -s.energy_work, s.energy_drift);
    assert_true(fabs(first - closed) < 10 * cases[k].drift);
    assert_true(fabs(s.energy_drift) < cases[k].drift);
    assert_true(s.energy_work < -3);
    test_engine_close(&e);
  }
}

static void expect_blocks(test_engine *e, const double *whole, size_t n) {
  hk_system *s = &e->run->dynamics.system;
  hk_matrix found = {0}, D = {0};
  double sum = 0, all = 0;
  assert_int_equal(s->linear->jacobian(s, s->t, s->X, 0, &found, &D), HK_OK);
  for (size_t r = 0; r < n; r++)
    for (size_t b = found.row_start[r]; b < found.row_start[r + 1]; b++)
      for (size_t q = 0; q < 9; q++) {
        double exact = whole[3 * n * (3 * r + q / 3) + 3 * found.column[b] + q % 3];
        assert_true(found.value[9 * b + q] == exact);
        sum += fabs(exact);
      }
  for (size_t q = 0; q < 9 * n * n; q++) all += fabs(whole[q]);
  assert_true(sum > 0 && fabs(sum - all) < 1e-9 * all); /* rounding of sums in two orders */
}

/* Three masses in a row, the last one thrown: one spring breaks, and what it stored is dissipated. The history that
 * leapfrog keeps, the force of before, is void: with it the balance would be off by h f v/2 = 0.01 J. The blocks of the
 * other spring, which is behind it in the list, are those that implicit methods get then. */
static void a_break_is_in_the_balance(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "rk4", "stoermer8", "implicit_midpoint", "bdf2", "dopri5"};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine e;
    hk_summary s;
    test_engine_open(&e);
    for (int i = 0; i < 3; i++) test_particle(&e, i, 0, 0, 1);
    test_pin(&e, HK_PIN_FIXED, 1, NULL);
    launch(&e, 3, 3);
    hk_plugin_spec *spec = plastic(&e, (const uint32_t[][2]){{2, 3}, {1, 2}}, 2);
    test_number(&e, spec, "breaking", 0.2);
    test_plugin(&e, HK_INTEGRATOR, methods[k]);
    e.scene->duration = 2;
    e.scene->fps = 20;
    if (strcmp(methods[k], "dopri5") != 0) e.options.dt = 1e-3;
    test_run(&e);
    test_advance(&e, 2);
    hk_instance *springs = test_instance(&e, spec);
    hk_view view = force_view(&e, springs);
    double K2[81], D2[81];
    size_t blocks = force_matrices(springs, &view, K2, D2);
    if (e.run->dynamics.system.linear) expect_blocks(&e, K2, 3);
    hk_run_close(e.run, &e.error);
    hk_run_summary(e.run, &s);
    print_message("%-18s %zu blocks, dissipated %.4f J, drift %.1e\n", methods[k], blocks, -s.energy_work,
                  s.energy_drift);
    assert_int_equal(blocks, 4); /* of one spring */
    assert_true(fabs(s.energy_drift) < 2e-4);
    test_engine_close(&e);
  }
}

/* Three pairs that know nothing of each other; one particle of the second dies. The others move to the same bits as
 * where nobody dies, and know how far they have flowed. */
static void open_pairs(test_engine *e, bool dies, const char *method) {
  test_engine_open(e);
  for (int i = 0; i < 6; i++) test_particle(e, i % 2, i / 2, 0, 1 + 0.1 * i);
  for (uint32_t id = 2; id <= 6; id += 2) launch(e, id, 1 + 0.5 * id);
  hk_plugin_spec *spec = plastic(e, (const uint32_t[][2]){{1, 2}, {3, 4}, {5, 6}}, 3);
  test_list(e, spec, "hardening", (double[]){H, 2 * H, 3 * H}, 3);
  if (dies) {
    hk_plugin_spec *reaper = test_plugin(e, HK_SOURCE, "fixture:reaper");
    test_number(e, reaper, "id", 3);
    test_number(e, reaper, "at", 0.2);
  }
  test_plugin(e, HK_INTEGRATOR, method);
  e->options.dt = 1e-3;
}

static void deaths_leave_the_other_springs_as_they_are(void **state) {
  (void)state;
  test_engine e[2];
  for (int dies = 0; dies < 2; dies++) {
    open_pairs(&e[dies], dies, "leapfrog");
    test_run(&e[dies]);
    test_advance(&e[dies], 0.5);
  }
  assert_null(test_position(&e[1], 3));
  const uint32_t ids[] = {1, 2, 5, 6};
  for (int k = 0; k < 4; k++)
    assert_memory_equal(test_position(&e[0], ids[k]), test_position(&e[1], ids[k]), 3 * sizeof(double));
  test_engine_close(&e[0]);
  test_engine_close(&e[1]);
}

/* From a checkpoint before the death, and from one behind it. */
static void a_resumed_run_goes_on_bit_by_bit(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "rk4", "stoermer8"};
  for (int k = 0; k < 6; k++) {
    test_engine a, b;
    char path[512];
    snprintf(path, sizeof path, "%s/pairs.checkpoint", test_folder());
    open_pairs(&a, true, methods[k / 2]);
    test_run(&a);
    test_advance(&a, k % 2 ? 0.35 : 0.15);
    assert_int_equal(hk_run_save(a.run, path, &a.error), HK_OK);
    open_pairs(&b, true, methods[k / 2]);
    b.scene->start_file = strdup(path);
    test_run(&b);
    test_advance(&a, 0.6);
    test_advance(&b, 0.6);
    assert_true(a.run->record.dissipated > 1 && a.run->record.dissipated == b.run->record.dissipated);
    assert_memory_equal(a.run->state.X, b.run->state.X, a.run->state.size * sizeof(double));
    test_engine_close(&a);
    test_engine_close(&b);
  }
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  enum { SIDE = 60, COUNT = SIDE * SIDE, EDGES = 2 * SIDE * (SIDE - 1) };
  static uint32_t edge[EDGES][2];
  double *first = NULL, lost = 0;
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    size_t count = 0;
    test_engine_open(&e);
    for (uint32_t i = 0; i < COUNT; i++) {
      launch(&e, test_particle(&e, i % SIDE, i / SIDE, 0, 1), 8 * sin(0.7 * i));
      if (i % SIDE) edge[count][0] = i, edge[count++][1] = i + 1;
      if (i >= SIDE) edge[count][0] = i + 1 - SIDE, edge[count++][1] = i + 1;
    }
    hk_plugin_spec *spec = plastic(&e, (const uint32_t(*)[2])edge, count);
    test_number(&e, spec, "breaking", 0.25);
    e.scene->threads = threads;
    e.options.dt = 1e-2;
    test_run(&e);
    test_advance(&e, 0.2);
    const hk_state *s = &e.run->state;
    if (!first) {
      first = malloc(s->size * sizeof *first);
      assert_non_null(first);
      memcpy(first, s->X, s->size * sizeof *first);
      lost = e.run->record.dissipated;
      assert_true(lost > 100);
    }
    assert_memory_equal(first, s->X, s->size * sizeof *first);
    assert_true(lost == e.run->record.dissipated);
    test_engine_close(&e);
  }
  free(first);
}

static void a_spring_of_no_length_is_refused(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  for (int i = 0; i < 3; i++) test_particle(&e, i / 2, 0, 0, 1);
  plastic(&e, (const uint32_t[][2]){{2, 3}, {1, 2}}, 2);
  e.options.dt = 1e-3;
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "rest: spring 2 has the length 0 at the start"));
  test_engine_close(&e);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    open_pairs(&e, false, "leapfrog");
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 1);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_flow_by_hand),
      cmocka_unit_test(the_area_of_a_loop_is_what_is_dissipated),
      cmocka_unit_test(force_and_jacobian_are_derivatives_while_it_flows),
      cmocka_unit_test(a_thrown_mass_loses_what_the_flow_takes),
      cmocka_unit_test(a_break_is_in_the_balance),
      cmocka_unit_test(deaths_leave_the_other_springs_as_they_are),
      cmocka_unit_test(a_resumed_run_goes_on_bit_by_bit),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(a_spring_of_no_length_is_refused),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
