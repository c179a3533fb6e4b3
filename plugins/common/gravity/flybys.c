/* A pair whose move is 4 ranges or less has no encounter. With the range sqrt(nearest^2 + softening^2)/3, and nearest
 * at least R - l for a distance R after a move of length l, these are pairs with R >= 7/4 l, or l <= 4/3 of the
 * softening.
 */
#include "plugins/common/gravity/flybys.h"

static const double away = 1.75, soft = 4.0 / 3;

static double moved(const hk_flybys *f, size_t i) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) sum += pow(f->to->x[3 * i + c] - f->x_from[3 * i + c], 2);
  return sqrt(sum);
}

static double longest_move(const hk_flybys *f) {
  double most = 0;
  for (size_t k = 0; k < f->to->acting; k++) most = fmax(most, moved(f, f->to->active ? f->to->active[k] : k));
  return most;
}

bool hk_flybys_possible(const hk_flybys *f) { return 2 * longest_move(f) > soft * f->softening; }

/* The force on the first body of a pair as a function of the vector from the second. */
typedef struct law {
  double strength, eps2;
} law;

static void law_at(const void *self, const double r[3], double F[3]) {
  const law *l = self;
  double s2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + l->eps2, f = l->strength / (s2 * sqrt(s2));
  for (int c = 0; c < 3; c++) F[c] = -f * r[c];
}

static void add_pair(const hk_flybys *f, uint32_t i, uint32_t j) {
  const double *m = f->to->model->mass, *from = f->x_from, *to = f->to->x;
  hk_encounter way = {.i = i, .other = j};
  for (size_t c = 0; c < 3; c++) {
    size_t a = 3 * (size_t)i + c, b = 3 * (size_t)j + c;
    way.r[c] = from[a] - from[b];
    way.dr[c] = to[a] - to[b] - way.r[c];
  }
  double nearest = hk_nearest_square(way.r, way.dr);
  if (!(nearest < INFINITY)) return;
  law l = {f->G * m[i] * m[j], f->softening * f->softening};
  way.range = sqrt(nearest + l.eps2) / 3;
  f->into->add(f->into, &way, law_at, &l);
}

static double distance2_to_box(const double *x, const hk_octree_cell *cell) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) {
    double off = fmax(fmax(cell->low[c] - x[c], x[c] - cell->high[c]), 0);
    sum += off * off;
  }
  return sum;
}

/* Pairs of i with those of a higher index. */
static void find_of(const hk_flybys *f, const hk_octree *t, uint32_t i, double reach) {
  const double *x = f->to->x + 3 * (size_t)i;
  for (size_t k = 0; k < t->cells;) {
    const hk_octree_cell *cell = &t->cell[k];
    bool near = distance2_to_box(x, cell) <= reach * reach, leaf = cell->next == k + 1;
    for (size_t q = cell->begin; near && leaf && q < (size_t)cell->begin + cell->count; q++)
      if (t->order[q] > i && f->acts(f->self, i, t->order[q])) add_pair(f, i, t->order[q]);
    k = near ? k + 1 : cell->next;
  }
}

void hk_flybys_find(const hk_flybys *f, const hk_octree *t) {
  double most = longest_move(f);
  for (size_t k = 0; k < t->points; k++) {
    double length = moved(f, t->order[k]) + most;
    if (length > soft * f->softening) find_of(f, t, t->order[k], away * length);
  }
}
