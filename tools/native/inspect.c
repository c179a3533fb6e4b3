/* inspect: evaluates one force of a scene directly, for `hooke check`. The first force of a tool's run (scene:run{ to =
 * 0 }) is evaluated at states made here, random or degenerate; the run itself does not change. Differences are central
 * ones, and the best of several steps counts: a long step has a truncation error, a short one a rounding error. */
#include "core/lua/lua.h"
#include "core/base/base.h"

#include <lauxlib.h>
#include <lua.h>
#include <string.h>
#include <time.h>

static void set_number(lua_State *L, const char *key, double value) {
  lua_pushnumber(L, value);
  lua_setfield(L, -2, key);
}

static void set_flag(lua_State *L, const char *key, bool value) {
  lua_pushboolean(L, value);
  lua_setfield(L, -2, key);
}

/* threads(scene, n): sets the number of threads of the scene's run. */
static int set_threads(lua_State *L) {
  hk_script_run_options(hk_lua_owner(L, 1))->threads = (int)luaL_checkinteger(L, 2);
  return 0;
}

/* quiet(): runs of this tool print no warnings, such as those of steps above the limit, which the tools use on
 * purpose. */
static int set_quiet(lua_State *L) {
  hk_script_run_options(hk_lua_script(L))->progress = -1;
  return 0;
}

/* ---- the force at a state ---- */

typedef struct subject {
  hk_instance *instance;
  const hk_force *force;
  hk_view view; /* x and v point to arrays of this struct */
  size_t n, size;
  double *x, *v, *F, *other;
  double *K, *D, *measured; /* size x size; before the Jacobians `measured` has `size` numbers */
  size_t count, room;       /* number of named blocks and of allocated slots */
  uint32_t (*at)[2];
  bool fine; /* every call returned HK_OK */
} subject;

/* The memory of a subject belongs to the Lua state, so that errors do not leak it. */
static double *numbers(lua_State *L, size_t count) {
  double *p = lua_newuserdatauv(L, (count + 1) * sizeof *p, 0);
  memset(p, 0, (count + 1) * sizeof *p);
  return p;
}

static hk_run *run_of(lua_State *L) {
  hk_run *run = hk_lua_run(L);
  if (run->plugins.kind[HK_FORCE].count == 0) luaL_error(L, "check: there is no run with a force");
  return run;
}

static subject look(lua_State *L) {
  hk_run *run = run_of(L);
  subject s = {.instance = run->plugins.kind[HK_FORCE].item[0], .view = run->dynamics.force_view[0], .fine = true};
  s.n = run->state.model.n;
  luaL_checkstack(L, 16, "check");
  s.force = s.instance->plugin->force;
  s.size = 3 * s.n;
  s.x = numbers(L, s.size);
  s.v = numbers(L, s.size);
  s.F = numbers(L, s.size);
  s.other = numbers(L, s.size);
  s.measured = numbers(L, s.size);
  memcpy(s.x, run->state.X, s.size * sizeof *s.x);
  memcpy(s.v, run->state.X + s.size, s.size * sizeof *s.v);
  s.view.x = s.x;
  s.view.v = s.v;
  s.view.power = NULL;
  return s;
}

typedef enum shape { RANDOM, COINCIDENT, COLLINEAR, FLAT, MIRRORED, SHAPES } shape;
static const char *const shape_name[] = {"random", "coincident", "collinear", "flat", "mirrored", NULL};

static void place(subject *s, shape how, uint64_t seed) {
  uint64_t random[4];
  hk_random_seed(random, seed);
  for (size_t i = 0; i < s->n; i++)
    for (size_t c = 0; c < 3; c++) {
      double *x = &s->x[3 * i + c], off = 2 * hk_random_uniform(random) - 1;
      s->v[3 * i + c] = how == RANDOM ? 2 * hk_random_uniform(random) - 1 : 0;
      if (how == RANDOM) *x += 0.3 * off;
      if (how == COINCIDENT) *x = 0;
      if (how == COLLINEAR) *x = c == 0 ? (double)i * 0.37 : 0;
      if (how == FLAT && c == 1) *x = 0;
      if (how == MIRRORED && c == 0) *x = -*x;
    }
}

/* Evaluates F at (x, v), added to `start` in every entry; returns the power of non-conservative parts. */
static double evaluate(subject *s, double *F, double start, bool with_power) {
  double power = 0;
  for (size_t k = 0; k < s->size; k++) F[k] = start;
  s->view.power = with_power ? &power : NULL;
  s->fine &= s->force->add(s->instance->self, &s->view, F) == HK_OK;
  return power;
}

static double energy(subject *s) { return s->force->energy ? s->force->energy(s->instance->self, &s->view) : 0; }

static double largest(const double *a, size_t count) {
  double most = 0;
  for (size_t k = 0; k < count; k++)
    if (!(fabs(a[k]) <= most)) most = fabs(a[k]); /* true for NAN as well */
  return most;
}

/* |a - b| over the largest |a|; infinite when a number is not finite. */
static double relative_difference(const double *a, const double *b, size_t count) {
  double most = largest(a, count), off = 0;
  for (size_t k = 0; k < count; k++) off = fmax(off, fabs(a[k] - b[k]));
  if (!isfinite(most) || !isfinite(largest(b, count))) return INFINITY;
  return most > 0 ? off / most : off;
}

/* ---- against its energy ---- */

enum { STEPS = 9 };
/* The k-th difference step, m or m/s, for lengths and speeds of about 1; down to 2.6e-8. */
static double step_of(int k) { return 1e-2 * pow(0.2, k); }

/* F + dE/dx. */
static double gradient_error(subject *s) {
  double best = INFINITY;
  evaluate(s, s->F, 0, false);
  for (int q = 0; q < STEPS; q++) {
    double h = step_of(q);
    for (size_t k = 0; k < s->size; k++) {
      double at = s->x[k];
      s->x[k] = at + h;
      double up = energy(s);
      s->x[k] = at - h;
      s->other[k] = -(up - energy(s)) / (2 * h);
      s->x[k] = at;
    }
    best = fmin(best, relative_difference(s->F, s->other, s->size));
  }
  return best;
}

/* F.v + dE/dt along v - power, over the sum of |F_i v_i|. */
static double power_error(subject *s) {
  double power = evaluate(s, s->F, 0, true), work = 0, scale = 0, best = INFINITY;
  for (size_t k = 0; k < s->size; k++) {
    work += s->F[k] * s->v[k];
    scale += fabs(s->F[k] * s->v[k]);
  }
  for (int q = 0; q < STEPS; q++) {
    double h = step_of(q), up;
    for (size_t k = 0; k < s->size; k++) s->x[k] += h * s->v[k];
    up = energy(s);
    for (size_t k = 0; k < s->size; k++) s->x[k] -= 2 * h * s->v[k];
    double rate = (up - energy(s)) / (2 * h);
    for (size_t k = 0; k < s->size; k++) s->x[k] += h * s->v[k];
    best = fmin(best, fabs(work + rate - power));
  }
  return scale > 0 ? best / scale : best;
}

/* ---- sums ---- */

static void momenta(subject *s, double *linear, double *angular) {
  double sum[6] = {0}, force = 0, moment = 0;
  evaluate(s, s->F, 0, false);
  for (size_t i = 0; i < s->n; i++) {
    const double *x = s->x + 3 * i, *F = s->F + 3 * i;
    for (size_t c = 0; c < 3; c++) {
      size_t d = (c + 1) % 3, e = (c + 2) % 3;
      sum[c] += F[c];
      sum[3 + c] += x[d] * F[e] - x[e] * F[d];
      force += fabs(F[c]);
      moment += fabs(x[d] * F[e]) + fabs(x[e] * F[d]);
    }
  }
  *linear = force > 0 ? largest(sum, 3) / force : 0;
  *angular = moment > 0 ? largest(sum + 3, 3) / moment : 0;
}

/* ---- Jacobians ---- */

typedef struct names {
  hk_pattern pattern; /* first member */
  lua_State *L;
  subject *s;
  bool outside;
} names;

static void count_block(hk_pattern *pattern, uint32_t row, uint32_t column) {
  names *list = (names *)(void *)pattern;
  list->outside |= row >= list->s->n || column >= list->s->n;
  if (list->s->at && list->s->count < list->s->room) {
    list->s->at[list->s->count][0] = row;
    list->s->at[list->s->count][1] = column;
  }
  list->s->count++;
}

/* Has the force name its blocks twice, to count and to store them. False: a block is out of range, or the second naming
 * differs. */
static bool name_blocks(lua_State *L, subject *s) {
  names list = {{count_block}, L, s, false};
  s->force->pattern(s->instance->self, &s->view, &list.pattern);
  s->room = s->count;
  s->at = lua_newuserdatauv(L, (s->room + 1) * sizeof *s->at, 0);
  s->count = 0;
  s->force->pattern(s->instance->self, &s->view, &list.pattern);
  return !list.outside && s->count == s->room;
}

static void expand(const subject *s, const double *block, double *full) {
  memset(full, 0, s->size * s->size * sizeof *full);
  for (size_t b = 0; b < s->count; b++)
    for (size_t q = 0; q < 9; q++)
      full[(3 * s->at[b][0] + q / 3) * s->size + 3 * s->at[b][1] + q % 3] += block[9 * b + q];
}

/* Computes K and D as full matrices. */
static void matrices(subject *s, double *block, size_t *slot, unsigned want) {
  memset(block, 0, 18 * s->count * sizeof *block);
  for (size_t b = 0; b < s->count; b++) slot[b] = b;
  hk_blocks into = {slot, block, block + 9 * s->count, want};
  s->fine &= s->force->jacobian(s->instance->self, &s->view, &into) == HK_OK;
  expand(s, block, s->K);
  expand(s, block + 9 * s->count, s->D);
}

static double matrix_error(subject *s, double *z, const double *A, double *step) {
  double best = INFINITY;
  for (int q = 0; q < STEPS; q++) {
    double h = step_of(q);
    for (size_t k = 0; k < s->size; k++) {
      double at = z[k];
      z[k] = at + h;
      evaluate(s, s->F, 0, false);
      z[k] = at - h;
      evaluate(s, s->other, 0, false);
      z[k] = at;
      for (size_t r = 0; r < s->size; r++) s->measured[r * s->size + k] = -(s->F[r] - s->other[r]) / (2 * h);
    }
    double error = relative_difference(A, s->measured, s->size * s->size);
    if (error < best) *step = h;
    best = fmin(best, error);
  }
  return best;
}

static double asymmetry(const double *A, size_t size) {
  double most = largest(A, size * size), off = 0;
  for (size_t r = 0; r < size; r++)
    for (size_t k = 0; k < r; k++) off = fmax(off, fabs(A[r * size + k] - A[k * size + r]));
  return most > 0 ? off / most : 0;
}

/* Whether A + 1e-9 |A| I has a Cholesky factor: no eigenvalue of the symmetric part is below -1e-9 |A|. */
static bool definite(const double *A, size_t size, double *factor) {
  double shift = 1e-9 * largest(A, size * size);
  for (size_t r = 0; r < size; r++)
    for (size_t k = 0; k <= r; k++) {
      double sum = (A[r * size + k] + A[k * size + r]) / 2 + (r == k ? shift : 0);
      for (size_t q = 0; q < k; q++) sum -= factor[r * size + q] * factor[k * size + q];
      if (r == k && sum < 0) return false;
      factor[r * size + k] = r == k ? sqrt(sum) : factor[k * size + k] > 0 ? sum / factor[k * size + k] : 0;
    }
  return true;
}

static void push_jacobians(lua_State *L, subject *s, int result) {
  size_t full = s->size * s->size;
  bool named = name_blocks(L, s);
  s->K = numbers(L, full);
  s->D = numbers(L, full);
  s->measured = numbers(L, full);
  double *block = numbers(L, 18 * s->count), h = 0;
  size_t *slot = lua_newuserdatauv(L, (s->count + 1) * sizeof *slot, 0);
  lua_pushvalue(L, result);
  set_flag(L, "pattern", named);
  if (!named) return;
  matrices(s, block, slot, 0);
  set_number(L, "asymmetry", fmax(asymmetry(s->K, s->size), asymmetry(s->D, s->size)));
  set_number(L, "stiffness", matrix_error(s, s->x, s->K, &h));
  set_number(L, "stiffness_step", h);
  set_number(L, "damping", matrix_error(s, s->v, s->D, &h));
  set_number(L, "damping_step", h);
  matrices(s, block, slot, HK_WANT_SYMMETRIC);
  set_number(L, "wanted_asymmetry", fmax(asymmetry(s->K, s->size), asymmetry(s->D, s->size)));
  matrices(s, block, slot, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE);
  set_flag(L, "definite", definite(s->K, s->size, s->measured) && definite(s->D, s->size, s->measured));
}

/* ---- dependence on x, v and channels, and reproducibility ---- */

static bool same_bits(const subject *s) { return memcmp(s->F, s->other, s->size * sizeof *s->F) == 0; }

/* Whether F changes with z, which is x or v. */
static bool depends_on(subject *s, double *z) {
  for (size_t k = 0; k < s->size; k++) {
    s->measured[k] = z[k];
    z[k] += 0.1 * sin((double)k);
  }
  evaluate(s, s->other, 0, false);
  memcpy(z, s->measured, s->size * sizeof *z);
  return !same_bits(s);
}

static void push_habits(lua_State *L, subject *s) {
  double t = s->view.t;
  evaluate(s, s->F, 0, false);
  evaluate(s, s->other, 0, true);
  set_flag(L, "repeats", same_bits(s)); /* F has equal bits in both evaluations, with and without its power */
  evaluate(s, s->other, 1, false);
  for (size_t k = 0; k < s->size; k++) s->other[k] -= 1;
  set_number(L, "adds", relative_difference(s->F, s->other, s->size));
  set_flag(L, "moved_by_x", depends_on(s, s->x));
  set_flag(L, "moved_by_v", depends_on(s, s->v));
  s->view.t = t + 0.1;
  evaluate(s, s->other, 0, false);
  s->view.t = t;
  set_flag(L, "moved_by_t", !same_bits(s));
  double astray = 0;
  for (size_t k = 0; k < s->size && s->view.is_active; k++)
    if (!s->view.is_active[k / 3]) astray = fmax(astray, fabs(s->F[k]));
  set_number(L, "astray", astray);
  set_number(L, "force", largest(s->F, s->size));
}

/* force(run, shape, seed) -> the results of the tests of the run's first force at this state: for degenerate shapes
 * whether all numbers are finite, for random ones all tests. */
static int check_force(lua_State *L) {
  int how = luaL_checkoption(L, 2, "random", shape_name);
  uint64_t seed = (uint64_t)luaL_checkinteger(L, 3);
  lua_newtable(L);
  int result = lua_gettop(L);
  subject s = look(L);
  place(&s, (shape)how, seed);
  lua_pushvalue(L, result);
  evaluate(&s, s.F, 0, false);
  bool finite = isfinite(largest(s.F, s.size)) && isfinite(energy(&s));
  if (how == RANDOM) {
    double linear, angular;
    push_habits(L, &s);
    momenta(&s, &linear, &angular);
    set_number(L, "momentum", linear);
    set_number(L, "angular_momentum", angular);
    set_number(L, "power", power_error(&s));
    set_number(L, "gradient", gradient_error(&s));
    if (s.force->jacobian) push_jacobians(L, &s, result);
  } else if (s.force->jacobian && name_blocks(L, &s)) {
    s.K = numbers(L, s.size * s.size);
    s.D = numbers(L, s.size * s.size);
    double *block = numbers(L, 18 * s.count);
    matrices(&s, block, lua_newuserdatauv(L, (s.count + 1) * sizeof(size_t), 0), 0);
    finite = finite && isfinite(largest(s.K, s.size * s.size)) && isfinite(largest(s.D, s.size * s.size));
  }
  lua_settop(L, result);
  set_flag(L, "finite", finite);
  set_flag(L, "fine", s.fine);
  return 1;
}

/* bytes(run, seed) -> F at a random state as a string. */
static int force_bytes(lua_State *L) {
  subject s = look(L);
  place(&s, RANDOM, (uint64_t)luaL_checkinteger(L, 2));
  evaluate(&s, s.F, 0, false);
  lua_pushlstring(L, (const char *)s.F, s.size * sizeof *s.F);
  return 1;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* seconds(run) -> the time of one evaluation, the least of several, since other load can only increase it. */
static int force_seconds(lua_State *L) {
  subject s = look(L);
  double best = INFINITY;
  place(&s, RANDOM, 1);
  for (int k = 0; k < 20; k++) {
    double begin = now();
    evaluate(&s, s.F, 0, false);
    best = fmin(best, now() - begin);
  }
  lua_pushnumber(L, best);
  return 1;
}

__attribute__((visibility("default"))) int luaopen_inspect(lua_State *L);

int luaopen_inspect(lua_State *L) {
  static const luaL_Reg functions[] = {{"threads", set_threads}, {"quiet", set_quiet},       {"force", check_force},
                                       {"bytes", force_bytes},   {"seconds", force_seconds}, {NULL, NULL}};
  luaL_newlib(L, functions);
  return 1;
}
