/* Links of bodies that are distances and differences of points of theirs, evaluated from the bodies' particles without
 * the places of the points in between. A point is the same sum, in the same order, as the rider there
 * (engine/state/riders.c), and an equation the same number as its constraint's. */
#include "core/numerics/rigid/rigid.h"

#include "core/plugin/widest.h"

#include <math.h>

typedef double two __attribute__((vector_size(16), aligned(8), may_alias));

/* Point e of a pair. */
HK_INLINE void find_point(const hk_rigid_pair *p, int e, const double *x, double to[3]) {
  const double *a = x + p->at[e][0], *b = x + p->at[e][1], *c = x + p->at[e][2], *d = x + p->at[e][3];
  const double *w = p->weight[e];
  *(two *)to = w[0] * *(const two *)a + w[1] * *(const two *)b + w[2] * *(const two *)c + w[3] * *(const two *)d;
  to[2] = w[0] * a[2] + w[1] * b[2] + w[2] * c[2] + w[3] * d[2];
}

HK_INLINE void find_values(const hk_rigid_pair *pair, size_t count, const double *x, double *g) {
  for (const hk_rigid_pair *p = pair; p < pair + count; p++) {
    double from[3], to[3], *of = g + p->equation;
    find_point(p, 0, x, from);
    find_point(p, 1, x, to);
    for (int c = 0; c < 3; c++) to[c] -= from[c];
    if (p->distance)
      *of = p->length[0] - sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    else
      for (int c = 0; c < 3; c++) of[c] = to[c] - p->length[c];
  }
}

/* The wrench of the force f at r, its numbers `apart`. */
HK_INLINE void add_force(const double r[3], const double f[3], double *row, size_t apart) {
  for (size_t c = 0; c < 3; c++) row[c * apart] += f[c];
  row[3 * apart] += r[1] * f[2] - r[2] * f[1];
  row[4 * apart] += r[2] * f[0] - r[0] * f[2];
  row[5 * apart] += r[0] * f[1] - r[1] * f[0];
}

/* The wrenches of the unit forces along the axes times s, row by row. */
HK_INLINE void add_forces(const double r[3], double s, double *row, size_t apart, size_t next) {
  double x = s * r[0], y = s * r[1], z = s * r[2];
  row[0] += s, row[4 * apart] += z, row[5 * apart] -= y;
  row += next;
  row[apart] += s, row[3 * apart] -= z, row[5 * apart] += x;
  row += next;
  row[2 * apart] += s, row[3 * apart] += y, row[4 * apart] -= x;
}

/* What end e, at `at`, adds to the gradients: with f, that of a distance. */
HK_INLINE void place_end(hk_rigid_node *list, const hk_rigid_pair *p, int e, const double *x, const double at[3],
                         const double *f) {
  hk_rigid_node *link = &list[p->node];
  if (p->of[e] == HK_HELD) return;
  const bool own = p->of[e] == HK_OWN;
  const hk_rigid_node *body = own ? link : &list[link->parent];
  const double *first = x + 3 * (size_t)body->particle[0];
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = at[c] - first[c] + body->at[0][c];
  if (own && f)
    add_force(r, f, &link->own_across[0][p->row], HK_RIGID_ROWS);
  else if (own)
    add_forces(r, e ? 1 : -1, &link->own_across[0][p->row], HK_RIGID_ROWS, 1);
  else if (f)
    add_force(r, f, link->other[p->row], 1);
  else
    add_forces(r, e ? 1 : -1, link->other[p->row], 1, HK_RIGID_ROWS);
}

HK_INLINE void place_pairs(hk_rigid_node *list, const hk_rigid_pair *pair, size_t pairs, const double *x) {
  for (const hk_rigid_pair *p = pair; p < pair + pairs; p++) {
    double from[3], to[3], f[3], back[3];
    find_point(p, 0, x, from);
    find_point(p, 1, x, to);
    if (p->distance) {
      for (int c = 0; c < 3; c++) f[c] = to[c] - from[c];
      double now = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), by = now > 0 ? 1 / now : 0;
      for (int c = 0; c < 3; c++) f[c] *= by, back[c] = -f[c];
    }
    place_end(list, p, 0, x, from, p->distance ? f : NULL);
    place_end(list, p, 1, x, to, p->distance ? back : NULL);
  }
}

HK_VERSIONS(static void, value_any, (const hk_rigid_pair *pair, size_t count, const double *x, double *g),
            find_values(pair, count, x, g))
HK_VERSIONS(static void, place_any, (hk_rigid_node * list, const hk_rigid_pair *pair, size_t pairs, const double *x),
            place_pairs(list, pair, pairs, x))

void hk_rigid_pairs_value(int width, const hk_rigid_pair *pair, size_t count, const double *x, double *g) {
  HK_WIDEST(width, value_any)(pair, count, x, g);
}

void hk_rigid_pairs_place(int width, hk_rigid_node *list, size_t count, const hk_rigid_pair *pair, size_t pairs,
                          const double *x) {
  hk_rigid_bodies_place(width, list, count, x);
  HK_WIDEST(width, place_any)(list, pair, pairs, x);
}
