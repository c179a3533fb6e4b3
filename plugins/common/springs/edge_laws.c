/* See edge_laws.h. With u = v_j - v_i, derivatives of f n by x = x_j - x_i and by u give
 *     K = f_l n n^T + f/l (I - n n^T) + f_l'/l n (u - l' n)^T,   D = f_l' n n^T;
 * the last part of K, not symmetric, is left out where that is wanted, and f/l < 0 where definite blocks are. */
#include "plugins/common/springs/edge_laws.h"

#include "plugins/kit/springs/edge.h"
#include "plugins/kit/springs/edge_stiffness.h"

/* m: below it an edge has no direction, since the square of its length has lost its digits. */
static const double shortest = 1e-145;

hk_status hk_edge_laws_topology(void *self, const hk_view *view) {
  hk_edge_laws *s = self;
  return hk_part_sums_sort(&s->sums, view, &s->edges, view->is_active);
}

/* And u, the difference of the velocities. */
static double measure(const hk_view *view, const uint32_t pair[2], double n[3], double u[3], double *rate) {
  double l = hk_edge_difference(view->x, pair, n), r = l > shortest ? 1 / l : 0;
  hk_edge_difference(view->v, pair, u);
  *rate = 0;
  for (int c = 0; c < 3; c++) n[c] *= r, *rate += u[c] * n[c];
  return l;
}

double hk_edge_laws_measure(const hk_view *view, const uint32_t pair[2], double n[3], double *rate) {
  double u[3];
  return measure(view, pair, n, u, rate);
}

static bool acts(const hk_edge_laws *s, const hk_view *view, size_t e) {
  return hk_edge_acts(view, hk_tuple(&s->edges, e)) && !(s->gone && s->gone(s, e));
}

static double pull(const void *laws, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  const hk_edge_laws *s = laws;
  for (size_t k = 0; k < count; k++) {
    const uint32_t *pair = hk_tuple(&s->edges, item[k]);
    hk_edge_answer a = {0};
    double n[3], rate, l = hk_edge_laws_measure(view, pair, n, &rate);
    if (s->gone && s->gone(s, item[k])) continue;
    s->law(s, view, item[k], l, rate, &a);
    for (int c = 0; c < 3; c++) {
      F[3 * (size_t)pair[0] + c] += a.force * n[c];
      F[3 * (size_t)pair[1] + c] -= a.force * n[c];
    }
  }
  return 0; /* what is dissipated is told by the force's `evolve` */
}

void hk_edge_laws_add_part(void *self, const hk_view *view, size_t part, double *F) {
  const hk_edge_laws *s = self;
  hk_part_sums_add(&s->sums, view, part, pull, s, F);
}

void hk_edge_laws_touch(void *self, const hk_view *view, const hk_part_use *use) {
  const hk_edge_laws *s = self;
  (void)view;
  hk_part_lists_touch(&s->sums.lists, &s->edges, use);
}

double hk_edge_laws_energy(void *self, const hk_view *view) {
  const hk_edge_laws *s = self;
  double sum = 0, n[3], rate;
  for (size_t e = 0; e < s->edges.count; e++) {
    hk_edge_answer a = {0};
    if (!acts(s, view, e)) continue;
    double l = hk_edge_laws_measure(view, hk_tuple(&s->edges, e), n, &rate);
    s->law(s, view, e, l, rate, &a);
    sum += a.energy;
  }
  return sum;
}

void hk_edge_laws_pattern(void *self, const hk_view *view, hk_pattern *p) {
  const hk_edge_laws *s = self;
  for (size_t e = 0; e < s->edges.count; e++)
    for (int b = 0; b < 4 && acts(s, view, e); b++)
      p->block(p, hk_tuple(&s->edges, e)[b / 2], hk_tuple(&s->edges, e)[b % 2]);
}

static void blocks_of(const hk_edge_answer *a, double l, const double n[3], const double u[3], double rate,
                      unsigned want, double K[9], double D[9]) {
  bool directed = l > shortest;
  double across = directed ? a->force / l : 0, turn = directed && !want ? a->damping / l : 0;
  if (want & HK_WANT_DEFINITE) across = fmax(0, across);
  for (int q = 0; q < 9; q++) {
    double nn = n[q / 3] * n[q % 3], unit = directed && q % 4 == 0;
    K[q] = a->stiffness * nn + across * (unit - nn) + turn * n[q / 3] * (u[q % 3] - rate * n[q % 3]);
    D[q] = a->damping * nn;
  }
}

hk_status hk_edge_laws_jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const hk_edge_laws *s = self;
  const size_t *slot = into->slot;
  for (size_t e = 0; e < s->edges.count; e++) {
    double n[3], u[3], rate, K[9], D[9];
    hk_edge_answer a = {0};
    if (!acts(s, view, e)) continue;
    double l = measure(view, hk_tuple(&s->edges, e), n, u, &rate);
    s->law(s, view, e, l, rate, &a);
    blocks_of(&a, l, n, u, rate, into->want, K, D);
    for (int b = 0; b < 4; b++)
      for (size_t q = 0; q < 9; q++) {
        into->K[9 * slot[b] + q] += b % 3 == 0 ? K[q] : -K[q];
        into->D[9 * slot[b] + q] += b % 3 == 0 ? D[q] : -D[q];
      }
    slot += 4;
  }
  return HK_OK;
}

void hk_edge_laws_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const hk_edge_laws *s = self;
  for (size_t e = 0; e < s->edges.count; e++) {
    double n[3], rate;
    hk_edge_answer a = {0};
    if (!acts(s, view, e)) continue;
    double l = hk_edge_laws_measure(view, hk_tuple(&s->edges, e), n, &rate);
    s->law(s, view, e, l, rate, &a);
    double across = l > shortest ? fmax(0, a.force / l) : 0, along = s->stiffest(s, e);
    if (part == HK_DAMPING_WHOLE) along = fmax(0, a.damping), across = 0;
    hk_edge_stiffness_add(view, hk_tuple(&s->edges, e), n, along, across, block);
  }
}
