/* The service neighbours/1 in runs: a Lennard-Jones fluid (tests/fixtures/lennard_jones.c) and a drag that shares its
 * list at another radius (tests/fixtures/crowd_drag.c). Rows are compared with the loop over all pairs, without a
 * tolerance; trajectories with each other, bit by bit. */
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- a fluid: side^3 particles of 1 kg on a lattice, with random velocities and no momentum ---- */

typedef struct fluid {
  test_engine e;
  hk_plugin_spec *pairs;
  size_t n;
} fluid;

static void velocities(double *v, size_t n, double speed) {
  uint64_t seed[4];
  double mean[3] = {0};
  hk_random_seed(seed, 11);
  for (size_t k = 0; k < 3 * n; k++) {
    v[k] = speed * (2 * hk_random_uniform(seed) - 1);
    mean[k % 3] += v[k] / (double)n;
  }
  for (size_t k = 0; k < 3 * n; k++) v[k] -= mean[k % 3];
}

static void open_fluid(fluid *f, size_t side, double spacing, double speed) {
  size_t n = side * side * side;
  double *x = malloc(3 * n * sizeof *x), *v = malloc(3 * n * sizeof *v);
  uint32_t first;
  test_engine_open(&f->e);
  f->n = n;
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0, at = i; c < 3; c++, at /= side) x[3 * i + c] = spacing * (double)(at % side);
  velocities(v, n, speed);
  assert_int_equal(hk_scene_add_particles(f->e.scene, n, x, v, NULL, 1, 0, &first, &f->e.error), HK_OK);
  f->pairs = test_plugin(&f->e, HK_FORCE, "fixture:lennard_jones");
  f->e.options.dt = 0.002;
  f->e.scene->fps = 50;
  f->e.scene->duration = 100;
  free(x);
  free(v);
}

/* Dense and lively enough that rows are found again many times in a second. */
static void open_liquid(fluid *f) { open_fluid(f, 6, 1.2, 1.5); }

static void close_fluid(fluid *f) { test_engine_close(&f->e); }

static hk_instance *service_of(test_engine *e) {
  const hk_instances *services = &e->run->plugins.kind[HK_SERVICE];
  assert_int_equal(services->count, 1);
  return services->item[0];
}

static const hk_neighbours *table_of(test_engine *e) {
  hk_instance *service = service_of(e);
  return service->plugin->service->table(service->self);
}

static hk_neighbour_rows rows_at(test_engine *e, const double *x) {
  const hk_neighbours *table = table_of(e);
  hk_neighbour_rows rows;
  if (table->rows(table->self, hk_run_view(e->run), x, &rows) != HK_OK) fail_msg("%s", e->run->error.text);
  return rows;
}

static double distance2(const double *x, size_t i, size_t j) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) sum += (x[3 * j + c] - x[3 * i + c]) * (x[3 * j + c] - x[3 * i + c]);
  return sum;
}

/* Row i, of those within the radius, is what the loop over all finds; it rises, and reaches no further than it says. */
static size_t check_row(const hk_neighbour_rows *rows, const double *x, size_t i, double radius) {
  size_t k = rows->row_start[i], within = 0;
  for (size_t j = 0; j < rows->n; j++) {
    bool listed = k < rows->row_start[i + 1] && rows->other[k] == j;
    k += listed;
    if (j == i || !(distance2(x, i, j) < radius * radius)) continue;
    if (!listed) fail_msg("row %zu lacks %zu, %g m away", i, j, sqrt(distance2(x, i, j)));
    within++;
  }
  if (k != rows->row_start[i + 1]) fail_msg("row %zu does not rise, or names itself or a stranger", i);
  return within;
}

static void check_rows(const hk_neighbour_rows *rows, const double *x, double radius) {
  for (size_t i = 0; i < rows->n; i++) check_row(rows, x, i, radius);
}

/* ---- the skin ---- */

static void no_pair_is_ever_missed_over_a_random_motion(void **state) {
  (void)state;
  enum { MOVES = 300 };
  fluid f;
  uint64_t seed[4];
  open_liquid(&f);
  test_run(&f.e);
  double *x = malloc(3 * f.n * sizeof *x);
  memcpy(x, hk_run_view(f.e.run)->x, 3 * f.n * sizeof *x);
  hk_random_seed(seed, 5);
  uint64_t before = rows_at(&f.e, x).number, found = 0;
  for (int m = 0; m < MOVES; m++) {
    for (size_t k = 0; k < 3 * f.n; k++) x[k] += 0.06 * (hk_random_uniform(seed) - 0.5);
    hk_neighbour_rows rows = rows_at(&f.e, x);
    check_rows(&rows, x, 2.5);
    found = rows.number - before;
  }
  assert_true(found > 5 && found < MOVES / 2); /* a walk of 300 steps: it was kept, and it had to be found again */
  free(x);
  close_fluid(&f);
}

static void rows_last_until_one_particle_has_moved_by_half_the_skin(void **state) {
  (void)state;
  fluid f;
  open_liquid(&f);
  test_number(&f.e, test_plugin(&f.e, HK_SERVICE, "neighbours"), "skin", 0.2);
  test_run(&f.e);
  double *x = malloc(3 * f.n * sizeof *x), half = 2.5 * 0.2 / 2;
  memcpy(x, hk_run_view(f.e.run)->x, 3 * f.n * sizeof *x);
  x[0] += 5; /* far from its place at the start */
  hk_neighbour_rows rows = rows_at(&f.e, x);
  uint64_t number = rows.number;
  assert_true(fabs(rows.reach - 2.5 * 1.2) < 1e-8); /* the service's margin for rounding is 1e-9 of it */
  x[3 * 77 + 1] += 0.999 * half;
  assert_int_equal(rows_at(&f.e, x).number, number);
  x[3 * 77 + 1] += 0.002 * half;
  assert_int_equal(rows_at(&f.e, x).number, number + 1);
  free(x);
  close_fluid(&f);
}

static void copy_state(test_engine *e, double *X, size_t size) {
  assert_int_equal(e->run->state.size, size);
  memcpy(X, e->run->state.X, size * sizeof *X);
}

/* When rows are found, and how far they reach, leaves no trace in a trajectory. */
static void trajectories_do_not_depend_on_the_skin(void **state) {
  (void)state;
  const double skin[] = {0, 0.05, 0.2, 1};
  enum { SIZE = 6 * 216 + 1 };
  double first[SIZE], X[SIZE];
  uint64_t found[4];
  for (int k = 0; k < 4; k++) {
    fluid f;
    open_liquid(&f);
    test_number(&f.e, test_plugin(&f.e, HK_SERVICE, "neighbours"), "skin", skin[k]);
    test_run(&f.e);
    test_advance(&f.e, 0.5);
    copy_state(&f.e, k ? X : first, SIZE);
    found[k] = rows_at(&f.e, hk_run_view(f.e.run)->x).number;
    if (k) assert_memory_equal(X, first, sizeof X);
    close_fluid(&f);
  }
  assert_true(found[0] > 200 && found[0] > found[1] && found[1] > found[2] && found[2] > found[3]);
}

/* ---- one list for all ---- */

static const hk_publication *published(test_engine *e, const char *label, const char *name) {
  const hk_model *model = hk_run_view(e->run)->model;
  for (size_t k = 0; k < model->publications; k++)
    if (strcmp(model->published[k].label, label) == 0 && strcmp(model->published[k].name, name) == 0)
      return &model->published[k];
  fail_msg("%s publishes no '%s'", label, name);
  return NULL;
}

/* As of the last evaluation, which is made here for the present state. */
static void evaluate(test_engine *e) {
  hk_system *s = &e->run->dynamics.system;
  double *X = malloc(s->size * sizeof *X), *dX = malloc(s->size * sizeof *dX);
  memcpy(X, s->X, s->size * sizeof *X);
  assert_int_equal(s->rates(s, s->t, X, dX), HK_OK);
  free(X);
  free(dX);
}

static size_t count_within(const double *x, size_t n, size_t i, double radius) {
  size_t count = 0;
  for (size_t j = 0; j < n; j++) count += j != i && distance2(x, i, j) < radius * radius;
  return count;
}

static void check_counts(test_engine *e, const char *label, const char *name, double radius) {
  const hk_view *view = hk_run_view(e->run);
  const hk_publication *p = published(e, label, name);
  assert_int_equal(p->width, 1);
  for (size_t i = 0; i < view->n; i++)
    assert_true((*p->values)[i] == (double)count_within(view->x, view->n, i, radius));
}

/* The drag stands before and behind the fluid in the scene; its radius is the smaller and the larger one. */
static void clients_with_different_radii_share_one_list(void **state) {
  (void)state;
  const double radius[] = {1.5, 4};
  for (int k = 0; k < 2; k++) {
    fluid f;
    open_liquid(&f);
    hk_plugin_spec *drag = test_plugin(&f.e, HK_FORCE, "fixture:crowd_drag");
    test_number(&f.e, drag, "radius", radius[k]);
    test_run(&f.e);
    test_advance(&f.e, 0.1);
    evaluate(&f.e);
    check_counts(&f.e, "lennard_jones", "neighbours", 2.5);
    check_counts(&f.e, "crowd_drag", "crowd", radius[k]);
    assert_true(fabs(rows_at(&f.e, hk_run_view(f.e.run)->x).reach / fmax(2.5, radius[k]) - 1.1) < 1e-8);
    close_fluid(&f);
  }
}

/* F = -rate N v with the published N, by hand; rounding of one product. */
static void a_force_reads_what_another_publishes(void **state) {
  (void)state;
  fluid f;
  double F[3 * 216];
  open_liquid(&f);
  hk_plugin_spec *drag = test_plugin(&f.e, HK_FORCE, "fixture:crowd_drag");
  test_number(&f.e, drag, "rate", 0.3);
  test_run(&f.e);
  evaluate(&f.e);
  hk_instance *instance = test_instance(&f.e, drag);
  hk_view view = force_view(&f.e, instance);
  force_evaluate(instance, &view, F);
  for (size_t e = 0; e < 3 * f.n; e++) {
    double wanted = -0.3 * (double)count_within(view.x, f.n, e / 3, 2.5) * view.v[e];
    assert_true(fabs(F[e] - wanted) <= 1e-15 * fabs(wanted));
  }
  close_fluid(&f);
}

static void what_nobody_publishes_is_an_error(void **state) {
  (void)state;
  fluid f;
  open_liquid(&f);
  test_text(&f.e, test_plugin(&f.e, HK_FORCE, "fixture:crowd_drag"), "of", "gravity");
  assert_int_equal(hk_run_open(f.e.scene, &f.e.options, &f.e.run, &f.e.error), HK_BAD_PARAM);
  assert_non_null(strstr(f.e.error.text, "crowd_drag: of: no plugin 'gravity' publishes 'neighbours'"));
  close_fluid(&f);
}

/* The list's time is known, and part of the run's. */
static void the_summary_knows_the_time_of_the_search(void **state) {
  (void)state;
  fluid f;
  hk_summary summary;
  open_liquid(&f);
  test_run(&f.e);
  test_advance(&f.e, 0.2);
  hk_run_summary(f.e.run, &summary);
  double search = 0;
  for (size_t k = 0; k < summary.plugins; k++)
    if (strcmp(summary.plugin[k].kind, "service") == 0) search = summary.plugin[k].seconds;
  assert_true(search > 0 && search < summary.step_wall_s + summary.wall_s);
  close_fluid(&f);
}

/* ---- births and deaths ---- */

/* Fountains above the fluid, far enough from each other and in time that nobody is born onto another. */
static void add_fountains(fluid *f, double lifetime) {
  for (int k = 0; k < 3; k++) {
    hk_plugin_spec *emitter = test_plugin(&f->e, HK_SOURCE, "fixture:spout");
    test_number(&f->e, emitter, "every", 1.3);
    test_vector(&f->e, emitter, "position", 3 * k, 2, 9);
    if (k == 0) test_number(&f->e, emitter, "lifetime", lifetime);
  }
}

static void births_and_deaths_keep_rows_and_published_fields_right(void **state) {
  (void)state;
  fluid f;
  open_fluid(&f, 4, 1.2, 0.5);
  add_fountains(&f, 0.07);
  test_number(&f.e, test_plugin(&f.e, HK_FORCE, "fixture:crowd_drag"), "radius", 3);
  test_run(&f.e);
  for (int frame = 1; frame <= 150; frame++) {
    test_advance(&f.e, frame / 50.);
    const hk_view *view = hk_run_view(f.e.run);
    hk_neighbour_rows rows = rows_at(&f.e, view->x);
    assert_int_equal(rows.n, view->n);
    check_rows(&rows, view->x, 3);
    evaluate(&f.e);
    check_counts(&f.e, "lennard_jones", "neighbours", 2.5);
    check_counts(&f.e, "crowd_drag", "crowd", 3);
  }
  uint32_t dead = hk_run_view(f.e.run)->model->id[0] - 1;
  assert_true(dead >= 40 && dead <= 43);                        /* one in 0.07 s, for 3 s */
  assert_int_equal(hk_run_view(f.e.run)->n, 64 + 3 * 3 - dead); /* born at 0, 1.3 and 2.6 s */
  close_fluid(&f);
}

static void density_is_that_of_a_ball(void **state) {
  (void)state;
  fluid f;
  open_liquid(&f);
  test_run(&f.e);
  evaluate(&f.e);
  const hk_view *view = hk_run_view(f.e.run);
  const hk_publication *p = published(&f.e, "lennard_jones", "density");
  double ball = 4 * acos(-1) / 3 * 2.5 * 2.5 * 2.5;
  for (size_t i = 0; i < f.n; i++) {
    double wanted = (1 + (double)count_within(view->x, f.n, i, 2.5)) / ball;
    assert_true(fabs((*p->values)[i] - wanted) < 1e-14 * wanted); /* some roundings */
  }
  close_fluid(&f);
}

static void few_particles_and_none(void **state) {
  (void)state;
  for (uint32_t n = 0; n < 3; n++) {
    test_engine e;
    test_engine_open(&e);
    for (uint32_t i = 0; i < n; i++) test_particle(&e, i, 0, 0, 1);
    test_number(&e, test_plugin(&e, HK_SOURCE, "fixture:sower"), "every", 100); /* a scene may begin empty with one */
    test_plugin(&e, HK_FORCE, "fixture:lennard_jones");
    e.options.dt = 1e-3;
    test_run(&e);
    test_advance(&e, 0.05);
    hk_neighbour_rows rows = rows_at(&e, hk_run_view(e.run)->x);
    assert_int_equal(rows.n, n);
    assert_int_equal(rows.row_start[n], n == 2 ? 2 : 0);
    test_engine_close(&e);
  }
}

/* ---- threads, checkpoints ---- */

static void any_number_of_threads_gives_the_same_bits(void **state) {
  (void)state;
  enum { SIDE = 11, SIZE = 6 * SIDE * SIDE * SIDE + 1 };
  double *first = malloc(SIZE * sizeof *first), *X = malloc(SIZE * sizeof *X);
  for (int threads = 1; threads <= 3; threads++) {
    fluid f;
    open_fluid(&f, SIDE, 1.15, 1.5);
    f.e.scene->threads = threads;
    test_run(&f.e);
    test_advance(&f.e, 0.5);
    copy_state(&f.e, threads > 1 ? X : first, SIZE);
    if (threads > 1) assert_memory_equal(X, first, SIZE * sizeof *X);
    assert_true(rows_at(&f.e, hk_run_view(f.e.run)->x).number > 3);
    close_fluid(&f);
  }
  free(first);
  free(X);
}

static void open_for_checkpoint(fluid *f, const char *from) {
  open_fluid(f, 5, 1.2, 1.5);
  add_fountains(f, 0.23);
  test_plugin(&f->e, HK_FORCE, "fixture:crowd_drag");
  if (from) f->e.scene->start_file = strdup(from);
  test_run(&f->e);
}

/* Not the state alone: the rows and their number are those of the run that did not stop, though it found them for
 * positions of long ago. */
static void a_resumed_run_goes_on_bit_by_bit(void **state) {
  (void)state;
  fluid a, b;
  char path[512];
  snprintf(path, sizeof path, "%s/fluid.checkpoint", test_folder());
  open_for_checkpoint(&a, NULL);
  test_advance(&a.e, 1.46);
  assert_int_equal(hk_run_save(a.e.run, path, &a.e.error), HK_OK);
  open_for_checkpoint(&b, path);
  for (int k = 0; k < 2; k++) {
    hk_neighbour_rows p = rows_at(&a.e, hk_run_view(a.e.run)->x), q = rows_at(&b.e, hk_run_view(b.e.run)->x);
    size_t size = a.e.run->state.size;
    assert_int_equal(size, b.e.run->state.size);
    assert_memory_equal(a.e.run->state.X, b.e.run->state.X, size * sizeof(double));
    assert_int_equal(p.number, q.number);
    assert_memory_equal(p.row_start, q.row_start, (p.n + 1) * sizeof *p.row_start);
    assert_memory_equal(p.other, q.other, p.row_start[p.n] * sizeof *p.other);
    if (k) break;
    test_advance(&a.e, 2.8); /* with births and deaths in it */
    test_advance(&b.e, 2.8);
  }
  close_fluid(&a);
  close_fluid(&b);
}

/* ---- the fluid's physics ---- */

/* Two particles on a line at the distance r: the force on the second and the energy of the pair, by bc with 20 digits
 * from V = 4 (r^-12 - r^-6), less V and V' at 2.5. Some roundings of numbers up to 50. */
static void two_particles_by_hand(void **state) {
  (void)state;
  const double table[][3] = {
      {1, 24.0389994774528, 0.0748161073152}, {1.5, -1.1190293535933555, -0.2650202256897747}, {2.5, 0, 0}, {3, 0, 0}};
  for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
    test_engine e;
    double F[6];
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, 0, table[k][0], 0, 1);
    hk_plugin_spec *pairs = test_plugin(&e, HK_FORCE, "fixture:lennard_jones");
    e.options.dt = 1e-3;
    test_run(&e);
    hk_instance *instance = test_instance(&e, pairs);
    hk_view view = force_view(&e, instance);
    force_evaluate(instance, &view, F);
    assert_true(fabs(F[4] - table[k][1]) < 1e-13 && F[1] == -F[4] && F[0] == 0 && F[5] == 0);
    assert_true(fabs(instance->plugin->force->energy(instance->self, &view) - table[k][2]) < 1e-14);
    test_engine_close(&e);
  }
}

/* Derivatives of r^-13 of higher order are up to 14 * 15 of the first, where springs have some tens. */
static void force_is_minus_energy_gradient(void **state) {
  (void)state;
  fluid f;
  open_fluid(&f, 3, 1.2, 2);
  test_run(&f.e);
  test_advance(&f.e, 0.1); /* off the lattice */
  hk_instance *instance = test_instance(&f.e, f.pairs);
  hk_view view = force_view(&f.e, instance);
  double error = force_gradient_error(instance, &view);
  if (!(error < 10 * FORCE_DIFFERENCES)) fail_msg("the force is off by %g", error);
  close_fluid(&f);
}

/* Rounding: 1e-16 of every change of momentum, of 216 particles over 1000 steps, at random. */
static void momentum_is_kept(void **state) {
  (void)state;
  fluid f;
  hk_summary s;
  open_liquid(&f);
  test_run(&f.e);
  test_advance(&f.e, 2);
  hk_run_summary(f.e.run, &s);
  if (!(s.momentum_drift < 1e-12)) fail_msg("momentum drifts by %g of its scale", s.momentum_drift);
  close_fluid(&f);
}

/* Largest |E - E(0)| at frames, J. */
static double energy_error(double dt, double end, double *late) {
  fluid f;
  double kinetic, potential, work, first, largest = 0;
  open_liquid(&f);
  f.e.options.dt = dt;
  test_run(&f.e);
  hk_run_energy(f.e.run, &kinetic, &potential, &work);
  first = kinetic + potential;
  *late = 0;
  for (int frame = 1; frame <= 50 * end; frame++) {
    test_advance(&f.e, frame / 50.);
    hk_run_energy(f.e.run, &kinetic, &potential, &work);
    double off = fabs(kinetic + potential - first);
    largest = fmax(largest, off);
    if (frame > 25 * end) *late = fmax(*late, off);
  }
  close_fluid(&f);
  return largest;
}

/* Half the step, a quarter of the error: trajectories are the same to far below it for half a second. And over some
 * thousand steps the error stays what it was: a tenth of a percent of the kinetic energy of some 160 J. */
static void leapfrog_keeps_the_energy_with_order_2_and_without_drift(void **state) {
  (void)state;
  double late, coarse = energy_error(0.004, 0.5, &late), fine = energy_error(0.002, 0.5, &late);
  if (!(coarse / fine > 3.4 && coarse / fine < 4.6)) fail_msg("%g J and %g J: not of order 2", coarse, fine);
  double all = energy_error(0.004, 10, &late);
  if (!(late < 0.16 && all < 0.16)) fail_msg("the energy is off by %g J, %g J late", all, late);
}

/* ---- the longest step ---- */

/* The fixture itself fails when a step is longer than it allows. Without the demand steps are of 0.02 s; with it they
 * follow the fastest particle: 0.01 m at up to some 4 m/s. */
static void no_step_is_longer_than_a_force_allows(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "dopri5", "cvode:method=adams", "arkode"};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    fluid f;
    hk_summary s;
    open_fluid(&f, 3, 1.2, 2);
    test_number(&f.e, f.pairs, "courant", 0.01);
    f.e.options.integrator = methods[k];
    f.e.options.dt = strcmp(methods[k], "leapfrog") == 0 ? 0.02 : NAN;
    f.e.options.tol = 1e-3;
    test_run(&f.e);
    test_advance(&f.e, 0.4);
    hk_run_summary(f.e.run, &s);
    if (!(s.dt_max < 0.008 && s.steps > 50)) fail_msg("%s: %zu steps of up to %g s", methods[k], s.steps, s.dt_max);
    close_fluid(&f);
  }
}

/* All are at rest, so that steps are long; then one is born at 1 m/s, and already its first step has to be shorter. */
static void a_newborn_shortens_the_very_first_step(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "dopri5"};
  for (int k = 0; k < 2; k++) {
    fluid f;
    hk_summary s;
    open_fluid(&f, 2, 30, 0);
    test_number(&f.e, f.pairs, "courant", 0.005);
    hk_plugin_spec *emitter = test_plugin(&f.e, HK_SOURCE, "fixture:spout");
    test_number(&f.e, emitter, "every", 10);
    test_vector(&f.e, emitter, "position", 10, 10, 10);
    f.e.options.integrator = methods[k];
    f.e.options.dt = 0.02;
    test_run(&f.e);
    test_advance(&f.e, 0.2);
    hk_run_summary(f.e.run, &s);
    if (!(s.dt_max <= 0.005 * (1 + 1e-9) && s.steps >= 40)) fail_msg("%s: a step of %g s", methods[k], s.dt_max);
    close_fluid(&f);
  }
}

/* 1e-20 m in a step: no step of that length moves the time. */
static void a_demand_that_stops_the_time_ends_the_run(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "dopri5"};
  for (int k = 0; k < 2; k++) {
    fluid f;
    open_fluid(&f, 2, 1.2, 1);
    f.e.options.integrator = methods[k];
    f.e.scene->fps = 1;
    hk_plugin_spec *late = test_plugin(&f.e, HK_FORCE, "fixture:lennard_jones");
    test_number(&f.e, late, "courant", 1e-20);
    late->from = 0.5;
    test_run(&f.e);
    assert_int_equal(hk_run_advance(f.e.run, 1, &f.e.error), HK_NOT_CONVERGED);
    if (!strstr(f.e.error.text, "too short to move t = 0.5 s")) fail_msg("%s: %s", methods[k], f.e.error.text);
    close_fluid(&f);
  }
}

/* Steps of 1e-4 s after 1e6 s, where times are rounded to 1e-10 s: the method is not blamed for that. */
static void short_steps_late_in_a_run_are_believed(void **state) {
  (void)state;
  fluid f;
  open_fluid(&f, 2, 30, 0.01);
  test_number(&f.e, f.pairs, "courant", 1e-6);
  f.pairs->from = 1e6;
  f.e.scene->fps = 1e-7;
  f.e.scene->duration = 1e7;
  f.e.options.dt = 1e7;
  test_run(&f.e);
  test_advance(&f.e, 1e6 + 0.01);
  assert_true(f.e.run->record.steps > 50);
  close_fluid(&f);
}

/* ---- what goes wrong ---- */

static void a_position_that_is_no_number_names_the_particle(void **state) {
  (void)state;
  const double bad[] = {NAN, INFINITY, -INFINITY};
  for (int k = 0; k < 3; k++) {
    fluid f;
    hk_neighbour_rows rows;
    open_liquid(&f);
    test_run(&f.e);
    const hk_view *view = hk_run_view(f.e.run);
    double *x = malloc(3 * f.n * sizeof *x);
    memcpy(x, view->x, 3 * f.n * sizeof *x);
    uint64_t number = rows_at(&f.e, x).number;
    x[3 * 41 + 1] = bad[k];
    const hk_neighbours *table = table_of(&f.e);
    assert_int_equal(table->rows(table->self, view, x, &rows), HK_NOT_FINITE);
    assert_non_null(strstr(f.e.run->error.text, "neighbours: particle 42 is at"));
    assert_int_equal(rows_at(&f.e, view->x).number, number); /* a failed call changes nothing */
    free(x);
    close_fluid(&f);
  }
}

static void a_radius_that_is_none_is_refused(void **state) {
  (void)state;
  const double bad[] = {-1, NAN, INFINITY, 1e200, 1e-200};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    fluid f;
    open_liquid(&f);
    test_run(&f.e);
    const hk_neighbours *table = table_of(&f.e);
    assert_int_equal(table->reach(table->self, bad[k]), HK_BAD_PARAM);
    assert_non_null(strstr(f.e.run->error.text, "give it a radius"));
    close_fluid(&f);
  }
}

static void no_radius_at_all_has_empty_rows(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  for (int i = 0; i < 3; i++) test_particle(&e, 1, 2, 3, 1);
  test_plugin(&e, HK_FORCE, "gravity");
  e.options.dt = 1e-3;
  test_run(&e);
  const hk_neighbours *table = e.run->shared.query(e.run->shared.context, "neighbours/1");
  assert_non_null(table);
  assert_int_equal(table->reach(table->self, 0), HK_OK);
  assert_int_equal(rows_at(&e, hk_run_view(e.run)->x).row_start[3], 0);
  assert_int_equal(table->reach(table->self, 0.1), HK_OK);
  assert_int_equal(rows_at(&e, hk_run_view(e.run)->x).row_start[3], 6); /* three in one place */
  test_engine_close(&e);
}

static void a_service_that_is_not_there_is_null(void **state) {
  (void)state;
  static const char *const names[] = {"neighbours/2", "neighbours", "neighbour/1", "", "/", "../forces/gravity/1"};
  fluid f;
  open_liquid(&f);
  test_run(&f.e);
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    assert_null(f.e.run->shared.query(f.e.run->shared.context, names[k]));
    assert_int_equal(f.e.run->error.status, HK_OK);
  }
  service_of(&f.e); /* and there is one as before */
  close_fluid(&f);
}

/* An installation without plugins/services. */
static void the_client_says_which_service_it_lacks(void **state) {
  (void)state;
  char root[512], command[2048];
  hk_registry few;
  fluid f;
  snprintf(root, sizeof root, "%s/few", test_folder());
  snprintf(command, sizeof command,
           "mkdir -p '%s/integrators' && cp " HK_BUILD "/plugins/integrators/leapfrog.so '%s/integrators'", root, root);
  assert_int_equal(system(command), 0);
  open_liquid(&f);
  assert_int_equal(hk_registry_open(&few, root, NULL, &f.e.error), HK_OK);
  f.e.scene->registry = &few;
  f.e.options.integrator = "leapfrog";
  assert_int_equal(hk_run_open(f.e.scene, &f.e.options, &f.e.run, &f.e.error), HK_FAILED);
  if (!strstr(f.e.error.text, "lennard_jones: it needs the service 'neighbours/1'")) fail_msg("%s", f.e.error.text);
  hk_registry_close(&few);
  close_fluid(&f);
}

static void a_service_that_nobody_asks_for_is_not_started(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_plugin(&e, HK_FORCE, "gravity");
  test_plugin(&e, HK_SERVICE, "neighbours");
  test_run(&e);
  assert_int_equal(e.run->plugins.kind[HK_SERVICE].count, 0);
  assert_int_equal(e.run->warnings.count, 1);
  assert_string_equal(e.run->warnings.text[0], "neighbours: no plugin of the scene asks for this service");
  test_engine_close(&e);
}

/* The k-th allocation of a plugin fails, for every k until the run opens and goes: a status and a cause each time. */
static void without_memory_the_run_says_so(void **state) {
  (void)state;
  long k = 1;
  for (bool went = false; !went; k++) {
    fluid f;
    open_fluid(&f, 4, 1.2, 0.5);
    f.e.options.allocations = k;
    f.e.options.integrator = "symplectic_euler";
    hk_status status = hk_run_open(f.e.scene, &f.e.options, &f.e.run, &f.e.error);
    if (status == HK_OK) status = hk_run_advance(f.e.run, 0.2, &f.e.error);
    went = status == HK_OK;
    if (!went && (status != HK_NO_MEMORY || !strstr(f.e.error.text, "no memory")))
      fail_msg("allocation %ld: status %d, %s", k, (int)status, f.e.error.text);
    close_fluid(&f);
  }
  assert_true(k > 8);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_pair_is_ever_missed_over_a_random_motion),
      cmocka_unit_test(rows_last_until_one_particle_has_moved_by_half_the_skin),
      cmocka_unit_test(trajectories_do_not_depend_on_the_skin),
      cmocka_unit_test(clients_with_different_radii_share_one_list),
      cmocka_unit_test(a_force_reads_what_another_publishes),
      cmocka_unit_test(what_nobody_publishes_is_an_error),
      cmocka_unit_test(the_summary_knows_the_time_of_the_search),
      cmocka_unit_test(births_and_deaths_keep_rows_and_published_fields_right),
      cmocka_unit_test(density_is_that_of_a_ball),
      cmocka_unit_test(few_particles_and_none),
      cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
      cmocka_unit_test(a_resumed_run_goes_on_bit_by_bit),
      cmocka_unit_test(two_particles_by_hand),
      cmocka_unit_test(force_is_minus_energy_gradient),
      cmocka_unit_test(momentum_is_kept),
      cmocka_unit_test(leapfrog_keeps_the_energy_with_order_2_and_without_drift),
      cmocka_unit_test(no_step_is_longer_than_a_force_allows),
      cmocka_unit_test(a_newborn_shortens_the_very_first_step),
      cmocka_unit_test(a_demand_that_stops_the_time_ends_the_run),
      cmocka_unit_test(short_steps_late_in_a_run_are_believed),
      cmocka_unit_test(a_position_that_is_no_number_names_the_particle),
      cmocka_unit_test(a_radius_that_is_none_is_refused),
      cmocka_unit_test(no_radius_at_all_has_empty_rows),
      cmocka_unit_test(a_service_that_is_not_there_is_null),
      cmocka_unit_test(the_client_says_which_service_it_lacks),
      cmocka_unit_test(a_service_that_nobody_asks_for_is_not_started),
      cmocka_unit_test(without_memory_the_run_says_so),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
