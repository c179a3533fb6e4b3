/* Rigid bars: d.d = L^2 twice differentiated is d.(a_j - a_i) = -u.u, linear in the multipliers of all bars
 * (Hairer and Wanner, Solving ODEs II, VII.1, index 1). The equations are solved anew in every evaluation, and no state
 * is put back onto the lengths: by how much they drift is part of what the tolerances of the reference bound. */
#include "tests/adversary/adversary.h"

#include <math.h>

enum { BARS = ADV_EDGES };

typedef struct bars {
  int count, pair[BARS][2];
  adv_real d[BARS][3], mobility[3 * ADV_PARTICLES]; /* 1/kg; 0: held */
  adv_real matrix[BARS][BARS + 1];                  /* with the right-hand side behind */
} bars;

static void set_mobilities(bars *b, const adv_system *s) {
  const adv_scene *m = s->scene;
  for (int e = 0; e < 3 * m->n; e++) b->mobility[e] = 1 / (adv_real)m->mass[e / 3];
  for (int k = 0; k < m->pins; k++)
    for (int c = 0; c < 3 && s->inside < m->pin[k].release; c++) {
      const adv_pin *p = &m->pin[k];
      bool moves = (p->hold == ADV_LINE && c == p->axis) || (p->hold == ADV_PLANE && c != p->axis);
      if (!moves) b->mobility[3 * p->particle + c] = 0;
    }
}

static void set_bars(bars *b, const adv_scene *m, const adv_real *x) {
  b->count = 0;
  for (int k = 0; k < m->forces; k++)
    for (int e = 0; m->force[k].law == ADV_BARS && e < m->force[k].edges && b->count < BARS; e++, b->count++)
      for (int c = 0; c < 3; c++) {
        const int *pair = m->force[k].edge[e];
        b->pair[b->count][0] = pair[0], b->pair[b->count][1] = pair[1];
        b->d[b->count][c] = x[3 * pair[1] + c] - x[3 * pair[0] + c];
      }
}

/* The acceleration along bar e that a unit multiplier of bar f gives: J M^-1 J^T. */
static adv_real coupling(const bars *b, int e, int f) {
  adv_real sum = 0;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      for (int c = 0; c < 3 && b->pair[e][i] == b->pair[f][j]; c++)
        sum += (i == j ? 1 : -1) * b->d[e][c] * b->d[f][c] * b->mobility[3 * b->pair[e][i] + c];
  return sum;
}

static void fill(bars *b, const adv_real *v, const adv_real *F) {
  for (int e = 0; e < b->count; e++) {
    int i = 3 * b->pair[e][0], j = 3 * b->pair[e][1];
    adv_real *right = &b->matrix[e][b->count];
    *right = 0;
    for (int f = 0; f < b->count; f++) b->matrix[e][f] = coupling(b, e, f);
    for (int c = 0; c < 3; c++) {
      adv_real u = v[j + c] - v[i + c];
      *right += u * u + b->d[e][c] * (b->mobility[j + c] * F[j + c] - b->mobility[i + c] * F[i + c]);
    }
  }
}

/* Gauss and Jordan; the matrix is symmetric and positive. */
static void solve(bars *b) {
  int n = b->count;
  for (int k = 0; k < n; k++) {
    for (int c = n; c >= k; c--) b->matrix[k][c] /= b->matrix[k][k];
    for (int r = 0; r < n; r++)
      for (int c = n; r != k && c >= k; c--) b->matrix[r][c] -= b->matrix[r][k] * b->matrix[k][c];
  }
}

void adv_add_bars(const adv_system *s, const adv_real *y, adv_real *F) {
  bars b;
  set_bars(&b, s->scene, y);
  if (b.count == 0) return;
  set_mobilities(&b, s);
  fill(&b, y + 3 * s->scene->n, F);
  solve(&b);
  for (int e = 0; e < b.count; e++)
    for (int c = 0; c < 3; c++) {
      adv_real pull = b.matrix[e][b.count] * b.d[e][c];
      F[3 * b.pair[e][0] + c] += pull, F[3 * b.pair[e][1] + c] -= pull;
    }
}
