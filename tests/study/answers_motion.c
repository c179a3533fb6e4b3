/* The answers of those cases of tests/hard that have no closed form and are about motion: masses on springs under
 * weight, integrated in long double by extrapolated midpoint steps (Gragg, Bulirsch and Stoer; Hairer, Norsett and
 * Wanner, Solving ODEs I, II.9: order 2 COLUMNS with the sequence 2, 4, 6, ...). Nothing of hooke is used. Each case is
 * integrated with a step and with half of it; the difference is the error that is printed, and `growth` is what a start
 * that is off by 1e-17 m has become at the end, over 1e-17 m. Then the number list `answer` in the case's file is
 * compared: 1 is returned where one of them is not as computed, to the accuracy that was reached. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 3, SIZE = 6 * MOST, COLUMNS = 5 };

typedef long double real;

typedef struct motion {
  const char *name;
  int n, springs;
  real mass[MOST]; /* 0: fixed */
  real x[MOST][3], v[MOST][3];
  int pair[MOST][2];
  real k[MOST], rest[MOST], damping, weight; /* damping: along each spring, N s/m; weight: m/s^2, down */
  real end, step;
} motion;

/* clang-format off */
static const motion motions[] = {
    {.name = "three_bodies", .n = 3, .mass = {1, 2, 0.5L},
     .x = {{0, 0, 0}, {1.5L, 0, 0.25L}, {0.25L, 1.25L, 0}}, .v = {{0, -1, 0.5L}, {0, 2, 0}, {-1, 0, -1}},
     .springs = 3, .pair = {{0, 1}, {1, 2}, {2, 0}}, .k = {100, 50, 80}, .rest = {1, 1.25L, 1},
     .end = 2, .step = 1 / 512.0L},
    {.name = "double_pendulum", .n = 3, .mass = {0, 1, 1}, .x = {{0}, {1}, {2}}, .weight = 10,
     .springs = 2, .pair = {{0, 1}, {1, 2}}, .k = {1000, 1000}, .rest = {1, 1}, .end = 2, .step = 1 / 512.0L},
    {.name = "chaos", .n = 3, .mass = {0, 1, 1}, .x = {{0}, {1}, {2}}, .weight = 10,
     .springs = 2, .pair = {{0, 1}, {1, 2}}, .k = {1000, 1000}, .rest = {1, 1}, .end = 30, .step = 1 / 512.0L},
    {.name = "damped_spinner", .n = 2, .mass = {0.00025L, 0.02L}, .x = {{-0.5L}, {0}}, .v = {{0, -75, 0}, {0}},
     .springs = 1, .pair = {{0, 1}}, .k = {250}, .damping = 0.15L, .end = 0.3L, .step = 1 / 16384.0L},
};
/* clang-format on */
enum { MOTIONS = sizeof motions / sizeof *motions };

/* y: positions, then velocities. */
static void rates(const motion *m, const real *y, real *dy) {
  for (int e = 0; e < 3 * m->n; e++) dy[e] = y[3 * m->n + e];
  real *a = dy + 3 * m->n;
  for (int e = 0; e < 3 * m->n; e++) a[e] = e % 3 == 2 && m->mass[e / 3] > 0 ? -m->weight : 0;
  for (int s = 0; s < m->springs; s++) {
    int i = m->pair[s][0], j = m->pair[s][1];
    real d[3], l = 0, along = 0; /* along: of the rate of d, times l */
    for (int c = 0; c < 3; c++) d[c] = y[3 * j + c] - y[3 * i + c], l += d[c] * d[c];
    for (int c = 0; c < 3; c++) along += d[c] * (y[3 * (m->n + j) + c] - y[3 * (m->n + i) + c]);
    l = sqrtl(l);
    for (int c = 0; c < 3; c++) {
      real f = (m->k[s] * (l - m->rest[s]) + m->damping * along / l) * d[c] / l;
      if (m->mass[i] > 0) a[3 * i + c] += f / m->mass[i];
      if (m->mass[j] > 0) a[3 * j + c] -= f / m->mass[j];
    }
  }
}

/* `parts` midpoint steps across h; the error has even powers of h / parts alone. */
static void midpoints(const motion *m, const real *y, real h, int parts, real *out) {
  int size = 6 * m->n;
  real before[SIZE], now[SIZE], slope[SIZE], part = h / parts;
  rates(m, y, slope);
  for (int e = 0; e < size; e++) before[e] = y[e], now[e] = y[e] + part * slope[e];
  for (int k = 1; k < parts; k++) {
    rates(m, now, slope);
    for (int e = 0; e < size; e++) {
      real next = before[e] + 2 * part * slope[e];
      before[e] = now[e], now[e] = next;
    }
  }
  memcpy(out, now, (size_t)size * sizeof *out);
}

/* One extrapolated step, by Aitken and Neville. */
static void extrapolate(const motion *m, real *y, real h) {
  real row[COLUMNS][SIZE];
  for (int k = 0; k < COLUMNS; k++) {
    midpoints(m, y, h, 2 * (k + 1), row[k]);
    for (int j = k - 1; j >= 0; j--) {
      real ratio = (real)(k + 1) / (real)(j + 1);
      for (int e = 0; e < 6 * m->n; e++) row[j][e] = row[j + 1][e] + (row[j + 1][e] - row[j][e]) / (ratio * ratio - 1);
    }
  }
  memcpy(y, row[0], (size_t)(6 * m->n) * sizeof *y);
}

static void integrate(const motion *m, real step, real off, real *y) {
  for (int e = 0; e < 3 * m->n; e++) y[e] = m->x[e / 3][e % 3], y[3 * m->n + e] = m->v[e / 3][e % 3];
  y[3 * m->n - 1] += off; /* the last one, upwards */
  long steps = lroundl(m->end / step);
  for (long k = 0; k < steps; k++) extrapolate(m, y, m->end / (real)steps);
}

static real distance(const motion *m, const real *a, const real *b) {
  real sum = 0;
  for (int e = 0; e < 3 * m->n; e++) sum += (a[e] - b[e]) * (a[e] - b[e]);
  return sqrtl(sum / (real)m->n);
}

/* The numbers behind "answer = {" in the case's file; returns how many there are. */
static int stored(const char *name, real *x, int room) {
  char path[4096], text[1 << 14];
  snprintf(path, sizeof path, "%s/tests/hard/%s.lua", HK_ROOT, name);
  FILE *f = fopen(path, "r");
  size_t got = f ? fread(text, 1, sizeof text - 1, f) : 0;
  if (f) fclose(f);
  text[got] = 0;
  const char *at = strstr(text, "answer = {");
  int count = 0;
  if (!at) return 0;
  at += strlen("answer = {");
  for (char *end; count < room; at = end + strspn(end, " ,\n")) {
    x[count] = strtold(at, &end);
    if (end == at) break;
    count++;
  }
  return count;
}

static int check(const motion *m) {
  real coarse[SIZE], y[SIZE], off[SIZE], known[SIZE];
  integrate(m, m->step, 0, coarse);
  integrate(m, m->step / 2, 0, y);
  integrate(m, m->step / 2, 1e-17L, off);
  real error = distance(m, coarse, y);
  printf("%s: error %.1Le m, growth %.1Le\n  answer = {\n", m->name, error, distance(m, off, y) / 1e-17L);
  for (int i = 0; i < m->n; i++) printf("    %.17Lg, %.17Lg, %.17Lg,\n", y[3 * i], y[3 * i + 1], y[3 * i + 2]);
  printf("  }\n");
  bool complete = stored(m->name, known, SIZE) == 3 * m->n;
  /* 1e-15: what 17 digits of coordinates of metres keep; 10: another compiler rounds otherwise. */
  bool right = complete && distance(m, known, y) <= 10 * error + 1e-15L;
  if (!complete) printf("  tests/hard/%s.lua has other than %d numbers\n", m->name, 3 * m->n);
  if (complete && !right) printf("  tests/hard/%s.lua is %.3Le m off\n", m->name, distance(m, known, y));
  return right ? 0 : 1;
}

int main(void) {
  int wrong = 0;
  for (int k = 0; k < MOTIONS; k++) wrong |= check(&motions[k]);
  return wrong;
}
