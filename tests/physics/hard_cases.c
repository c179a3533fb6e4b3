/* Hard cases for the implicit methods: each is right by a bound that is known beforehand, or fails loudly, with a
 * status that says so and a reason that names step, time and place. `ok` with a wrong answer is the failure.
 *
 * The bounds. A mode of frequency w that is resolved (h w < 1) is off after the time T by the leading term of its
 * growth and of its phase, as a part of its amplitude: h w^2 T/2 for Euler's rules, h^2 w^3 T/3 for BDF2, less for the
 * others of order 2. Twice that is allowed to what is nonlinear. Adaptive methods keep tol x extent per step, with less
 * than a hundred steps a period: 100 w T tol is added. A network's w is bounded by Gershgorin's circles: w^2 <= 2 sum
 * k/m. Modes that are not resolved are to stay at their equilibrium, and the slow ones obey the same bound with their
 * own w.
 */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum {
  MOST = 128,
  FULL = 1,
  SPRINGS = 2,
  YARDSTICK = 4,
  DAMPS = 8,
  ADAPTIVE = 16,
  SWEEPS = 32,
  EVERY = FULL | SPRINGS | YARDSTICK
};

static const double G = 9.81;

/* DAMPS: unresolved modes die out, so that a motion ends where it should. SPRINGS: needs the forces' elements. SWEEPS:
 * a fixed number of iterations, which may not be enough; a warning is then loud enough. */
static const struct method {
  const char *name;
  int order;
  unsigned flags;
} methods[] = {
    {"backward_euler", 1, FULL | DAMPS},
    {"implicit_midpoint", 2, FULL},
    {"implicit_trapezoid", 2, FULL},
    {"bdf2", 2, FULL | DAMPS},
    {"tr_bdf2", 2, FULL | DAMPS | ADAPTIVE},
    {"esdirk4", 4, FULL | DAMPS | ADAPTIVE},
    {"imex", 2, FULL | DAMPS},
    {"baraff_witkin", 1, FULL | DAMPS | ADAPTIVE},
    {"local_global", 1, SPRINGS | DAMPS | SWEEPS},
    {"xpbd", 1, SPRINGS | DAMPS | SWEEPS},
    {"desbrun", 1, SPRINGS},
    {"cvode", 5, YARDSTICK | ADAPTIVE},
};
enum { METHODS = sizeof methods / sizeof *methods };

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53 - 0.5;
}

/* ---- scenes ---- */

static hk_plugin_spec *link_edges(test_engine *e, const uint32_t (*edge)[2], size_t edges, double k, double c,
                                  double rest) {
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, edge, edges);
  test_number(e, springs, "k", k);
  test_number(e, springs, "damping", c);
  if (!isnan(rest)) test_number(e, springs, "rest", rest);
  return springs;
}

/* nx x ny particles at `spacing`, shaken by `shake`; structural and one diagonal's springs. */
static void grid(test_engine *e, uint32_t nx, uint32_t ny, double spacing, double shake, double mass, double k,
                 double c, double rest) {
  uint32_t edge[4 * MOST][2];
  uint64_t seed = 5;
  size_t edges = 0;
  uint32_t first = (uint32_t)e->scene->particles.n;
  for (uint32_t j = 0; j < ny; j++)
    for (uint32_t i = 0; i < nx; i++) {
      double at[3] = {spacing * i, spacing * j, 0};
      for (int q = 0; q < 3; q++) at[q] += shake * noise(&seed);
      uint32_t a = test_particle(e, at[0], at[1], at[2], mass);
      if (i + 1 < nx) edge[edges][0] = a, edge[edges++][1] = a + 1;
      if (j + 1 < ny) edge[edges][0] = a, edge[edges++][1] = a + nx;
      if (i + 1 < nx && j + 1 < ny) edge[edges][0] = a, edge[edges++][1] = a + nx + 1;
    }
  assert_true(e->scene->particles.n - first == (size_t)nx * ny);
  link_edges(e, (const uint32_t(*)[2])edge, edges, k, c, rest);
}

static void fall(test_engine *e) { test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -G); }

static void pin(test_engine *e, uint32_t id) { test_pin(e, HK_PIN_FIXED, id, NULL); }

static void launch(test_engine *e, uint32_t id, double x, double y, double z) {
  double *v = e->scene->particles.velocity + 3 * (size_t)(id - 1);
  v[0] = x, v[1] = y, v[2] = z;
}

/* ---- what is run, and how it is judged ---- */

typedef struct hard_case {
  const char *name;
  void (*build)(test_engine *), (*reference)(test_engine *); /* reference: run by dopri5; NULL: a closed form */
  double (*error)(test_engine *);                            /* m; NULL: the distance from the reference */
  unsigned methods;                                          /* those that have one of these, and DAMPS if it is here */
  double h, T;                                               /* s */
  double w, amplitude;                                       /* 1/s, m: of what is resolved */
  double rest;      /* m, added to the bound: what the closed form leaves out, and algebra */
  double frames;    /* in T; 0: one */
  bool first_order; /* the scene is not smooth: all methods are held to order 1 */
  bool may_refuse;  /* an honest failure will do */
  bool order;       /* measured as well */
} hard_case;

static double reference[3 * MOST];
static size_t referenced;

static void open_case(test_engine *e, const hard_case *c, const char *method, double h, double tol) {
  test_engine_open(e);
  c->build(e);
  e->options.integrator = method;
  e->options.dt = h;
  e->options.tol = tol;
  e->scene->fps = fmax(1, c->frames) / c->T;
  e->scene->duration = c->T;
  test_run(e);
}

static void make_reference(const hard_case *c) {
  test_engine e;
  hard_case other = *c;
  other.build = c->reference;
  open_case(&e, &other, "dopri5", NAN, 1e-11);
  test_advance(&e, c->T);
  referenced = hk_run_view(e.run)->n;
  assert_true(referenced <= MOST);
  for (uint32_t i = 0; i < referenced; i++) memcpy(reference + 3 * i, test_position(&e, i + 1), 3 * sizeof *reference);
  test_engine_close(&e);
}

static double far(const double *a, const double *b) {
  return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* The largest distance; all_finite has looked for NaN. */
static double farthest(test_engine *e) {
  double worst = 0;
  for (uint32_t i = 0; i < referenced; i++) {
    double d = far(reference + 3 * i, test_position(e, i + 1));
    if (!(d <= worst)) worst = d;
  }
  return worst;
}

static double bound_of(const hard_case *c, const struct method *m) {
  double leading = c->h * c->w * c->w * c->T, second = 2 * c->h * c->h * pow(c->w, 3) * c->T / 3;
  double part = m->order == 1 || c->first_order ? leading : second;
  if (m->flags & ADAPTIVE && m->order > 1) part += 100 * c->w * c->T * 1e-6;
  return c->amplitude * part + c->rest;
}

static bool all_finite(const test_engine *e) {
  const hk_view *view = hk_run_view(e->run);
  for (size_t k = 0; k < 3 * view->n; k++)
    if (!isfinite(view->x[k]) || !isfinite(view->v[k])) return false;
  return true;
}

static bool fits(const hard_case *c, const struct method *m) {
  if (c->methods & DAMPS && !(m->flags & DAMPS)) return false;
  return c->methods & m->flags & EVERY;
}

static void must_be_loud(const hard_case *c, const struct method *m, test_engine *e, hk_status status) {
  hk_summary s;
  hk_run_summary(e->run, &s);
  print_message("%-34s %-18s refused: %s\n", c->name, m->name, e->error.text);
  if (!c->may_refuse) fail_msg("%s, %s: %s", c->name, m->name, e->error.text);
  assert_true(status == HK_NOT_CONVERGED || status == HK_NOT_FINITE);
  assert_int_equal(s.verdict, HK_DIVERGED);
  assert_non_null(strstr(e->error.text, "at step"));
  assert_non_null(strstr(e->error.text, "t = "));
  assert_true(all_finite(e) || status == HK_NOT_FINITE);
}

/* From steps of 2e-4 and 1e-4 s, where the next terms are of O(h w) = 0.07. Fixed-step methods of order 2. */
static void order_is_two(const hard_case *c) {
  for (size_t k = 0; k < METHODS; k++) {
    double off[2];
    if (methods[k].order != 2 || methods[k].flags & ADAPTIVE) continue;
    for (int half = 0; half < 2; half++) {
      test_engine e;
      open_case(&e, c, methods[k].name, half ? 1e-4 : 2e-4, 1e-6);
      test_advance(&e, c->T);
      off[half] = c->error(&e);
      test_engine_close(&e);
    }
    double order = log2(off[0] / off[1]);
    print_message("%-34s %-18s order %.2f, errors %.1e %.1e\n", c->name, methods[k].name, order, off[0], off[1]);
    if (!(order > 1.7)) fail_msg("%s, %s: order %.2f", c->name, methods[k].name, order);
  }
}

static void is_right_or_loud(void **state) {
  const hard_case *c = *state;
  hk_summary s;
  if (c->reference) make_reference(c);
  if (c->order) order_is_two(c);
  for (size_t k = 0; k < METHODS; k++) {
    const struct method *m = &methods[k];
    test_engine e;
    if (!fits(c, m)) continue;
    open_case(&e, c, m->name, c->h, 1e-6);
    hk_status status = hk_run_advance(e.run, c->T, &e.error);
    if (status == HK_OK) {
      if (!all_finite(&e)) fail_msg("%s, %s: what is not finite passes for good", c->name, m->name);
      double off = c->error ? c->error(&e) : farthest(&e), bound = bound_of(c, m);
      assert_int_equal(hk_run_close(e.run, &e.error), HK_OK);
      hk_run_summary(e.run, &s);
      print_message("%-34s %-18s %-10s off by %.1e m of %.1e, %zu steps%s%s\n", c->name, m->name,
                    s.verdict == HK_VERDICT_OK ? "ok" : "inaccurate", off, bound, s.steps, *s.reason ? "; " : "",
                    s.reason);
      bool loud = c->may_refuse && s.verdict != HK_VERDICT_OK;
      loud |= m->flags & SWEEPS && (s.verdict != HK_VERDICT_OK || s.warnings > 0);
      if (!(off <= bound || loud))
        fail_msg("%s, %s: off by %g m, bound %g m, verdict %d (%s)", c->name, m->name, off, bound, (int)s.verdict,
                 s.reason);
    } else
      must_be_loud(c, m, &e, status);
    test_engine_close(&e);
  }
}

/* ---- springs out of the ordinary ---- */

/* 10 x 2 particles at half the rest length: every block of K is indefinite across its spring. w^2 <= 2 (6 k)/m. */
static void compressed(test_engine *e) { grid(e, 10, 2, 0.05, 1e-3, 0.01, 10, 0, 0.1); }

/* M + h^2 K is indefinite by far, h w = 11. With drag the strip ends at rest and no spring strained: what oscillates
 * goes as exp(-t), and 20 s leave 1e-9 of the first strain of 0.5. */
static void compressed_damped(test_engine *e) {
  grid(e, 10, 2, 0.05, 1e-3, 0.01, 10, 0.01, 0.1);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 2);
}

static double strained_grid(test_engine *e) {
  double x = 0;
  assert_int_equal(hk_run_strain(e->run, "springs", &x, &e->error), HK_OK);
  return fabs(x);
}

/* A triangle of springs without length, two ends at one point: linear, x'' = -3 (k/m) (x - centre); w^2 = 3 k/m. */
static void without_length(test_engine *e) {
  uint32_t edge[3][2] = {{1, 2}, {2, 3}, {3, 1}};
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1, 1, -2, 1);
  link_edges(e, (const uint32_t(*)[2])edge, 3, 100, 0, 0);
}

static double oscillates(test_engine *e) {
  static const double corner[3] = {1, 1, -2};
  double worst = 0, c = cos(sqrt(300) * 0.1);
  for (uint32_t i = 1; i <= 3; i++)
    for (int q = 0; q < 3; q++) {
      double centre = corner[q] / 3, from = i == 3 ? corner[q] : 0;
      worst = fmax(worst, fabs(test_position(e, i)[q] - centre - (from - centre) * c));
    }
  return worst;
}

/* Two particles at one point, spring of 0.1 m, drifting apart: r = L (1 - cos w t) + (u/w) sin w t, w^2 = 2 k/m = 200.
 * At r = 0 the spring has no direction and no force; a method that looks there misses h k L/m of velocity once. */
static void coincident(test_engine *e) {
  uint32_t edge[1][2] = {{1, 2}};
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 0, 0, 0, 1);
  launch(e, 2, 1, 0, 0);
  link_edges(e, (const uint32_t(*)[2])edge, 1, 100, 0, 0.1);
}

static double parted(test_engine *e) {
  double w = sqrt(200), t = 0.1, r = 0.1 * (1 - cos(w * t)) + sin(w * t) / w;
  double a[3] = {(t - r) / 2, 0, 0}, b[3] = {(t + r) / 2, 0, 0};
  return fmax(far(a, test_position(e, 1)), far(b, test_position(e, 2)));
}

static void coincident_at_rest(test_engine *e) {
  coincident(e);
  launch(e, 2, 0, 0, 0);
}

static double moved(test_engine *e) {
  double worst = 0;
  const hk_view *view = hk_run_view(e->run);
  for (size_t k = 0; k < 3 * view->n; k++) worst = fmax(worst, fabs(view->x[k] - e->scene->particles.position[k]));
  return worst;
}

/* ---- far apart in mass and stiffness ---- */

/* A weight of 1 kg on a string of k that is eight springs with seven beads of 1e-6 kg. */
static void heavy(test_engine *e, double k, double stretch) {
  uint32_t edge[8][2];
  for (uint32_t i = 0; i <= 8; i++) test_particle(e, 0, 0, -0.1 * i * (1 + stretch), i == 8 ? 1 : 1e-6);
  for (uint32_t i = 0; i < 8; i++) edge[i][0] = i + 1, edge[i][1] = i + 2;
  pin(e, 1);
  link_edges(e, (const uint32_t(*)[2])edge, 8, 8 * k, 0, 0.1);
}

static void mass_ratio(test_engine *e) { heavy(e, 400, 0.1); }

static double weight_swings(test_engine *e) {
  double z = -0.8 - 0.08 * cos(sqrt(400) * 0.02);
  return fabs(test_position(e, 9)[2] - z);
}

/* The same at rest under gravity: 1 kg on k = 1e6 N/m hangs 9.81e-6 m deeper, the beads' weight is 7e-6 of it. */
static void heavy_hangs(test_engine *e) {
  heavy(e, 1e6, 0);
  fall(e);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 5);
}

static double hangs(test_engine *e) { return fabs(test_position(e, 9)[2] + 0.8 + G / 1e6); }

/* Wall - 1e8 N/m - 1 kg - 1 N/m - 1 kg: the slow mode is cos t up to 1e-8, the fast one has h w = 100. */
static void stiffness_ratio(test_engine *e) {
  uint32_t hard[1][2] = {{1, 2}}, soft[1][2] = {{2, 3}};
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1 + 1e-9, 0, 0, 1);
  test_particle(e, 2.1, 0, 0, 1);
  pin(e, 1);
  link_edges(e, (const uint32_t(*)[2])hard, 1, 1e8, 0, 1);
  link_edges(e, (const uint32_t(*)[2])soft, 1, 1, 0, 1);
}

static double two_springs(test_engine *e) {
  double a[3] = {1 + 1e-9 * cos(1), 0, 0}, b[3] = {2 + 0.1 * cos(1), 0, 0};
  return fmax(far(a, test_position(e, 2)), far(b, test_position(e, 3)));
}

/* ---- pinned, free, alone ---- */

static void pinned_everywhere(test_engine *e) {
  grid(e, 5, 5, 0.1, 0.03, 0.01, 1e5, 1, 0.08);
  for (uint32_t i = 1; i <= 25; i++) pin(e, i);
  fall(e);
}

/* Stiff, spinning, free: h w = 110. Its centre falls as a point: Euler's rules are off by g h T/2, the others are exact
 * up to the algebraic error, 1e-6 of the speed in each of 20 steps. */
static void pinned_nowhere(test_engine *e) {
  grid(e, 5, 5, 0.1, 0.005, 0.01, 1e5, 0, NAN);
  for (uint32_t i = 1; i <= 25; i++) {
    const double *x = e->scene->particles.position + 3 * (i - 1);
    launch(e, i, 1 - 2 * x[1], 2 * x[0], 3);
  }
  fall(e);
}

static double centre_is_off(test_engine *e) {
  double from[3] = {0}, to[3] = {0}, t = hk_run_view(e->run)->t, n = (double)e->scene->particles.n;
  for (size_t k = 0; k < 3 * e->scene->particles.n; k++) {
    from[k % 3] += (e->scene->particles.position[k] + t * e->scene->particles.velocity[k]) / n;
    to[k % 3] += hk_run_view(e->run)->x[k] / n;
  }
  from[2] -= G * t * t / 2;
  return far(from, to);
}

/* A cloth that hangs, and a particle that nothing holds and no force moves: x = x0 + v t. */
static void disconnected(test_engine *e) {
  grid(e, 4, 4, 0.1, 0, 0.01, 100, 0, NAN);
  pin(e, 1);
  launch(e, 16, 0, 0, 0.5);
  launch(e, test_particle(e, 1, 0, 0, 1), 1, 2, 3);
}

static double alone_is_off(test_engine *e) {
  return far((double[]){2, 2, 3}, test_position(e, (uint32_t)e->scene->particles.n));
}

static void one_particle(test_engine *e) {
  launch(e, test_particle(e, 0, 0, 0, 2), 1, 0, 5);
  fall(e);
}

/* Euler's rules are off by g h T/2. */
static double projectile(test_engine *e) {
  double t = hk_run_view(e->run)->t;
  return far((double[]){t, 0, 5 * t - G * t * t / 2}, test_position(e, 1));
}

/* Refused when the run opens, with the remedy. */
static void a_scene_of_nobody_is_refused(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    test_engine e;
    test_engine_open(&e);
    fall(&e);
    e.options.integrator = methods[k].name;
    assert_int_not_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_OK);
    assert_non_null(strstr(e.error.text, "add particles"));
    test_engine_close(&e);
  }
}

/* K = 0 and D = 0: springs of k = 0, no damping. Only the masses make the matrix regular. */
static void singular(test_engine *e) {
  grid(e, 4, 4, 0.1, 0.01, 0.01, 0, 0, 0.1);
  for (uint32_t i = 1; i <= 16; i++) launch(e, i, 1, 2, 3);
}

static double flies(test_engine *e) {
  double worst = 0, t = hk_run_view(e->run)->t;
  for (uint32_t i = 1; i <= e->scene->particles.n; i++) {
    const double *x = e->scene->particles.position + 3 * (i - 1);
    worst = fmax(worst, far((double[]){x[0] + t, x[1] + 2 * t, x[2] + 3 * t}, test_position(e, i)));
  }
  return worst;
}

/* ---- steps of 10 s and of 1e-12 s ---- */

static void hanging(test_engine *e) {
  grid(e, 4, 4, 0.1, 1e-3, 0.01, 1e3, 0, NAN);
  pin(e, 13);
  pin(e, 16);
  fall(e);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 1);
}

/* The largest force on a free particle, as the displacement of one spring. */
static double unbalanced(test_engine *e) {
  double worst = 0, weight[3], spring[3];
  for (uint32_t i = 1; i <= 16; i++) {
    if (i == 13 || i == 16) continue;
    assert_int_equal(hk_run_force(e->run, "springs", i, spring, &e->error), HK_OK);
    assert_int_equal(hk_run_force(e->run, "gravity", i, weight, &e->error), HK_OK);
    for (int q = 0; q < 3; q++) worst = fmax(worst, fabs(weight[q] + spring[q]) / 1e3);
  }
  return worst;
}

static void fast_cloth(test_engine *e) {
  grid(e, 4, 4, 0.1, 0.02, 0.01, 1e3, 0, 0.1);
  for (uint32_t i = 1; i <= 16; i++) launch(e, i, 1, 2, 3);
  fall(e);
}

/* ---- pins ---- */

static hk_status rush(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out, size_t max,
                      size_t *n_out, hk_error *error) {
  (void)caller, (void)f, (void)n_in, (void)max, (void)error;
  const double at[6] = {-50 * in[0], 0, 0, -50, 0, 0};
  memcpy(out, at, sizeof at);
  *n_out = 6;
  return HK_OK;
}

/* A string of five beads pulled away at 50 m/s; w^2 = 4 k/m. */
static void rushing(test_engine *e) {
  uint32_t id = 1;
  grid(e, 5, 1, 0.1, 0, 0.1, 1e3, 0.1, NAN);
  hk_pin_spec path = {.kind = HK_PIN_PATH, .count = 1, .id = &id, .path = {.call = rush}, .release = INFINITY};
  assert_int_equal(hk_scene_add_pin(e->scene, &path, &e->error), HK_OK);
}

static double rushed(test_engine *e) {
  const double *x = test_position(e, 1), *v = test_velocity(e, 1);
  bool exact = x[0] == -50 * hk_run_view(e->run)->t && x[1] == 0 && x[2] == 0 && v[0] == -50 && v[1] == 0;
  return exact ? farthest(e) : INFINITY;
}

static double rushed_far(test_engine *e) {
  referenced = 1;
  reference[0] = -50 * hk_run_view(e->run)->t, reference[1] = reference[2] = 0;
  return strained_grid(e) < 11 ? rushed(e) : INFINITY;
}

static const double normal[3] = {0.57735026918962573, 0.57735026918962573, 0.57735026918962573};

/* w^2 <= 2 (6 k)/m. */
static void sliding(test_engine *e) {
  grid(e, 4, 4, 0.1, 0.01, 0.01, 100, 0.01, NAN);
  test_pin(e, HK_PIN_LINE, 1, (const double[]){0, 0.6, 0.8});
  test_pin(e, HK_PIN_PLANE, 16, normal);
  fall(e);
}

/* INFINITY: the slides are left by more than rounding, 2e-16 of 0.4 m a step and evaluation. */
static double slid(test_engine *e) {
  const double *a = test_position(e, 1), *b = test_position(e, 16);
  const double *from = e->scene->particles.position, *last = from + 45;
  double d = (a[1] - from[1]) * 0.8 - (a[2] - from[2]) * 0.6, out = 0;
  for (int q = 0; q < 3; q++) out += (b[q] - last[q]) * normal[q];
  return fmax(fabs(a[0] - from[0]), fmax(fabs(d), fabs(out))) < 1e-12 ? farthest(e) : INFINITY;
}

/* A bead on a spring of w = 10, held until t = 0.1 in the middle of a step that would be: cut there. */
static void released(test_engine *e) {
  uint32_t edge[1][2] = {{1, 2}}, id = 2;
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 0.2, 0, 0, 1);
  link_edges(e, (const uint32_t(*)[2])edge, 1, 100, 0, 0.1);
  pin(e, 1);
  hk_pin_spec spec = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = 0.1};
  assert_int_equal(hk_scene_add_pin(e->scene, &spec, &e->error), HK_OK);
}

static double let_go(test_engine *e) {
  double t = hk_run_view(e->run)->t - 0.1;
  return far((double[]){0.1 + 0.1 * cos(10 * t), 0, 0}, test_position(e, 2));
}

/* ---- births and corrections in the middle of a run ---- */

static void swinging(test_engine *e) {
  grid(e, 4, 4, 0.1, 0.01, 0.01, 100, 0, NAN);
  for (uint32_t i = 13; i <= 16; i++) pin(e, i);
  launch(e, 1, 0, 0, 1);
  fall(e);
}

static void bearing(test_engine *e) {
  swinging(e);
  hk_plugin_spec *emitter = test_plugin(e, HK_SOURCE, "fixture:spout");
  test_number(e, emitter, "every", 1.5e-3);
  test_vector(e, emitter, "position", 5, 5, 5);
}

static double bore(test_engine *e) { return hk_run_view(e->run)->n >= 16 + 4 ? farthest(e) : INFINITY; }

/* A particle reaches the floor after 1 ms, and is corrected in every step from there on. */
static void landing(test_engine *e) {
  swinging(e);
  test_particle(e, 5, 5, -1, 1);
  test_number(e, test_plugin(e, HK_CORRECTOR, "fixture:floor"), "height", -1 - 1e-4);
  launch(e, 17, 0, 0, -0.1);
}

/* It lies on the floor exactly. */
static double landed(test_engine *e) { return test_position(e, 17)[2] == -1 - 1e-4 ? farthest(e) : INFINITY; }

/* ---- what cannot be done is said ---- */

/* Forces of 1e310 N, and of 1e307 N, with which matrices and sums overflow. */
static void infinite(test_engine *e) { grid(e, 4, 4, 100, 0.01, 0.01, 1e308, 0, 1e-3); }
static void huge(test_engine *e) { grid(e, 4, 4, 0.1, 0.01, 0.01, 1e308, 0, 1e-3); }

static void overflows(const hard_case *c, const struct method *m) {
  test_engine e;
  open_case(&e, c, m->name, 0.01, 1e-6);
  hk_status status = hk_run_advance(e.run, 0.1, &e.error);
  if (strcmp(m->name, "xpbd") == 0 && status == HK_OK) /* knows 1/k alone, and takes the springs for rods */
    assert_true(all_finite(&e));
  else {
    if (status == HK_OK) fail_msg("%s takes %s for good", m->name, c->name);
    must_be_loud(c, m, &e, status);
    assert_non_null(strstr(e.error.text, "particle "));
    assert_non_null(strstr(e.error.text, "'springs'"));
  }
  test_engine_close(&e);
}

static void forces_that_are_not_finite_are_named(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    overflows(&(hard_case){.name = "infinite forces", .build = infinite, .T = 0.1, .may_refuse = true}, &methods[k]);
    if (methods[k].flags & FULL)
      overflows(&(hard_case){.name = "huge forces", .build = huge, .T = 0.1, .may_refuse = true}, &methods[k]);
  }
}

/* One iteration of Newton's method from a guess that lies far off: at 10 s, and at 10 s/2^12 as well (h w = 800). */
static void no_convergence_is_said(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    hard_case c = {.name = "one iteration", .build = pinned_nowhere, .T = 10, .may_refuse = true};
    test_engine e;
    if (!(methods[k].flags & FULL) || methods[k].flags & ADAPTIVE) continue;
    test_engine_open(&e);
    pinned_nowhere(&e);
    test_number(&e, test_plugin(&e, HK_INTEGRATOR, methods[k].name), "iterations", 1);
    e.options.dt = 10;
    e.scene->fps = 0.1;
    test_run(&e);
    hk_status status = hk_run_advance(e.run, 10, &e.error);
    assert_int_equal(status, HK_NOT_CONVERGED);
    must_be_loud(&c, &methods[k], &e, status);
    assert_non_null(strstr(e.error.text, "after 1 iterations"));
    test_engine_close(&e);
  }
}

/* ---- accuracy ---- */

typedef struct newton_run {
  size_t m;
  double h, *base, *X, *a, *R, *dv, *end;
} newton_run;

/* One iteration of Newton's method on M (v - v0 - h a(x0 + h v, v)) = 0, with nothing to help it. */
static void iterate(hk_system *s, newton_run *w) {
  hk_matrix K, D, A;
  unsigned flags;
  double *v = w->X + w->m;
  for (size_t e = 0; e < w->m; e++) w->X[e] = w->base[e] + w->h * v[e];
  assert_int_equal(s->accelerations(s, w->h, w->X, v, w->X + 2 * w->m, w->a, w->a + w->m), HK_OK);
  for (size_t e = 0; e < w->m; e++) w->R[e] = -s->model->mass[e / 3] * (v[e] - w->base[w->m + e] - w->h * w->a[e]);
  s->filter(s, w->R);
  assert_int_equal(s->linear->solver_flags(s, &flags), HK_OK);
  assert_int_equal(s->linear->jacobian(s, w->h, w->X, flags & HK_SOLVES_UNSYMMETRIC ? 0 : HK_WANT_SYMMETRIC, &K, &D),
                   HK_OK);
  assert_int_equal(s->linear->combine(s, 1, w->h, w->h * w->h, &A), HK_OK);
  assert_int_equal(s->linear->factorize(s, &A), HK_OK);
  assert_int_equal(s->linear->solve(s, w->R, w->dv, NULL), HK_OK);
  for (size_t e = 0; e < w->m; e++) v[e] += w->dv[e];
}

/* A spinning cloth of springs of 1e3 N/m, stretched by some percent; h w = 5. */
static void turning(test_engine *e, double damping) {
  grid(e, 4, 4, 0.1, 0.01, 0.01, 1e3, damping, 0.095);
  for (uint32_t i = 1; i <= 16; i++) {
    const double *x = e->scene->particles.position + 3 * (i - 1);
    launch(e, i, -10 * x[1], 10 * x[0], 0);
  }
  pin(e, 1);
}

enum { ITERATIONS = 80 };

/* |v_k - v| before each iteration, v the last. */
static void newton_errors(const char *solver, double damping, double error[ITERATIONS]) {
  enum { SIZE = 512 };
  static double memory[6][SIZE], path[ITERATIONS][SIZE];
  test_engine e;
  test_engine_open(&e);
  turning(&e, damping);
  e.options.integrator = "backward_euler";
  e.options.solver = solver;
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  newton_run w = {3 * s->n, 5e-3, memory[0], memory[1], memory[2], memory[3], memory[4], memory[5]};
  assert_true(s->size <= SIZE);
  memcpy(w.base, s->X, s->size * sizeof *w.base);
  memcpy(w.X, s->X, s->size * sizeof *w.X);
  for (int k = 0; k < ITERATIONS; k++) {
    memcpy(path[k], w.X + w.m, w.m * sizeof *w.X);
    iterate(s, &w);
  }
  for (int k = 0; k < ITERATIONS; k++) {
    error[k] = 0;
    for (size_t q = 0; q < w.m; q++) error[k] = fmax(error[k], fabs(path[k][q] - w.X[w.m + q]));
  }
  test_engine_close(&e);
}

/* log(e_2/e_1)/log(e_1/e_0), of the last three errors above rounding, 1e-11 m/s at speeds of some m/s. */
static double exponent(const char *name, const double *error) {
  int last = 0;
  while (last + 1 < ITERATIONS && error[last + 1] > 1e-11) last++;
  assert_in_range(last, 2, ITERATIONS - 10);
  double p = log(error[last] / error[last - 1]) / log(error[last - 1] / error[last - 2]);
  print_message("Newton, %-22s errors", name);
  for (int k = 0; k <= last; k++) print_message(" %.1e", error[k]);
  print_message(": exponent %.2f, rate %.3f, C = %.3g\n", p, error[last] / error[last - 1],
                error[last] / pow(error[last - 1], 2));
  return p;
}

/* With the whole Jacobian the error is squared; without the turning of the dampers' direction it shrinks by a factor,
 * c |u|/(k l) < 1 or less. Half an exponent tells the two apart: the next terms are of O(e). */
static void newton_converges_quadratically_with_exact_jacobians(void **state) {
  (void)state;
  double error[ITERATIONS];
  newton_errors("cholmod", 0, error);
  assert_true(exponent("undamped, cholmod", error) > 1.7);
  newton_errors("umfpack", 10, error);
  assert_true(exponent("damped, umfpack", error) > 1.7);
  newton_errors("cholmod", 10, error);
  assert_true(exponent("damped, cholmod", error) < 1.3);
}

static double stiffness;

/* 1 kg on a spring of 1 m from 60 degrees, at rest and in radial equilibrium: the fast mode has 100/k^2 m. */
static void pendulum(test_engine *e) {
  uint32_t edge[1][2] = {{1, 2}};
  double l = 1 + G * 0.5 / stiffness;
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, l * sqrt(0.75), 0, -l * 0.5, 1);
  pin(e, 1);
  link_edges(e, (const uint32_t(*)[2])edge, 1, stiffness, 0, 1);
  fall(e);
}

static double pendulum_error(const char *method, double h) {
  test_engine e;
  test_engine_open(&e);
  pendulum(&e);
  test_number(&e, test_plugin(&e, HK_INTEGRATOR, method), "tolerance", 1e-13);
  e.options.dt = h;
  e.options.tol = 1e30; /* adaptive methods then take the step they are given */
  e.scene->fps = 1 / h;
  test_run(&e);
  test_advance(&e, 1);
  hk_summary s;
  hk_run_summary(e.run, &s);
  if (fabs(s.dt_max / h - 1) > 1e-9) fail_msg("%s: took %g s, not %g s", method, s.dt_max, h);
  double off = farthest(&e);
  test_engine_close(&e);
  return off;
}

/* Steps of 1/80 and 1/160 s: h w is 1.25 at k = 1e4 and 12.5 at 1e6, the pendulum's own h w 0.04, so that an order is
 * known to 0.3 or so. Those of order 1 and 2 keep their order at every stiffness. esdirk4 has 4.1 at k = 1e4 and is
 * reduced where h w > 1: 3.4 at 1e5; at 1e6, from 1/20 s on by halves, 2.5, 3.5, 0.8, 3.2 and 3.8, on the whole 2.8. It
 * stays below tr_bdf2 nonetheless. */
static void orders_on_a_stiff_pendulum(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double order, stiffest; /* up to which stiffness */
  } pendulums[] = {{"backward_euler", 1, 1e6},
                   {"bdf2", 2, 1e6},
                   {"tr_bdf2", 2, 1e6},
                   {"esdirk4", 4, 1e4},
                   {"implicit_midpoint", 2, 1e6}};
  for (stiffness = 1e4; stiffness < 2e6; stiffness *= 10) {
    double tr_bdf2 = 0;
    make_reference(&(hard_case){.name = "pendulum", .reference = pendulum, .T = 1});
    for (size_t k = 0; k < sizeof pendulums / sizeof *pendulums; k++) {
      double a = pendulum_error(pendulums[k].name, 1.0 / 80), b = pendulum_error(pendulums[k].name, 1.0 / 160);
      print_message("pendulum, k = %.0e      %-18s order %.2f, errors %.1e %.1e\n", stiffness, pendulums[k].name,
                    log2(a / b), a, b);
      if (stiffness <= pendulums[k].stiffest && !(fabs(log2(a / b) - pendulums[k].order) < 0.3))
        fail_msg("%s at k = %g: order %.2f", pendulums[k].name, stiffness, log2(a / b));
      if (strcmp(pendulums[k].name, "tr_bdf2") == 0) tr_bdf2 = b;
      if (strcmp(pendulums[k].name, "esdirk4") == 0) assert_true(b < tr_bdf2 / 5);
    }
  }
  stiffness = 1e6;
  double order = log2(pendulum_error("esdirk4", 1.0 / 20) / pendulum_error("esdirk4", 1.0 / 640)) / 5;
  print_message("pendulum, k = 1e+06      esdirk4            order %.2f from 1/20 s to 1/640 s\n", order);
  assert_true(order > 2.5);
}

/* The free body of before, h w = 110: what the algebraic error of 1e-6 of the speed may add in each of 20 steps. */
static void momentum_of_a_free_stiff_body(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    hard_case c = {.build = pinned_nowhere, .T = 0.2};
    test_engine e;
    if (methods[k].flags & YARDSTICK) continue;
    open_case(&e, &c, methods[k].name, 0.01, 1e-6);
    test_advance(&e, 0.2);
    double p[3] = {0}, scale = 0;
    for (size_t q = 0; q < 75; q++) {
      double from = e.scene->particles.velocity[q];
      p[q % 3] += hk_run_view(e.run)->v[q] - from + (q % 3 == 2 ? G * 0.2 : 0);
      scale += fabs(from);
    }
    double off = far(p, (double[]){0, 0, 0}) / scale;
    print_message("free stiff body            %-18s momentum off by %.1e\n", methods[k].name, off);
    if (!(off < 20 * 1e-6)) fail_msg("%s: momentum is off by %g", methods[k].name, off);
    if (methods[k].order > 1 && !(centre_is_off(&e) < 20 * 1e-6 * 4 * 0.2))
      fail_msg("%s: the centre of mass is off by %g m", methods[k].name, centre_is_off(&e));
    test_engine_close(&e);
  }
}

/* ---- the cases ---- */

/* clang-format off */
static const hard_case cases[] = {
    {"compressed_springs", compressed, compressed, NULL, EVERY, 1e-5, 0.01, .w = 110, .amplitude = 0.05},
    {"compressed_springs_in_long_steps", compressed_damped, NULL, strained_grid, FULL | SPRINGS | DAMPS, 0.1, 20,
     .rest = 1e-8, .frames = 200, .may_refuse = true},
    {"springs_without_length", without_length, NULL, oscillates, EVERY, 1e-3, 0.1, .w = 17.320508,
     .amplitude = 4.0 / 3},
    {"coincident_particles", coincident, NULL, parted, EVERY, 1e-4, 0.1, .w = 14.142136, .amplitude = 0.2,
     .first_order = true},
    /* An equilibrium, if an unstable one: nothing gives the spring a direction. */
    {"coincident_particles_at_rest", coincident_at_rest, NULL, moved, EVERY, 0.01, 1, .w = 0},
    /* w = 20 1/s for the weight, up to 1e5 1/s for the beads, h w = 100. The closed form leaves out the beads:
     * their mass makes 1e-6 of w t = 0.4, and what of their motion is fast is as small. */
    {"mass_ratio_1e6", mass_ratio, NULL, weight_swings, FULL | SPRINGS, 1e-3, 0.02, .w = 20, .amplitude = 0.08,
     .rest = 1e-6},
    /* exp(-2.5 x 4) of the first 1e-5 m is left, or 5e-10 m. */
    {"heavy_mass_on_a_stiff_string", heavy_hangs, NULL, hangs, FULL | DAMPS, 0.02, 4, .rest = 2e-9, .frames = 200},
    {"stiffness_ratio_1e8", stiffness_ratio, NULL, two_springs, FULL | SPRINGS, 0.01, 1, .w = 1, .amplitude = 0.1,
     .rest = 1e-6},
    {"pinned_everywhere_stays_bitwise", pinned_everywhere, NULL, moved, EVERY, 0.01, 0.2, .w = 0},
    {"pinned_nowhere", pinned_nowhere, NULL, centre_is_off, FULL | SPRINGS, 0.01, 0.2, .w = 1, .amplitude = 9.81 / 2,
     .rest = 1e-6 * 4 * 0.2},
    {"disconnected_particle", disconnected, NULL, alone_is_off, FULL | SPRINGS, 0.02, 1, .rest = 1e-12},
    /* The cloth beside it is as it would be. w^2 = 2 (6 k)/m. */
    {"disconnected_cloth", disconnected, disconnected, NULL, EVERY, 1e-5, 0.01, .w = 347, .amplitude = 0.02},
    {"one_particle", one_particle, NULL, projectile, EVERY, 0.01, 1, .w = 1, .amplitude = 9.81 / 2, .rest = 1e-12},
    {"singular_without_masses", singular, NULL, flies, EVERY, 0.1, 2, .rest = 1e-12},
    /* After 50 steps the cloth hangs in equilibrium, as its weight of 1.6 N on 1e3 N/m strains it: 1e-6 m of a
     * spring are a hundredth of what one particle's weight does. A refusal is honest here, and a warning of
     * the methods that make a fixed number of sweeps: ten of local_global leave 4e-3 m, and it says so. */
    {"steps_of_10_s", hanging, NULL, unbalanced, FULL | SPRINGS | DAMPS, 10, 500, .rest = 1e-6, .frames = 50, .may_refuse = true},
    /* x0 + v t up to a t^2/2 < 1e4 x 5e-23 m and the rounding of sums near 0.3 m, a hundred for xpbd. */
    {"steps_of_1e-12_s", fast_cloth, NULL, flies, EVERY, 1e-12, 1e-11, .rest = 1e-14},
    /* The path is kept bitwise; what follows is as it should be in small steps. In steps of h w = 3 the string may
     * be refused; in the pin's frame it starts with 500 J, which stretch it by 1 m in all or less. */
    {"pin_at_50_m/s", rushing, rushing, rushed, EVERY, 1e-5, 0.01, .w = 200, .amplitude = 0.5},
    {"pin_at_50_m/s_in_long_steps", rushing, NULL, rushed_far, EVERY, 1.0 / 60, 0.5, .may_refuse = true},
    {"sliding_pins", sliding, sliding, slid, EVERY, 1e-5, 0.02, .w = 347, .amplitude = 0.01},
    {"release_in_the_middle", released, NULL, let_go, EVERY, 2e-3, 0.301, .w = 10, .amplitude = 0.1},
    /* The cloth does not notice who is born elsewhere: the reference knows of no births. Adaptive methods ask
     * sources once a step, so they may bear fewer. */
    {"births_in_the_middle", bearing, swinging, bore, EVERY, 1e-5, 0.01, .w = 347, .amplitude = 0.02, .order = true},
    {"corrections_in_the_middle", landing, swinging, landed, EVERY, 1e-5, 0.01, .w = 347, .amplitude = 0.02,
     .order = true},
};
/* clang-format on */

enum { CASES = sizeof cases / sizeof *cases };

int main(void) {
  struct CMUnitTest tests[CASES + 6] = {
      cmocka_unit_test(a_scene_of_nobody_is_refused),
      cmocka_unit_test(forces_that_are_not_finite_are_named),
      cmocka_unit_test(no_convergence_is_said),
      cmocka_unit_test(newton_converges_quadratically_with_exact_jacobians),
      cmocka_unit_test(orders_on_a_stiff_pendulum),
      cmocka_unit_test(momentum_of_a_free_stiff_body),
  };
  for (size_t k = 0; k < CASES; k++)
    tests[6 + k] = (struct CMUnitTest){cases[k].name, is_right_or_loud, NULL, NULL, (void *)(uintptr_t)&cases[k]};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
