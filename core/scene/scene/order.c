/* Where particles that are joined have distant indices (ids at random, meshes of a generator), another order for the
 * indices of a run. Sums over elements read and write the particles of each, so close indices keep these in the caches,
 * and where all of them rise by one from element to element no lists of them are needed.
 *
 * Particles are put into slabs across the longest side of their bounding box, those of a slab into rows across the
 * second, those of a row in the order of the third. The index of a neighbour is then off by the particles of a slab at
 * most: sqrt(n) in a sheet, n^(2/3) in a body, and a grid with shuffled ids gets its rows back. Of some widths of rows
 * that is taken with which most joined particles follow each other: in an unstructured mesh of triangles nearly all
 * that are neighbours in rows of 1.25 times the mean distance, which makes a third of the edges, and two thirds of them
 * in rows half as wide. The choice is made by counts: an order is looked for where the mean difference of joined
 * indices is far above sqrt(n), and taken where it is four times less then. */
#include "core/engine/contract/contract.h"
#include "core/scene/scene/scene.h"

#include <stdlib.h>

enum {
  LEAST = 2048, /* fewer particles fit the caches in any order */
  FAR = 8,      /* times sqrt(n): what a sheet's rows, slabs of a body and several lists of elements stay below */
  GAIN = 4,     /* an order that is hardly better is not worth the copies of the lists */
  SAMPLE = 4096 /* pairs whose lengths are looked at, about */
};

/* What is done with each pair of successive members of the tuples of forces and constraints. */
typedef void visit(void *context, uint32_t a, uint32_t b);

static void visit_tuples(const hk_tuples *list, visit *each, void *context) {
  for (size_t k = 0; k < list->count; k++)
    for (unsigned c = 1; c < list->arity; c++) each(context, hk_tuple(list, k)[c - 1], hk_tuple(list, k)[c]);
}

static void visit_pairs(const hk_scene *scene, visit *each, void *context) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT};
  for (size_t q = 0; q < sizeof kinds / sizeof *kinds; q++)
    for (size_t k = 0; k < scene->plugin[kinds[q]].count; k++) {
      const hk_plugin_spec *spec = scene->plugin[kinds[q]].item[k];
      for (const hk_param *p = spec->plugin->params; p && p->name; p++)
        if (hk_param_arity(p) >= 2) visit_tuples(hk_param_in(p, spec->values), each, context);
    }
}

/* ---- how far apart joined particles are ---- */

typedef struct spread {
  const uint32_t *place; /* of particles; NULL: their own index */
  double sum;
  size_t pairs, following; /* how many, and those with a difference of 1 */
} spread;

static void add_spread(void *context, uint32_t a, uint32_t b) {
  spread *s = context;
  uint32_t i = s->place ? s->place[a] : a, j = s->place ? s->place[b] : b;
  uint32_t apart = i < j ? j - i : i - j;
  s->sum += apart;
  s->following += apart == 1;
  s->pairs++;
}

typedef struct lengths {
  const double (*x)[3];
  size_t seen, every, count;
  double length[2 * SAMPLE];
} lengths;

static void note_length(void *context, uint32_t a, uint32_t b) {
  lengths *s = context;
  const double *p = s->x[a], *q = s->x[b];
  if (s->seen++ % s->every || s->count == 2 * SAMPLE) return;
  double length = sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
  if (length > 0) s->length[s->count++] = length;
}

static int by_size(const void *a, const void *b) {
  double p = *(const double *)a, q = *(const double *)b;
  return (p > q) - (p < q);
}

/* The distance that a tenth of the pairs have at most: of a grid with several kinds of edges that of its rows. 0: no
 * two joined particles are apart. */
static double distance_of_rows(const hk_scene *scene, size_t pairs) {
  lengths *s = calloc(1, sizeof *s);
  double found = 0;
  if (!s) return 0;
  s->x = (const double(*)[3])(const void *)scene->particles.position;
  s->every = pairs / SAMPLE + 1;
  visit_pairs(scene, note_length, s);
  qsort(s->length, s->count, sizeof *s->length, by_size);
  if (s->count) found = s->length[s->count / 10];
  free(s);
  return found;
}

/* ---- the order ---- */

typedef struct spot {
  uint32_t slab, row, particle;
  double along;
} spot;

static int by_spot(const void *a, const void *b) {
  const spot *p = a, *q = b;
  if (p->slab != q->slab) return p->slab < q->slab ? -1 : 1;
  if (p->row != q->row) return p->row < q->row ? -1 : 1;
  if (p->along != q->along) return p->along < q->along ? -1 : 1;
  return (p->particle > q->particle) - (p->particle < q->particle);
}

typedef struct box {
  double low[3], size[3];
  int axis[3]; /* by size, the longest side first, of equal ones the later */
} box;

static box box_of(const hk_scene *scene) {
  box b = {.axis = {2, 1, 0}};
  for (int c = 0; c < 3; c++) {
    double high = b.low[c] = scene->particles.position[c];
    for (size_t i = 1; i < scene->particles.n; i++) {
      double x = scene->particles.position[3 * i + (size_t)c];
      if (x < b.low[c]) b.low[c] = x;
      if (x > high) high = x;
    }
    b.size[c] = high - b.low[c];
  }
  for (int p = 0; p < 2; p++)
    for (int q = 0; q < 2 - p; q++)
      if (b.size[b.axis[q + 1]] > b.size[b.axis[q]]) {
        int axis = b.axis[q];
        b.axis[q] = b.axis[q + 1];
        b.axis[q + 1] = axis;
      }
  return b;
}

/* Slabs and rows are counted from half of one before the box, where a grid has no particles. */
static uint32_t cell(const box *b, const double *x, int axis, double distance) {
  double k = floor((x[axis] - b->low[axis]) / distance + 0.5);
  return k < UINT32_MAX ? (uint32_t)k : UINT32_MAX;
}

static spot *sort_spots(const hk_scene *scene, double distance) {
  const box b = box_of(scene);
  bool flat = b.size[b.axis[2]] < distance; /* the slabs of a flat sheet are its rows */
  int along = b.axis[flat ? 1 : 2];
  spot *list = malloc(scene->particles.n * sizeof *list);
  for (size_t i = 0; list && i < scene->particles.n; i++) {
    const double *x = scene->particles.position + 3 * i;
    uint32_t row = flat ? 0 : cell(&b, x, b.axis[1], distance);
    list[i] = (spot){cell(&b, x, b.axis[0], distance), row, (uint32_t)i, x[along]};
  }
  if (list) qsort(list, scene->particles.n, sizeof *list, by_spot);
  return list;
}

/* The place of every particle; NULL: no memory. */
static uint32_t *find_places(const hk_scene *scene, double distance) {
  spot *list = sort_spots(scene, distance);
  uint32_t *place = list ? malloc(scene->particles.n * sizeof *place) : NULL;
  for (size_t k = 0; place && k < scene->particles.n; k++) place[list[k].particle] = (uint32_t)k;
  free(list);
  return place;
}

/* The places in rows of the best width; NULL: no memory. *best: what is known of them. */
static uint32_t *best_places(const hk_scene *scene, double distance, spread *best) {
  static const double width[] = {1, 1.5, 2}; /* times the distance */
  uint32_t *place = NULL;
  for (size_t k = 0; k < sizeof width / sizeof *width; k++) {
    uint32_t *tried = find_places(scene, width[k] * distance);
    spread found = {.place = tried};
    if (!tried) continue;
    visit_pairs(scene, add_spread, &found);
    bool better = !place || found.following > best->following;
    free(better ? place : tried);
    if (better) place = tried, *best = found;
  }
  return place;
}

uint32_t *hk_scene_places(const hk_scene *scene) {
  spread now = {0}, then = {0};
  if (scene->particles.n < LEAST) return NULL;
  visit_pairs(scene, add_spread, &now);
  if (now.sum <= FAR * sqrt((double)scene->particles.n) * (double)now.pairs) return NULL;
  double distance = distance_of_rows(scene, now.pairs);
  uint32_t *place = distance > 0 ? best_places(scene, distance, &then) : NULL;
  if (!place || GAIN * then.sum <= now.sum) return place;
  free(place); /* the order that there is will do */
  return NULL;
}
