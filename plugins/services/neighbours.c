/* Neighbours: one list of pairs for all plugins of a run, found by cells (plugins/common/space/cell_list.h) and kept
 * while it is good: Verlet's list with a skin. Rows reach further than the largest radius asked for by the skin, and
 * are found again when a particle has moved by half of it (Verlet 1967; Allen and Tildesley 1987, section 5.3).
 *
 * Which pairs within the radius a client finds, and their order, do not depend on when that was. The positions of the
 * last time are saved all the same, so that a run that goes on from a checkpoint has the rows, and their number, of the
 * run that did not stop. */
#include "plugins/common/space/images.h"

#include <string.h>
#include <time.h>

enum { GRAIN = 4096 };

/* Of a relative move or distance: far above rounding, far below what shows. */
static const double margin = 1e-9;
static const double least_radius = 1e-150, largest_radius = 1e150; /* m, their squares are ordinary numbers */

typedef struct neighbours {
  double skin;        /* part of the radius */
  double *found_at;   /* n x 3, m: positions that the rows were found for */
  double found_reach; /* m */
  int64_t found;      /* 1: the two above are good */
  int64_t number;     /* of times that rows were found */
  double radius;      /* m, the largest that was asked for */
  bool listed;        /* the rows for found_at are in `list`: not so when a checkpoint was read */
  hk_cell_list list;
  size_t chunks;
  bool *moved;    /* chunks: a particle of it has moved too far, or is not finite */
  double seconds; /* wall time of `rows` so far */
  hk_images images;
  const hk_periodic_box *box; /* NULL: space is open */
  hk_neighbours table;
  const hk_host *host;
} neighbours;

/* The least time for a step of leapfrog in a Lennard-Jones liquid (density 0.8, temperature 1, cut-off 2.5, h = 0.005):
 * 672, 659, 718, 773 and 812 ns a particle with 0.05, 0.1, 0.15, 0.2 and 0.4 of 10,648 particles, 830, 788, 884, 919
 * and 936 ns of 97,336 (tests/bench/neighbours.c). Rows are then found at every fifth step. */
static const hk_param params[] = {
    {"skin", "", "how much further than the radius rows reach, as a part of it", .number = HK_AT(neighbours, skin),
     .initial = {0.1}, .limits = HK_WITHIN(0, 10)},
    {0},
};

static const hk_field fields[] = {
    {"found_at", .per_particle = HK_AT(neighbours, found_at), .width = 3},
    {"found_reach", .number = HK_AT(neighbours, found_reach)},
    {"found", .integer = HK_AT(neighbours, found)},
    {"number", .integer = HK_AT(neighbours, number)},
    {0},
};

static hk_status check_box(const neighbours *s, double radius) {
  for (int c = 0; c < 3 && s->box; c++) {
    double length = s->box->high[c] - s->box->low[c];
    if (s->box->repeats[c] && length < 2 * radius)
      return s->host->fail(
          s->host, HK_BAD_PARAM,
          "the periodic box is %g m long along %c, less than twice the radius of %g m of which a plugin "
          "asks for neighbours, so that a particle would meet two images of another: make the box at "
          "least %g m long, or the radius (cut-off) at most %g m",
          length, "xyz"[c], radius, 2 * radius, length / 2);
  }
  return HK_OK;
}

static hk_status ask_images(void *self, double radius) {
  neighbours *s = self;
  if (!(radius == 0 || (radius >= least_radius && radius <= largest_radius)))
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "a plugin asks for neighbours up to %g m: give it a radius (cut-off) of 0, or from %g to %g m",
                         radius, least_radius, largest_radius);
  hk_status status = check_box(s, radius);
  if (status == HK_OK && radius > s->radius) s->radius = radius;
  return status;
}

static hk_status ask_reach(void *self, double radius) {
  const neighbours *s = self;
  if (!s->box) return ask_images(self, radius);
  return s->host->fail(s->host, HK_BAD_PARAM,
                       "a plugin asks for neighbours and knows no periodic box, so that it would miss what acts across "
                       "the faces: leave scene:periodic out, or let the plugin ask by reach_images");
}

/* ---- have the rows become bad? ---- */

typedef struct comparison {
  const double *x;
  double *before;
  double most2; /* m^2 */
  bool *moved;
} comparison;

static void compare_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const comparison *c = context;
  bool moved = false;
  for (size_t i = 3 * begin; i < 3 * end; i += 3) {
    double dx = c->x[i] - c->before[i], dy = c->x[i + 1] - c->before[i + 1], dz = c->x[i + 2] - c->before[i + 2];
    moved |= !(dx * dx + dy * dy + dz * dz <= c->most2); /* true for NaN */
  }
  c->moved[chunk] = moved;
}

static bool has_moved(const neighbours *s, const double *x, size_t n) {
  double most = s->skin * s->radius / 2 * (1 - margin);
  comparison c = {x, s->found_at, most * most, s->moved};
  bool moved = false;
  s->host->parallel_for(s->host, n, GRAIN, compare_chunk, &c);
  for (size_t k = 0; k < s->chunks; k++) moved |= s->moved[k];
  return moved;
}

/* ---- finding them ---- */

static hk_status name_lost(const neighbours *s, const hk_view *view, const double *x) {
  size_t i = 0;
  while (isfinite(x[3 * i]) && isfinite(x[3 * i + 1]) && isfinite(x[3 * i + 2])) i++;
  return s->host->fail(s->host, HK_NOT_FINITE, "particle %u is at (%g, %g, %g) m at t = %g s: it has no neighbours",
                       view->model->id[i], x[3 * i], x[3 * i + 1], x[3 * i + 2], view->t);
}

static void check_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const comparison *c = context;
  double zero = 0;
  for (size_t k = 3 * begin; k < 3 * end; k++) zero += c->x[k] * 0; /* NaN where x is not finite */
  c->moved[chunk] = zero != 0;
}

static void copy_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const comparison *c = context;
  (void)chunk;
  memcpy(c->before + 3 * begin, c->x + 3 * begin, 3 * (end - begin) * sizeof *c->x);
}

static hk_status list_rows(neighbours *s, size_t n) {
  hk_status status = s->box ? hk_images_rows(&s->images, &s->list, s->host, s->box, s->found_at, n, s->found_reach)
                            : hk_cell_list_build(&s->list, s->host, s->found_at, n, s->found_reach);
  s->listed = status == HK_OK;
  if (!s->listed) s->found = 0;
  return status;
}

static hk_status find_again(neighbours *s, const hk_view *view, const double *x, double reach) {
  comparison c = {x, s->found_at, 0, s->moved};
  bool lost = false;
  s->host->parallel_for(s->host, view->n, GRAIN, check_chunk, &c);
  for (size_t k = 0; k < s->chunks; k++) lost |= s->moved[k];
  if (lost) return name_lost(s, view, x);
  s->host->parallel_for(s->host, view->n, GRAIN, copy_chunk, &c);
  s->found_reach = reach;
  s->found = 1;
  s->number++;
  return list_rows(s, view->n);
}

static hk_status rows_at(neighbours *s, const hk_view *view, const double *x, hk_neighbour_rows *out) {
  double reach = s->radius * (1 + s->skin) * (1 + margin);
  bool good = s->found && s->found_reach == reach && !has_moved(s, x, view->n);
  hk_status status = !good ? find_again(s, view, x, reach) : s->listed ? HK_OK : list_rows(s, view->n);
  if (status != HK_OK) return status;
  *out = (hk_neighbour_rows){view->n, s->list.row_start, s->list.other, reach, (uint64_t)s->number};
  return HK_OK;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static hk_status rows(void *self, const hk_view *view, const double *x, hk_neighbour_rows *out) {
  neighbours *s = self;
  double begin = now();
  hk_status status = rows_at(s, view, x, out);
  s->seconds += now() - begin;
  return status;
}

static double seconds(void *self) { return ((neighbours *)self)->seconds; }

/* ---- the plugin ---- */

static hk_status topology(void *self, const hk_view *view) {
  neighbours *s = self;
  s->found = 0;
  s->listed = false;
  s->host->release(s->host, s->moved);
  s->chunks = (view->n + GRAIN - 1) / GRAIN;
  s->moved = s->host->allocate(s->host, s->chunks * sizeof *s->moved);
  if (!s->moved) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  return hk_cell_list_reserve(&s->list, s->host, view->n);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  neighbours *s = self;
  s->host = host;
  s->box = view->model->box;
  s->table = (hk_neighbours){self, ask_reach, rows, ask_images};
  return topology(self, view);
}

static const void *table(void *self) { return &((neighbours *)self)->table; }

static const hk_service service = {
    .size = sizeof(hk_service), .interface = "neighbours/1", .table = table, .seconds = seconds};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SERVICE,
    .name = "neighbours",
    .summary = "pairs of particles closer than a radius, for all plugins that ask: cells, and a list with a skin",
    .reference = "Verlet 1967, Phys. Rev. 159; Hockney and Eastwood 1981, Computer Simulation Using Particles, 8.4",
    .instance_size = sizeof(neighbours),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .service = &service,
};
