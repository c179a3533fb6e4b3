/* See repulsion.h. The elastic part has exact blocks. So has all that depends on velocities, which is linear in the
 * pair's weights; how damping and friction change with the positions, which turn their normal, are central
 * differences. */
#include "plugins/common/contact/repulsion/repulsion.h"

#include "plugins/kit/vector3.h"

#include <string.h>

/* Of the way on which the force turns: errors are its square, and rounding over it. */
static const double difference = 1e-4;
/* The square of the sine below which the energy of two edges has faded to nothing that matters. */
static const double nearly_parallel = 1e-6;

typedef struct state {
  hk_nearest near;
  double distance, n[3];
  double x;                 /* m, how far the pair is inside the reach */
  double f, slope;          /* N; N/m: -df/dgap */
  double mollifier, energy; /* J, without the mollifier */
  double g[12];             /* of the mollifier, 1/m */
} state;

double hk_repulsion_size(const hk_repulsion *r, double gap) {
  double x = fmax(0, r->reach - gap);
  return r->stiffness * x * x * x / (3 * r->reach * r->reach);
}

static bool begin(state *s, const hk_repulsion *r, const hk_repelled *p) {
  s->near = hk_nearest_of_pair(p->pair.kind, p->x);
  s->distance = sqrt(s->near.squared);
  s->x = r->reach - (s->distance - p->pair.offset);
  if (!(s->x > 0 && s->distance > 0)) return false;
  for (int c = 0; c < 3; c++) s->n[c] = s->near.d[c] / s->distance;
  double part = s->x / r->reach;
  s->slope = r->stiffness * part * part;
  s->f = s->slope * s->x / 3;
  s->energy = s->f * s->x / 4;
  s->mollifier = 1;
  memset(s->g, 0, sizeof s->g);
  if (p->mollified > 0) s->mollifier = hk_edge_mollifier(p->x, p->mollified, s->g, NULL);
  return true;
}

double hk_repulsion_energy(const hk_repulsion *r, const hk_repelled *p) {
  state s;
  return begin(&s, r, p) ? s.mollifier * s.energy : 0;
}

/* What acts on the first nearest point beside f n, for its velocity V relative to the other. */
static void dissipate(const hk_repulsion *r, const state *s, const double V[3], double force[3]) {
  double along = hk_dot(V, s->n), N = s->f * fmax(0, 1 - r->damping * along), u[3];
  for (int c = 0; c < 3; c++) u[c] = V[c] - along * s->n[c];
  double drag = r->friction * N / sqrt(hk_dot(u, u) + r->slip * r->slip);
  for (int c = 0; c < 3; c++) force[c] = s->mollifier * ((N - s->f) * s->n[c] - drag * u[c]);
}

static void relative(const state *s, const hk_repelled *p, double V[3]) {
  for (int c = 0; c < 3; c++) V[c] = 0;
  for (int i = 0; i < 4; i++) hk_add_scaled(V, s->near.w[i], p->v + 3 * i);
}

static bool dissipates(const hk_repulsion *r) { return r->damping > 0 || r->friction > 0; }

bool hk_repulsion_force(const hk_repulsion *r, const hk_repelled *p, double F[12], double *power) {
  state s;
  double V[3], lost[3] = {0};
  *power = 0;
  if (!begin(&s, r, p)) return false;
  if (dissipates(r)) {
    relative(&s, p, V);
    dissipate(r, &s, V, lost);
    *power = hk_dot(lost, V);
  }
  for (int k = 0; k < 12; k++)
    F[k] = s.near.w[k / 3] * (s.mollifier * s.f * s.n[k % 3] + lost[k % 3]) - s.energy * s.g[k];
  return true;
}

/* ---- blocks ---- */

static void elastic_blocks(const state *s, const hk_repelled *p, bool definite, double K[144]) {
  double E1 = -s->f / (2 * s->distance), E2 = (s->slope + s->f / s->distance) / (4 * s->near.squared), H[144];
  hk_distance_energy_hessian(&s->near, p->x, E1, E2, definite, K);
  for (int k = 0; k < 144; k++) K[k] *= s->mollifier;
  if (definite || !(p->mollified > 0)) return;
  double g[12];
  hk_edge_mollifier(p->x, p->mollified, g, H);
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < 12; j++) {
      double a = -s->f * s->near.w[i / 3] * s->n[i % 3], b = -s->f * s->near.w[j / 3] * s->n[j % 3];
      K[12 * i + j] += a * g[j] + g[i] * b + s->energy * H[12 * i + j];
    }
}

/* M = -d(force)/dV of `dissipate`. */
static void velocity_block(const hk_repulsion *r, const state *s, const double V[3], bool symmetric, double M[3][3]) {
  double along = hk_dot(V, s->n), left = 1 - r->damping * along, N = s->f * fmax(0, left), u[3];
  double falls = left > 0 ? s->f * r->damping : 0; /* -dN/d along */
  for (int c = 0; c < 3; c++) u[c] = V[c] - along * s->n[c];
  double size = sqrt(hk_dot(u, u) + r->slip * r->slip), drag = r->friction * N / size;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      double m = falls * s->n[a] * s->n[b];
      m += drag * ((a == b) - s->n[a] * s->n[b] - u[a] * u[b] / (size * size));
      if (!symmetric) m -= r->friction * falls * u[a] * s->n[b] / size;
      M[a][b] = s->mollifier * m;
    }
}

static void dissipation_at(const hk_repulsion *r, const hk_repelled *p, double F[12]) {
  state s;
  double V[3], lost[3];
  memset(F, 0, 12 * sizeof *F);
  if (!begin(&s, r, p)) return;
  relative(&s, p, V);
  dissipate(r, &s, V, lost);
  for (int k = 0; k < 12; k++) F[k] = s.near.w[k / 3] * lost[k % 3];
}

/* The sine of two edges' angle, by which their nearest points move faster than the edges; 1 for other pairs. */
static double sine_of(const hk_repelled *p) {
  double u[3], v[3], across[3];
  hk_subtract(u, p->x + 3, p->x);
  hk_subtract(v, p->x + 9, p->x + 6);
  hk_cross(across, u, v);
  double sizes = hk_length(u) * hk_length(v);
  return p->pair.kind == HK_EDGE_EDGE && sizes > 0 ? fmax(sqrt(nearly_parallel), hk_length(across) / sizes) : 1;
}

/* A normal that turns by slip/|V| makes another friction. */
static double difference_step(const hk_repulsion *r, const hk_repelled *p) {
  state s;
  double V[3];
  begin(&s, r, p);
  relative(&s, p, V);
  return difference * fmin(s.x, s.distance) * r->slip / (r->slip + hk_length(V)) * sine_of(p);
}

/* Whether point i and the next are one particle, as the two ends of an isolated one. */
static bool is_twin(const hk_repelled *p, int i) {
  const double *x = p->x + 3 * i;
  return p->pair.kind == HK_EDGE_EDGE && i % 2 == 0 && x[0] == x[3] && x[1] == x[4] && x[2] == x[5];
}

static void add_differences(const hk_repulsion *r, const hk_repelled *p, double K[144]) {
  double step = difference_step(r, p), ahead[12], behind[12];
  for (int j = 0; j < 12; j++) {
    bool twin = is_twin(p, j / 3);
    if (j >= 3 && is_twin(p, j / 3 - 1)) continue;
    hk_repelled moved = *p;
    moved.x[j] = p->x[j] + step;
    if (twin) moved.x[j + 3] = moved.x[j];
    dissipation_at(r, &moved, ahead);
    moved.x[j] = p->x[j] - step;
    if (twin) moved.x[j + 3] = moved.x[j];
    dissipation_at(r, &moved, behind);
    for (int i = 0; i < 12; i++) K[12 * i + j] -= (ahead[i] - behind[i]) / (2 * step);
  }
}

bool hk_repulsion_blocks(const hk_repulsion *r, const hk_repelled *p, unsigned want, double K[144], double D[144]) {
  state s;
  double V[3], M[3][3] = {{0}};
  bool definite = want & HK_WANT_DEFINITE, symmetric = want != 0;
  if (!begin(&s, r, p)) return false;
  elastic_blocks(&s, p, definite, K);
  relative(&s, p, V);
  if (dissipates(r)) velocity_block(r, &s, V, symmetric, M);
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < 12; j++) D[12 * i + j] = s.near.w[i / 3] * s.near.w[j / 3] * M[i % 3][j % 3];
  if (dissipates(r) && !symmetric) add_differences(r, p, K);
  return true;
}
