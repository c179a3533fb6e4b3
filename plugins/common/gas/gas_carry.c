/* MacCormack's scheme for all fields of a gas. The first step goes back along the flow to where a value comes from; the
 * second comes forth again and so knows the first one's error, of which half is taken away. */
#include "plugins/common/gas/gas.h"

enum { CENTRES = 3 };

static void flow_at(const hk_gas *s, const double x[3], double u[3]) {
  const hk_liquid_grid *g = &s->flow.grid;
  hk_liquid_place at;
  hk_liquid_locate(g, x, &at);
  for (int a = 0; a < 3; a++) u[a] = g->flat[a] ? 0 : hk_liquid_value(g, s->along[a], &at, a);
}

/* Where what is at x, where the flow is u, goes in h, by the midpoint rule. */
static void follow(const hk_gas *s, const double x[3], const double u[3], double h, double to[3]) {
  double middle[3], there[3];
  for (int c = 0; c < 3; c++) middle[c] = x[c] + h / 2 * u[c];
  flow_at(s, middle, there);
  for (int c = 0; c < 3; c++) to[c] = x[c] + h * there[c];
}

static bool is_outside(const hk_liquid_grid *g, const double x[3]) {
  for (int c = 0; c < 3; c++)
    if (!g->flat[c] && (x[c] < g->low[c] || x[c] > g->high[c])) return true;
  return false;
}

/* Whether x is beyond a side that lets air in: 1; and whether wind blows in there: 2. */
static int beyond(const hk_gas *s, const double x[3]) {
  const hk_liquid_grid *g = &s->flow.grid;
  int found = 0;
  for (int c = 0; c < 3; c++) {
    int side = x[c] < g->low[c] ? 0 : x[c] > g->high[c] ? 1 : -1;
    if (g->flat[c] || side < 0 || !s->open[c][side]) continue;
    if (s->inlet[c][side]) return 2;
    found = 1;
  }
  return found;
}

/* What arrives from the place `foot`, that is x or outside the box. */
static double arriving(const hk_gas *s, int f, const hk_liquid_place *at, int outside) {
  if (outside && f >= HK_GAS_HEAT) return 0;
  if (outside == 2) return s->wind[f];
  return hk_liquid_value(&s->flow.grid, s->from[f], at, f < 3 ? f : CENTRES);
}

/* The fields at one kind of places: a component, or all that is in centres. */
static int first_of(int kind) { return kind; }
static int end_of(int kind) { return kind < CENTRES ? kind + 1 : HK_GAS_FIELDS; }

static void go_back(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  for (int kind = 0; kind <= CENTRES; kind++) {
    double x[3], u[3], foot[3];
    hk_liquid_place at;
    if (!hk_gas_has(g, row, i, kind)) continue;
    hk_gas_point(g, row, i, kind, x);
    flow_at(s, x, u);
    follow(s, x, u, -t->h, foot);
    hk_liquid_locate(g, foot, &at);
    int outside = beyond(s, foot);
    for (int f = first_of(kind); f < end_of(kind); f++)
      if (s->carried[f]) s->work[f][i] = arriving(s, f, &at, outside);
  }
}

/* The value within those that the first step interpolated. */
static double within(const hk_gas *s, int f, const hk_liquid_place *at, double value) {
  const hk_liquid_grid *g = &s->flow.grid;
  double part[3], low = INFINITY, high = -INFINITY;
  const double *v = s->from[f] + hk_liquid_corner(g, at, f < 3 ? f : CENTRES, part);
  for (int b = 0; b < 8; b++) {
    size_t to = 0;
    bool used = true;
    for (int c = 0; c < 3; c++) {
      bool next = b >> c & 1;
      used &= !next || part[c] > 0;
      to += next ? g->stride[c] : 0;
    }
    if (!used) continue;
    low = fmin(low, v[to]);
    high = fmax(high, v[to]);
  }
  return fmax(low, fmin(high, value));
}

static void come_forth(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  for (int kind = 0; kind <= CENTRES; kind++) {
    double x[3], u[3], foot[3], head[3];
    hk_liquid_place from, to;
    if (!hk_gas_has(g, row, i, kind)) continue;
    hk_gas_point(g, row, i, kind, x);
    flow_at(s, x, u);
    follow(s, x, u, -t->h, foot);
    follow(s, x, u, t->h, head);
    bool plain = is_outside(g, foot) || is_outside(g, head); /* nothing is known of the error */
    hk_liquid_locate(g, foot, &from);
    hk_liquid_locate(g, head, &to);
    for (int f = first_of(kind); f < end_of(kind); f++) {
      if (!s->carried[f]) continue;
      double there = s->work[f][i], again = hk_liquid_value(g, s->work[f], &to, f < 3 ? f : CENTRES);
      s->now[f][i] = plain ? there : within(s, f, &from, there + (s->from[f][i] - again) / 2);
    }
  }
}

void hk_gas_carry(hk_gas *s, double h) {
  hk_gas_task t = {.gas = s, .h = h};
  hk_gas_each(&t, go_back);
  hk_gas_each(&t, come_forth);
}
