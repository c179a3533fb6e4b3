/* local_global against backward Euler solved here by a dense Newton of its own, and what its theory promises of every
 * single iteration. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 4, N = SIDE * SIDE, M = 3 * N, MOST = 64 };

static const double fps = 30, g_z = -9.81, drag_rate = 0.3;

typedef struct spring {
  size_t i, j;
  double k, c, L;
} spring;

typedef struct net {
  test_engine e;
  hk_plugin_spec *method;
  size_t springs;
  spring spring[MOST];
} net;

static uint64_t bits;

static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

static void add_springs(net *s, int di, int dj, double k, double c, double rest) {
  uint32_t edge[MOST][2];
  size_t count = 0;
  for (int j = 0; j + dj < SIDE; j++)
    for (int i = 0; i + di < SIDE; i++) {
      size_t a = (size_t)(j * SIDE + i), b = (size_t)((j + dj) * SIDE + i + di);
      s->spring[s->springs++] = (spring){a, b, k, c, rest};
      edge[count][0] = (uint32_t)a + 1;
      edge[count++][1] = (uint32_t)b + 1;
    }
  hk_plugin_spec *springs = test_plugin(&s->e, HK_FORCE, "springs");
  test_edges(&s->e, springs, (const uint32_t(*)[2])edge, count);
  test_number(&s->e, springs, "k", k);
  test_number(&s->e, springs, "damping", c);
  test_number(&s->e, springs, "rest", rest);
}

/* A crumpled, moving piece of cloth with masses from 0.01 to 0.03 kg, some springs stretched and some pressed. */
static void open_net(net *s, double k, double damping, size_t iterations, const char *acceleration) {
  memset(s, 0, sizeof *s);
  test_engine_open(&s->e);
  bits = 1;
  for (int q = 0; q < N; q++) {
    uint32_t id = test_particle(&s->e, 0.1 * (q % SIDE) + 0.02 * noise(), 0.1 * (q / SIDE) + 0.02 * noise(),
                                0.05 * noise(), 0.02 * (1 + noise()));
    for (int c = 0; c < 3; c++) s->e.scene->particles.velocity[3 * (id - 1) + (size_t)c] = 2 * noise();
  }
  add_springs(s, 1, 0, k, damping, 0.1);
  add_springs(s, 0, 1, 0.7 * k, damping, 0.08);
  add_springs(s, 1, 1, 0.3 * k, 0, 0.14);
  test_vector(&s->e, test_plugin(&s->e, HK_FORCE, "gravity"), "g", 0, 0, g_z);
  s->method = test_plugin(&s->e, HK_INTEGRATOR, "local_global");
  test_number(&s->e, s->method, "iterations", (double)iterations);
  test_text(&s->e, s->method, "acceleration", acceleration);
  s->e.scene->fps = fps;
  s->e.options.dt = 1 / fps;
  s->e.options.until = 10;
}

static void add_drag(net *s) { test_number(&s->e, test_plugin(&s->e, HK_FORCE, "drag"), "rate", drag_rate); }

enum { FREE, HUNG, SLIDING, WAYS }; /* how the net is held */

static const char *const way_name[] = {"free", "hung", "sliding"};

static void slide(net *s) {
  static const double plane[3] = {0.6, 0, 0.8}, line[3] = {0, 0.8, -0.6};
  test_pin(&s->e, HK_PIN_PLANE, 1, plane);
  test_pin(&s->e, HK_PIN_PLANE, 2, plane);
  test_pin(&s->e, HK_PIN_LINE, N, line);
}

static void hang(net *s) {
  test_pin(&s->e, HK_PIN_FIXED, N - SIDE + 1, NULL);
  test_pin(&s->e, HK_PIN_FIXED, N, NULL);
}

/* ---- Backward Euler, by other means ---- */

typedef struct problem {
  const net *s;
  double h, x[M], y[M]; /* start of the step; free flight */
  const double *mass, *inverse_mass;
  double S[N][3][3]; /* what pins allow */
} problem;

static problem problem_of(const net *s, double drag) {
  const hk_view *view = hk_run_view(s->e.run);
  problem p = {.s = s, .h = 1 / fps, .mass = view->model->mass, .inverse_mass = view->model->inverse_mass};
  for (size_t e = 0; e < M; e++) {
    double v = view->v[e], a = (e % 3 == 2 ? g_z : 0) - drag * v;
    p.x[e] = view->x[e];
    p.y[e] = p.x[e] + p.h * v + p.h * p.h * a;
  }
  for (size_t c = 0; c < 3; c++) {
    double unit[M];
    for (size_t e = 0; e < M; e++) unit[e] = e % 3 == c;
    s->e.run->dynamics.system.filter(&s->e.run->dynamics.system, unit);
    for (size_t e = 0; e < M; e++) p.S[e / 3][e % 3][c] = unit[e];
  }
  return p;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* g and, when asked for, its gradient and Hessian. */
static double objective(const problem *p, const double *x, double *gradient, double (*H)[M]) {
  double g = 0, h = p->h;
  if (gradient) memset(gradient, 0, M * sizeof *gradient);
  if (H) memset(H, 0, M * sizeof *H);
  for (size_t e = 0; e < M; e++) {
    double m = p->mass[e / 3], d = x[e] - p->y[e];
    g += m * d * d / 2;
    if (gradient) gradient[e] += m * d;
    if (H) H[e][e] += m;
  }
  for (size_t q = 0; q < p->s->springs; q++) {
    const spring *s = &p->s->spring[q];
    double d[3], n0[3], change[3];
    for (size_t c = 0; c < 3; c++) {
      d[c] = x[3 * s->j + c] - x[3 * s->i + c];
      n0[c] = p->x[3 * s->j + c] - p->x[3 * s->i + c];
      change[c] = d[c] - n0[c];
    }
    double l = sqrt(dot(d, d)), l0 = sqrt(dot(n0, n0)), along = dot(n0, change) / l0;
    g += h * h * s->k * (l - s->L) * (l - s->L) / 2 + h * s->c * along * along / 2;
    for (size_t a = 0; a < 3 && gradient; a++) {
      double f = h * h * s->k * (l - s->L) * d[a] / l + h * s->c * along * n0[a] / l0;
      gradient[3 * s->j + a] += f;
      gradient[3 * s->i + a] -= f;
      for (size_t b = 0; b < 3 && H; b++) {
        double nn = d[a] * d[b] / (l * l), k = s->k * (nn + (1 - s->L / l) * ((a == b) - nn));
        double B = h * h * k + h * s->c * n0[a] * n0[b] / (l0 * l0);
        H[3 * s->i + a][3 * s->i + b] += B;
        H[3 * s->j + a][3 * s->j + b] += B;
        H[3 * s->i + a][3 * s->j + b] -= B;
        H[3 * s->j + a][3 * s->i + b] -= B;
      }
    }
  }
  return g;
}

/* Gaussian elimination without pivots; false when a pivot is not positive. */
static bool eliminate(double (*H)[M], double *b) {
  for (size_t k = 0; k < M; k++) {
    if (!(H[k][k] > 0)) return false;
    for (size_t r = k + 1; r < M; r++) {
      double factor = H[r][k] / H[k][k];
      for (size_t c = k; c < M; c++) H[r][c] -= factor * H[k][c];
      b[r] -= factor * b[k];
    }
  }
  for (size_t k = M; k-- > 0;) {
    for (size_t c = k + 1; c < M; c++) b[k] -= H[k][c] * b[c];
    b[k] /= H[k][k];
  }
  return true;
}

/* b becomes S b, and H, when there is one, S H S + I - S. */
static void hold(const problem *p, double (*H)[M], double *b) {
  for (size_t i = 0; i < N; i++) {
    double f[3] = {b[3 * i], b[3 * i + 1], b[3 * i + 2]};
    for (size_t a = 0; a < 3; a++) b[3 * i + a] = dot(p->S[i][a], f);
  }
  for (size_t i = 0; i < N; i++)
    for (size_t j = 0; j < N; j++) {
      double B[3][3] = {{0}};
      for (size_t a = 0; a < 9; a++)
        for (size_t c = 0; c < 9; c++)
          B[a / 3][c / 3] += p->S[i][a / 3][a % 3] * H[3 * i + a % 3][3 * j + c % 3] * p->S[j][c % 3][c / 3];
      for (size_t a = 0; a < 3; a++)
        for (size_t c = 0; c < 3; c++) H[3 * i + a][3 * j + c] = B[a][c] + (i == j ? (a == c) - p->S[i][a][c] : 0);
    }
}

static double norm(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) sum += (a[e] - (b ? b[e] : 0)) * (a[e] - (b ? b[e] : 0));
  return sqrt(sum);
}

/* Newton with a shift of the diagonal where the Hessian is not definite, and halved steps. x: start and solution. */
static void newton(const problem *p, double *x) {
  double(*H)[M] = malloc(M * sizeof *H), b[M], right[M], trial[M];
  for (int k = 0; k < 200; k++) {
    double g = objective(p, x, right, H), shift = 0, part = 1;
    hold(p, H, right);
    if (norm(right, NULL, M) < 1e-15) break;
    for (memcpy(b, right, sizeof b); !eliminate(H, b); memcpy(b, right, sizeof b)) {
      shift = shift > 0 ? 4 * shift : 1e-3;
      objective(p, x, trial, H);
      hold(p, H, trial);
      for (size_t e = 0; e < M; e++) H[e][e] += shift;
    }
    do {
      for (size_t e = 0; e < M; e++) trial[e] = x[e] - part * b[e];
      part /= 2;
    } while (objective(p, trial, NULL, NULL) > g * (1 + 1e-15) && part > 1e-9);
    memcpy(x, trial, sizeof trial);
  }
  free(H);
}

/* The positions after one step from the start with so many iterations. */
static void after(size_t iterations, const char *acceleration, double k, double damping, int way, double *x, problem *p,
                  net *kept) {
  net *s = kept;
  open_net(s, k, damping, iterations, acceleration);
  add_drag(s);
  if (way == HUNG) hang(s);
  if (way == SLIDING) slide(s);
  test_run(&s->e);
  if (p) *p = problem_of(s, drag_rate);
  test_advance(&s->e, 1 / fps);
  memcpy(x, hk_run_view(s->e.run)->x, M * sizeof *x);
}

/* ---- The iteration ---- */

/* 1e-13: rounding of g's sum of some 100 terms. */
static void objective_never_rises(void **state) {
  (void)state;
  for (int way = 0; way < WAYS; way++) {
    double last = INFINITY;
    for (size_t k = 1; k <= 40; k++) {
      net s;
      problem p;
      double x[M];
      after(k, "none", 3000, 0.5, way, x, &p, &s);
      double g = objective(&p, x, NULL, NULL);
      if (!(g <= last * (1 + 1e-13))) fail_msg("iteration %zu: g = %.17g after %.17g", k, g, last);
      last = g;
      test_engine_close(&s.e);
    }
  }
}

/* Newton's gradient is below 1e-15 where forces times h^2 are 1e-2, and the smallest curvature is a mass, 0.01 kg; the
 * iteration stops at rounding, about 1e-16 m over the factor 1 - rho of its contraction: together below 1e-11 m. */
static void many_iterations_reach_backward_euler(void **state) {
  (void)state;
  static const double damping[] = {0, 0.5, 20};
  for (size_t q = 0; q < sizeof damping / sizeof *damping; q++)
    for (int way = 0; way < WAYS; way++) {
      net s;
      problem p;
      double x[M], expected[M], off_start[M];
      after(4000, "none", 300, damping[q], way, x, &p, &s);
      hk_system *system = &s.e.run->dynamics.system;
      memcpy(expected, x, sizeof x);
      for (size_t e = 0; e < M; e++) off_start[e] = 1e-4 * sin((double)e);
      system->filter(system, off_start);
      for (size_t e = 0; e < M; e++) expected[e] += off_start[e];
      newton(&p, expected);
      double off = norm(x, expected, M), moved = norm(x, p.x, M);
      print_message("damping %g N s/m, %s: differs by %.1e m from Newton, the step moves %.2g m\n", damping[q],
                    way_name[way], off, moved);
      assert_true(off < 1e-11);
      assert_true(moved > 0.05);
      const double *v = hk_run_view(s.e.run)->v;
      for (size_t e = 0; e < M; e++) assert_true(fabs(v[e] - (x[e] - p.x[e]) * fps) <= 1e-14 * (1 + fabs(v[e])));
      test_engine_close(&s.e);
    }
}

static size_t iterations_until(const char *acceleration, double part, const double *limit) {
  double start = 0;
  for (size_t k = 1; k < 3000; k = k < 20 ? k + 1 : k + k / 10) {
    net s;
    double x[M];
    after(k, acceleration, 300, 0.5, HUNG, x, NULL, &s);
    double off = norm(x, limit, M);
    test_engine_close(&s.e);
    if (k == 1) start = off;
    if (off <= part * start) return k;
  }
  return 3000;
}

/* Ratios of successive errors settle below 1: two of them, ten iterations apart, within 2 %. */
static void errors_shrink_linearly(void **state) {
  (void)state;
  double limit[M], error[64];
  net s;
  after(4000, "none", 300, 0.5, HUNG, limit, NULL, &s);
  test_engine_close(&s.e);
  for (size_t k = 1; k < 64; k++) {
    double x[M];
    after(k, "none", 300, 0.5, HUNG, x, NULL, &s);
    error[k] = norm(x, limit, M);
    test_engine_close(&s.e);
  }
  for (size_t k = 2; k < 64; k++) assert_true(error[k] < error[k - 1]);
  double early = error[50] / error[49], late = error[60] / error[59];
  print_message("contraction %.4f, %.4f\n", early, late);
  assert_true(late < 1);
  assert_true(fabs(late / early - 1) < 0.02);
}

static void anderson_needs_fewer_iterations(void **state) {
  (void)state;
  double limit[M];
  net s;
  after(4000, "none", 300, 0.5, HUNG, limit, NULL, &s);
  test_engine_close(&s.e);
  size_t none = iterations_until("none", 1e-6, limit), anderson = iterations_until("anderson", 1e-6, limit);
  print_message("iterations to 1e-6 of the first error: none %zu, anderson %zu\n", none, anderson);
  assert_true(anderson < none);
}

/* Whatever acceleration does, it must end where the plain iteration ends. */
static void anderson_reaches_the_same_point(void **state) {
  (void)state;
  double plain[M], x[M];
  net s;
  after(4000, "none", 300, 20, SLIDING, plain, NULL, &s);
  test_engine_close(&s.e);
  after(400, "anderson", 300, 20, SLIDING, x, NULL, &s);
  test_engine_close(&s.e);
  assert_true(norm(x, plain, M) < 1e-11);
}

static void one_factorization_serves_all_steps(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 10, "none");
  hang(&s);
  s.e.scene->plugin[HK_FORCE].item[1]->to = 1;
  test_run(&s.e);
  test_advance(&s.e, 1);
  assert_int_equal(s.e.run->record.steps, 30);
  assert_int_equal(s.e.run->dynamics.count.factorizations, 1);
  test_advance(&s.e, 2); /* without the springs of force 1 */
  assert_int_equal(s.e.run->record.steps, 60);
  assert_int_equal(s.e.run->dynamics.count.factorizations, 2);
  test_engine_close(&s.e);
}

/* ---- Physics ---- */

static hk_status circle(const hk_function *self, const void *caller, const double *in, size_t n_in, double *out,
                        size_t max_out, size_t *n_out, hk_error *error) {
  (void)self, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = 0.1 * sin(3 * in[0]);
  out[1] = 0.05 * in[0];
  out[2] = 0.1 * (1 - cos(3 * in[0]));
  out[3] = 0.3 * cos(3 * in[0]);
  out[4] = 0.05;
  out[5] = 0.3 * sin(3 * in[0]);
  *n_out = 6;
  return HK_OK;
}

static void lead(net *s, uint32_t id) {
  hk_pin_spec spec = {.kind = HK_PIN_PATH, .count = 1, .id = &id, .path = {.call = circle}, .release = INFINITY};
  assert_int_equal(hk_scene_add_pin(s->e.scene, &spec, &s->e.error), HK_OK);
}

static void pins_keep_their_places_to_the_bit(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 10, "anderson");
  hang(&s);
  lead(&s, 1);
  test_run(&s.e);
  double start[3][3];
  static const uint32_t pinned[] = {N - SIDE + 1, N, 1};
  for (int k = 0; k < 3; k++) memcpy(start[k], test_position(&s.e, pinned[k]), sizeof start[k]);
  for (int f = 1; f <= 60; f++) {
    test_advance(&s.e, f / fps);
    for (int k = 0; k < 2; k++) {
      assert_memory_equal(test_position(&s.e, pinned[k]), start[k], sizeof start[k]);
      assert_memory_equal(test_velocity(&s.e, pinned[k]), (double[3]){0}, sizeof start[k]);
    }
    double offset[6], t = s.e.run->dynamics.system.t;
    size_t n_out;
    circle(NULL, NULL, &t, 1, offset, 6, &n_out, NULL);
    for (int c = 0; c < 3; c++) {
      assert_true(test_position(&s.e, 1)[c] == start[2][c] + offset[c]);
      assert_true(test_velocity(&s.e, 1)[c] == offset[3 + c]);
    }
  }
  test_engine_close(&s.e);
}

/* Backward Euler moves a point mass by v_k = v_0 + k h g, x_k = x_0 + k h v_0 + h^2 g k(k+1)/2. Two iterations a step
 * are far from converged: momentum must not depend on that. 1e-12: the solver's residual, 1e-15 of |A||dx| a step,
 * where |A| is 1e4 times the mass, over 60 steps of two iterations. */
static void centre_of_mass_falls_as_a_point_mass(void **state) {
  (void)state;
  static const char *const names[] = {"none", "anderson"};
  for (int a = 0; a < 2; a++) {
    net s;
    open_net(&s, 1e5, 1, 2 + 4 * (size_t)a, names[a]);
    for (size_t i = 0; i < N; i++) { /* spinning */
      s.e.scene->particles.velocity[3 * i] -= 5 * s.e.scene->particles.position[3 * i + 1];
      s.e.scene->particles.velocity[3 * i + 1] += 5 * s.e.scene->particles.position[3 * i];
    }
    test_run(&s.e);
    const hk_view *view = hk_run_view(s.e.run);
    double x0[3] = {0}, v0[3] = {0}, mass = 0;
    for (size_t e = 0; e < M; e++) {
      double m = view->model->mass[e / 3];
      x0[e % 3] += m * view->x[e];
      v0[e % 3] += m * view->v[e];
      mass += m / 3;
    }
    for (int k = 1; k <= 60; k++) {
      test_advance(&s.e, k / fps);
      double x[3] = {0}, v[3] = {0}, h = 1 / fps;
      view = hk_run_view(s.e.run);
      for (size_t e = 0; e < M; e++) {
        x[e % 3] += view->model->mass[e / 3] * view->x[e];
        v[e % 3] += view->model->mass[e / 3] * view->v[e];
      }
      for (int c = 0; c < 3; c++) {
        double g = c == 2 ? g_z : 0, vk = v0[c] / mass + k * h * g;
        double xk = x0[c] / mass + k * h * v0[c] / mass + h * h * g * k * (k + 1) / 2;
        if (!(fabs(x[c] / mass - xk) < 1e-12 * 20 && fabs(v[c] / mass - vk) < 1e-12 * 20 * fps))
          fail_msg("%s, step %d: off by %g m, %g m/s", names[a], k, x[c] / mass - xk, v[c] / mass - vk);
      }
    }
    test_engine_close(&s.e);
  }
}

/* One particle on a spring without rest length, along the spring: the oscillator that `growth` speaks of. The
 * quadratic is exact, so one iteration solves it. 1e-12: rounding. */
static void growth_is_the_stated_one(void **state) {
  (void)state;
  for (double hw = 0.1; hw < 100; hw *= 3)
    for (double hg = 0; hg < 300; hg = 4 * hg + 0.1) {
      double matrix[2][2]; /* (x, h v) -> (x, h v) */
      double stated = 0;
      for (int start = 0; start < 2; start++) {
        test_engine e;
        test_engine_open(&e);
        test_particle(&e, 0, 0, 0, 1);
        test_particle(&e, 1, 0, 0, 1);
        if (start) e.scene->particles.velocity[3] = 30; /* h v = 1 */
        test_pin(&e, HK_PIN_FIXED, 1, NULL);
        hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs"), *method;
        test_edges(&e, springs, (const uint32_t[][2]){{1, 2}}, 1);
        test_number(&e, springs, "k", hw * hw * 900);
        test_number(&e, springs, "damping", hg * 30);
        test_number(&e, springs, "rest", 0);
        method = test_plugin(&e, HK_INTEGRATOR, "local_global");
        test_number(&e, method, "iterations", 3);
        e.scene->fps = 30;
        e.options.dt = 1.0 / 30;
        test_run(&e);
        test_advance(&e, 1.0 / 30);
        matrix[0][start] = test_position(&e, 2)[0];
        matrix[1][start] = test_velocity(&e, 2)[0] / 30;
        stated = method->plugin->integrator->growth(method->values, NULL, hw, hg, 0);
        test_engine_close(&e);
      }
      matrix[0][1] -= matrix[0][0]; /* the second start was (1, 1) */
      matrix[1][1] -= matrix[1][0];
      double half = (matrix[0][0] + matrix[1][1]) / 2;
      double determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
      double root = half * half - determinant;
      double growth = root < 0 ? sqrt(determinant) : fabs(half) + sqrt(root);
      if (!(fabs(growth - stated) < 1e-12 + (fabs(root) < 1e-12 ? 1e-6 : 0)))
        fail_msg("hw = %g, hg = %g: states %.15g, measured %.15g", hw, hg, stated, growth);
    }
}

static double energy_of(hk_run *run) {
  return hk_state_kinetic(&run->state, run->state.X) + hk_query_potential(&run->dynamics, run->state.t, run->state.X);
}

/* Work of dampers, of drag and of a path against the energy that is there at the end: backward Euler loses some in
 * every step, a part that halves with h. Half a second with up to 4000 iterations, so that the iteration's own error is
 * none. */
static void energy_balance_is_of_first_order(void **state) {
  (void)state;
  double off[3];
  for (int k = 0; k < 3; k++) {
    net s;
    open_net(&s, 30, 0.5, 400, "anderson");
    add_drag(&s);
    lead(&s, 1);
    s.e.scene->fps = 400 << k;
    s.e.options.dt = 1 / s.e.scene->fps;
    test_run(&s.e);
    double first;
    hk_system *system = &s.e.run->dynamics.system;
    first = energy_of(s.e.run);
    test_advance(&s.e, 0.5);
    off[k] = energy_of(s.e.run) - first - system->X[system->size - 1];
    test_engine_close(&s.e);
  }
  print_message("energy off by %.3e, %.3e, %.3e J at h, h/2, h/4\n", off[0], off[1], off[2]);
  assert_true(fabs(off[1] / off[0] - 0.5) < 0.07);
  assert_true(fabs(off[2] / off[1] - 0.5) < 0.04);
}

static void results_do_not_depend_on_the_threads(void **state) {
  (void)state;
  double x[2][M];
  for (int k = 0; k < 2; k++) {
    net s;
    open_net(&s, 3000, 0.5, 10, "anderson");
    hang(&s);
    s.e.scene->threads = k + 1;
    test_run(&s.e);
    test_advance(&s.e, 1);
    memcpy(x[k], hk_run_view(s.e.run)->x, sizeof x[k]);
    test_engine_close(&s.e);
  }
  assert_memory_equal(x[0], x[1], sizeof x[0]);
}

/* ---- Hard cases ---- */

/* Three steps; what fails must say why. */
static void survive(net *s, const char *what, double frames) {
  s->e.scene->fps = frames;
  s->e.options.dt = 1 / frames;
  s->e.options.until = 1000;
  test_run(&s->e);
  hk_status status = hk_run_advance(s->e.run, 3 / frames, &s->e.error);
  print_message("%s: %s\n", what, status == HK_OK ? "ok" : s->e.error.text);
  assert_true(status == HK_OK || (status == HK_NOT_CONVERGED && s->e.error.text[0]));
  const hk_view *view = hk_run_view(s->e.run);
  for (size_t e = 0; e < 3 * view->n; e++) assert_true(isfinite(view->x[e]) && isfinite(view->v[e]));
  test_engine_close(&s->e);
}

static void hard_cases_end_finite_or_say_why(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 10, "anderson");
  survive(&s, "h = 10 s", 0.1);
  open_net(&s, 3000, 0.5, 10, "anderson");
  survive(&s, "h = 1e-12 s", 1e12);
  open_net(&s, 1e8, 0.5, 10, "none");
  survive(&s, "k = 1e8 N/m", fps);
  open_net(&s, 3000, 0.5, 10, "anderson");
  s.e.scene->particles.mass[5] *= 1e6;
  survive(&s, "mass ratio 1e6", fps);
  open_net(&s, 3000, 0.5, 10, "anderson");
  for (uint32_t id = 1; id <= N; id++) test_pin(&s.e, HK_PIN_FIXED, id, NULL);
  survive(&s, "pinned everywhere", fps);
  open_net(&s, 3000, 0.5, 10, "anderson");
  memcpy(s.e.scene->particles.position + 3, s.e.scene->particles.position, 3 * sizeof(double));
  survive(&s, "two particles at one point", fps);
  open_net(&s, 3000, 0.5, 10, "anderson");
  for (size_t k = 0; k < 3; k++) test_number(&s.e, s.e.scene->plugin[HK_FORCE].item[k], "rest", 0);
  survive(&s, "springs without length", fps);
  open_net(&s, 3000, 0.5, 10, "anderson");
  test_particle(&s.e, 5, 5, 5, 1);
  survive(&s, "a particle without springs", fps);
}

/* One particle and no spring: the explicit part alone, x' = x + h v', v' = v + h g. */
static void a_particle_alone_falls(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 2);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, g_z);
  test_plugin(&e, HK_INTEGRATOR, "local_global");
  e.scene->fps = fps;
  e.options.dt = 1 / fps;
  test_run(&e);
  test_advance(&e, 10 / fps);
  assert_true(fabs(test_position(&e, 1)[2] - g_z * 55 / (fps * fps)) < 1e-14);
  test_engine_close(&e);
}

static void few_iterations_are_warned_of(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    net s;
    open_net(&s, 3000, 0.5, k ? 3000 : 2, "anderson");
    test_run(&s.e);
    test_advance(&s.e, 3 / fps);
    assert_int_equal(s.e.run->warnings.count, k ? 0 : 1);
    test_engine_close(&s.e);
  }
}

/* ---- Refusals ---- */

static void step_fails(net *s, hk_status status, const char *text) {
  hk_step out = {1 / fps, 1 / fps, NAN};
  hk_system *system = &s->e.run->dynamics.system;
  double *before = malloc(system->size * sizeof *before);
  memcpy(before, system->X, system->size * sizeof *before);
  hk_instance *method = test_instance(&s->e, s->method);
  hk_status got = method->plugin->integrator->step(method->self, NULL, system, 1 / fps, 1 / fps, &out);
  assert_int_equal(got, status);
  if (!strstr(s->e.run->error.text, text)) fail_msg("'%s' is not in: %s", text, s->e.run->error.text);
  assert_memory_equal(before, system->X, system->size * sizeof *before);
  free(before);
  test_engine_close(&s->e);
}

static void a_force_between_particles_without_elements_is_refused_by_name(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 10, "none");
  hk_plugin_spec *cubic = test_plugin(&s.e, HK_FORCE, "cubic_springs");
  test_edges(&s.e, cubic, (const uint32_t[][2]){{1, 6}}, 1);
  test_number(&s.e, cubic, "k", 1);
  test_run(&s.e);
  step_fails(&s, HK_FAILED, "cubic_springs");
}

static void a_tolerance_that_is_not_met_is_said(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 2, "none");
  test_number(&s.e, s.method, "tolerance", 1e-9);
  test_run(&s.e);
  step_fails(&s, HK_NOT_CONVERGED, "2 iterations leave a relative change of");
}

/* The last change is reported against the tolerance, and fewer iterations do when that is met. */
static void a_tolerance_stops_the_iteration(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 5000, "none");
  test_number(&s.e, s.method, "tolerance", 1e-3);
  test_run(&s.e);
  hk_step out = {1 / fps, 1 / fps, NAN};
  hk_system *system = &s.e.run->dynamics.system;
  hk_instance *method = test_instance(&s.e, s.method);
  assert_int_equal(method->plugin->integrator->step(method->self, NULL, system, 1 / fps, 1 / fps, &out), HK_OK);
  assert_true(out.error <= 1 && out.error > 0.5); /* it stopped at the first that was small enough */
  test_engine_close(&s.e);
}

static void strong_drag_is_refused(void **state) {
  (void)state;
  net s;
  open_net(&s, 3000, 0.5, 10, "none");
  test_number(&s.e, test_plugin(&s.e, HK_FORCE, "drag"), "rate", 2.1 * fps);
  test_run(&s.e);
  step_fails(&s, HK_NOT_CONVERGED, "depend on the velocity");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(objective_never_rises),
      cmocka_unit_test(many_iterations_reach_backward_euler),
      cmocka_unit_test(errors_shrink_linearly),
      cmocka_unit_test(anderson_needs_fewer_iterations),
      cmocka_unit_test(anderson_reaches_the_same_point),
      cmocka_unit_test(one_factorization_serves_all_steps),
      cmocka_unit_test(pins_keep_their_places_to_the_bit),
      cmocka_unit_test(centre_of_mass_falls_as_a_point_mass),
      cmocka_unit_test(growth_is_the_stated_one),
      cmocka_unit_test(energy_balance_is_of_first_order),
      cmocka_unit_test(results_do_not_depend_on_the_threads),
      cmocka_unit_test(hard_cases_end_finite_or_say_why),
      cmocka_unit_test(a_particle_alone_falls),
      cmocka_unit_test(few_iterations_are_warned_of),
      cmocka_unit_test(a_force_between_particles_without_elements_is_refused_by_name),
      cmocka_unit_test(a_tolerance_that_is_not_met_is_said),
      cmocka_unit_test(a_tolerance_stops_the_iteration),
      cmocka_unit_test(strong_drag_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
