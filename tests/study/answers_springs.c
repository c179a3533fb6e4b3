/* The answers of those cases in tests/hard/ that are springs and have no closed form, computed with nothing of hooke:
 * networks of springs in long double, integrated by Gragg's midpoint rule extrapolated to order 16 (Hairer, Norsett and
 * Wanner, Solving ODEs I, II.9). Each case is run with two lengths of the basic step, which differ by more than what
 * the shorter one is off; that difference is printed as the error, and must be below 1e-13 m. Printed besides: how much
 * a disturbance of 1e-10 m of the start has grown at the end, and where it is known what the motion should come to.
 *
 * Arguments: the folder tests/hard. Compares what the cases' files have between "answer = {" and "}" with what is found
 * here; exits with 1 when a number differs by more than 1e-12 m times that growth (starts are rounded differently).
 * With
 * `--print` the numbers themselves, 17 digits each. A few seconds. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef long double real;

enum { MOST = 32, EDGES = 256, STATES = 6 * MOST, COLUMNS = 8 };

typedef struct net {
  int n, edges;
  real x[3 * MOST], v[3 * MOST], m[MOST]; /* m, m/s, kg */
  bool fixed[MOST], plane[MOST];          /* plane: z stays */
  struct {
    int i, j;
    real k, cubic, rest; /* N/m, N/m^3, m */
  } edge[EDGES];
  real g, drag;          /* m/s^2 along -z; 1/s */
  real load[MOST], ramp; /* N along -x, reached at `ramp` s */
} net;

/* ---- building ---- */

static int particle(net *s, real x, real y, real z, real m) {
  int i = s->n++;
  s->x[3 * i] = x, s->x[3 * i + 1] = y, s->x[3 * i + 2] = z;
  s->m[i] = m;
  return i;
}

static real length(const net *s, int i, int j) {
  real d[3];
  for (int c = 0; c < 3; c++) d[c] = s->x[3 * j + c] - s->x[3 * i + c];
  return sqrtl(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static void join_at(net *s, int i, int j, real k, real cubic, real rest) {
  int e = s->edges++;
  s->edge[e].i = i, s->edge[e].j = j;
  s->edge[e].k = k, s->edge[e].cubic = cubic, s->edge[e].rest = rest;
}

static void join(net *s, int i, int j, real k) { join_at(s, i, j, k, 0, length(s, i, j)); }

/* ---- the motion ---- */

static void add_springs(const net *s, const real *x, real *F) {
  for (int e = 0; e < s->edges; e++) {
    int i = s->edge[e].i, j = s->edge[e].j;
    real d[3], square = 0;
    for (int c = 0; c < 3; c++) {
      d[c] = x[3 * j + c] - x[3 * i + c];
      square += d[c] * d[c];
    }
    real l = sqrtl(square), stretch = l - s->edge[e].rest;
    real f = (s->edge[e].k * stretch + s->edge[e].cubic * stretch * stretch * stretch) / (l > 0 ? l : 1);
    for (int c = 0; c < 3; c++) {
      F[3 * i + c] += f * d[c];
      F[3 * j + c] -= f * d[c];
    }
  }
}

/* From 0 to 1 between t = 0 and t = `ramp`, with a rate that starts and ends at 0. */
static real share(const net *s, real t) {
  real p = t < s->ramp ? t / s->ramp : 1;
  return p * p * (3 - 2 * p);
}

static void rate(const net *s, real t, const real *X, real *dX) {
  int half = 3 * s->n;
  real F[3 * MOST] = {0};
  add_springs(s, X, F);
  for (int i = 0; i < s->n; i++) {
    if (s->load[i] > 0) F[3 * i] -= s->load[i] * share(s, t);
    for (int c = 0; c < 3; c++) {
      int e = 3 * i + c;
      bool held = s->fixed[i] || (s->plane[i] && c == 2);
      dX[e] = held ? 0 : X[half + e];
      dX[half + e] = held ? 0 : F[e] / s->m[i] - s->drag * X[half + e] - (c == 2 ? s->g : 0);
    }
  }
}

/* Gragg's midpoint rule in `parts` steps from X at t to `into` at t + H. */
static void midpoint(const net *s, real t, const real *X, real H, int parts, real *into) {
  int size = 6 * s->n;
  real h = H / parts, before[STATES], now[STATES], slope[STATES];
  memcpy(before, X, (size_t)size * sizeof *X);
  rate(s, t, X, slope);
  for (int e = 0; e < size; e++) now[e] = X[e] + h * slope[e];
  for (int p = 1; p < parts; p++) {
    rate(s, t + p * h, now, slope);
    for (int e = 0; e < size; e++) {
      real next = before[e] + 2 * h * slope[e];
      before[e] = now[e];
      now[e] = next;
    }
  }
  memcpy(into, now, (size_t)size * sizeof *into);
}

/* One basic step: parts of 2, 4, ... 16, extrapolated in the square of their length. */
static void extrapolate(const net *s, real t, real *X, real H) {
  static real table[COLUMNS][STATES];
  int size = 6 * s->n;
  for (int j = 0; j < COLUMNS; j++) {
    midpoint(s, t, X, H, 2 * (j + 1), table[j]);
    for (int k = j - 1; k >= 0; k--) {
      real ratio = (real)(j + 1) / (k + 1), divisor = ratio * ratio - 1;
      for (int e = 0; e < size; e++) table[k][e] = table[k + 1][e] + (table[k + 1][e] - table[k][e]) / divisor;
    }
  }
  memcpy(X, table[0], (size_t)size * sizeof *X);
}

/* To T in equal steps of at most `longest` on either side of the end of the ramp. */
static void integrate(const net *s, real T, real longest, real *X) {
  real ends[2] = {s->ramp < T ? s->ramp : T, T}, t = 0;
  memcpy(X, s->x, (size_t)(3 * s->n) * sizeof *X);
  memcpy(X + 3 * s->n, s->v, (size_t)(3 * s->n) * sizeof *X);
  for (int part = 0; part < 2; part++) {
    real begin = t, span = ends[part] - begin;
    long steps = (long)ceill(span / longest);
    for (long k = 0; k < steps; k++) extrapolate(s, begin + span * k / steps, X, span / steps);
    t = ends[part];
  }
}

static real apart(const net *s, const real *a, const real *b) {
  real most = 0;
  for (int e = 0; e < 3 * s->n; e++) most = fmaxl(most, fabsl(a[e] - b[e]));
  return most;
}

/* ---- the cases ---- */

static const real PI = 3.14159265358979323846264338327950288L;

static void mass_ratio(net *s) {
  real heavy[3] = {1.55L, 0.1L, 0};
  for (int i = 0; i < 7; i++) {
    real share_of = i < 3 ? i / 3.0L : (6 - i) / 3.0L, end = i < 3 ? 0 : 3;
    particle(s, end + (heavy[0] - end) * share_of, heavy[1] * share_of, 0, i == 3 ? 1 : 1e-6L);
    if (i > 0) join_at(s, i - 1, i, 100, 0, 0.4L);
  }
  s->fixed[0] = s->fixed[6] = true;
  s->g = 9.81L;
}

static void heavy_on_string(net *s) {
  real k = 1e5L, l = 0.125L + 9.81L / 2 / k;
  for (int i = 0; i <= 8; i++) {
    particle(s, i * l * sqrtl(0.75L), 0, -i * l / 2, i == 8 ? 1 : 1e-3L);
    if (i > 0) join_at(s, i - 1, i, k, 0, 0.125L);
  }
  s->fixed[0] = true;
  s->g = 9.81L;
}

static void collinear_hair(net *s) {
  for (int i = 0; i < 12; i++) {
    particle(s, 0.02L * i, i % 2 ? 1e-7L : -1e-7L, 0, 1e-4L);
    if (i > 0) join(s, i - 1, i, 100);
    if (i > 1) join(s, i - 2, i, 10);
  }
  s->fixed[0] = s->fixed[1] = true;
  s->g = 9.81L;
}

static void slivers(net *s) {
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 4; i++) {
      int p = particle(s, 0.1L * (i / 2) + 1e-4L * (i % 2), 0.1L * j, 0, 0.01L);
      if (i > 0) join(s, p - 1, p, 200);
      if (j > 0) join(s, p - 4, p, 200);
      if (i > 0 && j > 0) join(s, p - 5, p, 200);
    }
  s->fixed[12] = s->fixed[15] = true;
  s->g = 9.81L;
}

/* A column of two chords in a plane, clamped at one end, its axis off by 1e-3 m (1 - cos(pi x/(2 l))). */
static void buckling_strip(net *s) {
  for (int i = 0; i < 13; i++)
    for (int j = 0; j < 2; j++) {
      real x = 0.1L * i;
      int p = particle(s, x, 0.05L * j + 1e-3L * (1 - cosl(PI * x / 2.4L)), 0, 0.01L);
      s->plane[p] = true;
      if (j > 0) join(s, p - 1, p, 1e4L);
      if (i > 0) join(s, p - 2, p, 1e4L);
      if (i > 0) join(s, j > 0 ? p - 3 : p - 1, p, 5e3L);
    }
  s->fixed[0] = s->fixed[1] = true;
  s->load[24] = s->load[25] = 1.6L;
  s->ramp = 0.3L;
}

/* A mast of three chords, clamped at one end. */
static void euler_column(net *s) {
  static const int diagonal[6][2] = {{0, 1}, {1, 2}, {2, 0}, {1, 0}, {2, 1}, {0, 2}};
  real r = 0.05L, h = r * sqrtl(3) / 2, y[3] = {r, -r / 2, -r / 2}, z[3] = {0, h, -h};
  for (int i = 0; i < 9; i++) {
    real x = 0.1L * i, off = -1e-3L * (1 - cosl(PI * x / 1.6L));
    for (int j = 0; j < 3; j++) particle(s, x, y[j] + off, z[j], 0.01L);
    for (int j = 0; j < 3; j++) {
      join(s, 3 * i + j, 3 * i + (j + 1) % 3, 1e4L);
      if (i > 0) join(s, 3 * i - 3 + j, 3 * i + j, 4e3L);
    }
    for (int d = 0; d < 6 && i > 0; d++) join(s, 3 * i - 3 + diagonal[d][0], 3 * i + diagonal[d][1], 1e4L);
  }
  for (int j = 0; j < 3; j++) {
    s->fixed[j] = true;
    s->load[24 + j] = 3;
  }
  s->ramp = 0.3L;
  s->drag = 6;
}

static void hardening(net *s) {
  particle(s, 0, 0, 0, 1);
  particle(s, 1, 0, 0, 1);
  join_at(s, 0, 1, 0, 1e6L, 1);
  s->fixed[0] = true;
  s->v[3] = 5;
}

static void resonance(net *s) {
  particle(s, 0, 0, 0, 1);
  particle(s, 1, 0, 0, 1);
  join_at(s, 0, 1, 40, 10, 0);
  s->fixed[0] = true;
}

static void ringing_links(net *s) {
  particle(s, 0, 0, 0, 1);
  particle(s, 1, 0, 0, 1);
  particle(s, 1.504L, 1.008L * sqrtl(0.75L), 0, 1);
  join_at(s, 0, 1, 1e6L, 0, 1);
  join_at(s, 1, 2, 1e6L, 0, 1);
  s->fixed[0] = true;
}

static const struct hard_case {
  const char *name;
  void (*build)(net *);
  real T, longest; /* s */
} cases[] = {
    {"mass_ratio", mass_ratio, 0.4L, 8e-5L},
    {"heavy_on_string", heavy_on_string, 0.3L, 8e-5L},
    {"collinear_hair", collinear_hair, 0.2L, 5e-4L},
    {"slivers", slivers, 0.2L, 2e-4L},
    {"buckling_strip", buckling_strip, 1, 5e-4L},
    {"euler_column", euler_column, 4, 5e-4L},
    {"hardening", hardening, 1, 1.5e-3L},
    {"resonance", resonance, 50, 0.02L},
    {"ringing_links", ringing_links, 0.7L, 3e-4L},
    {"ringing_released", ringing_links, 0.7L, 3e-4L}, /* from the release on */
};

/* ---- what is printed and compared ---- */

/* The numbers between "answer = {" and "}"; returns how many. */
static int read_answer(const char *folder, const char *name, real *answer) {
  static char text[1 << 16];
  char path[1024];
  int count = 0;
  snprintf(path, sizeof path, "%s/%s.lua", folder, name);
  FILE *f = fopen(path, "r");
  size_t got = f ? fread(text, 1, sizeof text - 1, f) : 0;
  if (f) fclose(f);
  text[got] = 0;
  char *at = strstr(text, "answer = {"), *end = at;
  for (at = at ? at + strlen("answer = {") : NULL; at && count < 3 * MOST; at = end + strspn(end, ", \n")) {
    real value = strtold(at, &end);
    if (end == at) break;
    answer[count++] = value;
  }
  return count;
}

static void print_answer(const net *s, const real *X) {
  for (int i = 0; i < s->n; i++) printf("  %.17Lg, %.17Lg, %.17Lg,\n", X[3 * i], X[3 * i + 1], X[3 * i + 2]);
}

static real disturbed(const net *s, real T, real longest, const real *X) {
  static real other[STATES];
  net off = *s;
  for (int e = 0; e < 3 * s->n; e++)
    if (!s->fixed[e / 3] && !(s->plane[e / 3] && e % 3 == 2)) off.x[e] += 1e-10L * sinl(7 * e + 1);
  integrate(&off, T, longest, other);
  return apart(s, X, other) / 1e-10L;
}

static bool settle(const struct hard_case *c, const char *folder, bool print) {
  static net s;
  static real X[STATES], coarse[STATES], stored[STATES];
  memset(&s, 0, sizeof s);
  c->build(&s);
  integrate(&s, c->T, c->longest, X);
  integrate(&s, c->T, 1.5L * c->longest, coarse);
  real error = apart(&s, X, coarse), growth = disturbed(&s, c->T, c->longest, X);
  int count = read_answer(folder, c->name, stored);
  real off = count == 3 * s.n ? apart(&s, X, stored) : INFINITY, most = 1e-12L * fmaxl(1, growth);
  bool fine = error < 1e-13L * fmaxl(1, growth) && off <= most;
  printf("%-18s error %.1Le m, a disturbance grows by %.1Le, the file is off by %.1Le m (%.0Le allowed): %s\n", c->name,
         error, growth, off, most, fine ? "right" : "WRONG");
  if (print) print_answer(&s, X);
  return fine;
}

int main(int count, char **argument) {
  bool print = count > 2 && strcmp(argument[2], "--print") == 0, fine = true;
  if (count < 2) {
    fprintf(stderr, "usage: %s tests/hard [--print]\n", argument[0]);
    return 2;
  }
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) fine = settle(&cases[k], argument[1], print) && fine;
  return fine ? 0 : 1;
}
