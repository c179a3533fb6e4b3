/* An unstructured mesh for benchmarks: the Delaunay triangulation of points strewn over the unit square, one in each
 * cell of a grid, so that the particles have from 3 to some 12 neighbours and no direction is preferred. Points are
 * inserted one by one into the triangle that holds them, which a walk from the last one finds, and edges are flipped
 * until no circle has a point in it (Lawson 1977, Software for C1 surface interpolation). A triangle around the square
 * is the start; what touches its corners is left out at the end. The points of the border lie on it, as those of a mesh
 * generator do: strewn in their cells as well, they would be joined by slivers with edges of forty cells. */
#ifndef HK_BENCH_DELAUNAY_H
#define HK_BENCH_DELAUNAY_H

#include <stdint.h>
#include <stdlib.h>

typedef struct triangle {
  uint32_t node[3], next[3]; /* next[k]: the triangle across from node[k]; UINT32_MAX: none */
} triangle;

typedef struct delaunay {
  size_t n, triangles;
  double (*x)[2]; /* n + 3, m; last the outer corners */
  triangle *triangle;
  uint32_t last; /* where the walk begins */
} delaunay;

static inline double delaunay_random(uint32_t *state) {
  *state = *state * 1664525 + 1013904223;
  return *state / 4294967296.0;
}

/* Twice the area of a, b, c, positive if they turn left. */
static inline double delaunay_turn(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static inline int delaunay_in_circle(const double *a, const double *b, const double *c, const double *p) {
  double d[3][3];
  const double *corner[] = {a, b, c};
  for (int k = 0; k < 3; k++) {
    d[k][0] = corner[k][0] - p[0];
    d[k][1] = corner[k][1] - p[1];
    d[k][2] = d[k][0] * d[k][0] + d[k][1] * d[k][1];
  }
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
             d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]) >
         0;
}

static inline uint32_t delaunay_find(const delaunay *d, const double *p) {
  uint32_t t = d->last;
  for (int k = 0; k < 3; k++) {
    const triangle *at = &d->triangle[t];
    const double *from = d->x[at->node[(k + 1) % 3]], *to = d->x[at->node[(k + 2) % 3]];
    if (delaunay_turn(from, to, p) >= 0) continue;
    t = at->next[k];
    k = -1;
  }
  return t;
}

/* Neighbour `t` has `now` where it had `old`. */
static inline void delaunay_renew(delaunay *d, uint32_t t, uint32_t old, uint32_t now) {
  for (int k = 0; t != UINT32_MAX && k < 3; k++)
    if (d->triangle[t].next[k] == old) {
      d->triangle[t].next[k] = now;
      return;
    }
}

/* Flips the edge across from node 0 of t, the new point, where its circle holds the corner beyond; then the same for
 * the two edges behind it. */
static inline void delaunay_mend(delaunay *d, uint32_t t) {
  triangle *a = &d->triangle[t];
  uint32_t s = a->next[0];
  if (s == UINT32_MAX) return;
  triangle *b = &d->triangle[s];
  int k = 0;
  while (b->next[k] != t) k++;
  uint32_t p = a->node[0], q = b->node[k], i = a->node[1], j = a->node[2];
  if (!delaunay_in_circle(d->x[p], d->x[i], d->x[j], d->x[q])) return;
  uint32_t across_j = b->next[(k + 1) % 3], across_i = b->next[(k + 2) % 3], side_i = a->next[2], side_j = a->next[1];
  *a = (triangle){{p, i, q}, {across_j, s, side_i}};
  *b = (triangle){{p, q, j}, {across_i, side_j, t}};
  delaunay_renew(d, across_j, s, t);
  delaunay_renew(d, side_j, t, s);
  delaunay_mend(d, t);
  delaunay_mend(d, s);
}

static inline void delaunay_insert(delaunay *d, uint32_t p) {
  uint32_t t = delaunay_find(d, d->x[p]), u = (uint32_t)d->triangles, w = u + 1;
  const triangle old = d->triangle[t];
  d->triangles += 2;
  d->triangle[t] = (triangle){{p, old.node[0], old.node[1]}, {old.next[2], u, w}};
  d->triangle[u] = (triangle){{p, old.node[1], old.node[2]}, {old.next[0], w, t}};
  d->triangle[w] = (triangle){{p, old.node[2], old.node[0]}, {old.next[1], t, u}};
  delaunay_renew(d, old.next[0], t, u);
  delaunay_renew(d, old.next[1], t, w);
  delaunay_mend(d, t);
  delaunay_mend(d, u);
  delaunay_mend(d, w);
  d->last = t;
}

/* In cell k of N along a side; in the first and the last one at the border. */
static inline double delaunay_place(uint32_t k, uint32_t N, uint32_t *state) {
  double place = (k + delaunay_random(state)) / N;
  return k == 0 ? 0 : k == N - 1 ? 1 : place;
}

/* N x N points; row after row, in turn from the left and from the right, so that walks are short. */
static inline delaunay delaunay_mesh(uint32_t N) {
  delaunay d = {.n = (size_t)N * N, .triangles = 1};
  uint32_t state = 12345, corner = N * N;
  d.x = malloc((d.n + 3) * sizeof *d.x);
  d.triangle = malloc((2 * d.n + 1) * sizeof *d.triangle);
  if (!d.x || !d.triangle) exit(1);
  d.x[corner][0] = -20, d.x[corner][1] = -10;
  d.x[corner + 1][0] = 21, d.x[corner + 1][1] = -10;
  d.x[corner + 2][0] = 0.5, d.x[corner + 2][1] = 30;
  d.triangle[0] = (triangle){{corner, corner + 1, corner + 2}, {UINT32_MAX, UINT32_MAX, UINT32_MAX}};
  for (uint32_t p = 0; p < d.n; p++) {
    uint32_t row = p / N, column = row % 2 ? N - 1 - p % N : p % N;
    d.x[p][0] = delaunay_place(column, N, &state);
    d.x[p][1] = delaunay_place(row, N, &state);
    delaunay_insert(&d, p);
  }
  return d;
}

static inline int delaunay_inside(const delaunay *d, const triangle *t) {
  return t->node[0] < d->n && t->node[1] < d->n && t->node[2] < d->n;
}

/* The edges of the mesh, or the pairs of points on both sides of one; at most 3 n. The number of them. */
static inline size_t delaunay_pairs(const delaunay *d, int across, uint32_t (*pair)[2]) {
  size_t count = 0;
  for (uint32_t t = 0; t < d->triangles; t++)
    for (int k = 0; k < 3; k++) {
      const triangle *a = &d->triangle[t];
      uint32_t s = a->next[k];
      int joined = s != UINT32_MAX && delaunay_inside(d, &d->triangle[s]);
      if (!delaunay_inside(d, a) || (joined && s < t) || (across && !joined)) continue;
      int other = 0;
      while (across && d->triangle[s].next[other] != t) other++;
      pair[count][0] = across ? a->node[k] : a->node[(k + 1) % 3];
      pair[count++][1] = across ? d->triangle[s].node[other] : a->node[(k + 2) % 3];
    }
  return count;
}

static inline void delaunay_free(delaunay *d) {
  free(d->x);
  free(d->triangle);
}

#endif
