/* Walls of a liquid: the box, and obstacles by their signed distances at the corners of cells. */
#include "plugins/common/liquid/liquid.h"
#include "plugins/common/mac_grid/cut_cells.h"

static const double least_open = 1e-3, least_room = 0.05;
static const double on_grid = 1e-6;      /* of a cell: rounding of the place of an inflow, or of an obstacle */
static const double same_density = 1e-9; /* relative */

/* The solid that is nearest to a point. */
typedef struct nearest_solid {
  const hk_obstacle *obstacle; /* NULL: none */
  uint16_t body;               /* from 1, and then it is no obstacle; 0: none */
} nearest_solid;

static bool has_solids(const hk_liquid *l) { return l->obstacles || l->bodies.count > 0; }

/* m, of a point to the nearest body, if that is nearer than `least`. */
static double distance_to_bodies(const hk_liquid *l, const double x[3], double least, nearest_solid *nearest) {
  const double *s = l->grid.spacing, near = s[0] + s[1] + s[2];
  for (size_t k = 0; k < l->bodies.count; k++) {
    double n[3], d = l->bodies.body[k].present ? hk_liquid_body_distance(&l->bodies.body[k], x, near, n) : INFINITY;
    if (!(d < least)) continue;
    least = d;
    *nearest = (nearest_solid){NULL, (uint16_t)(k + 1)};
  }
  return least;
}

/* Whether a plane at the distance d of x, with the normal n in its frame, has all of the box before it: a floor, say.
 * It is no wall beside the box's own; where several of them met, cells in corners would seem half closed. */
static bool is_round_box(const hk_liquid_grid *g, const hk_obstacle *o, const double x[3], double d,
                         const double n[3]) {
  double normal[3], size = 0;
  if (o->shape.kind != HK_SHAPE_PLANE || o->shape.hollow) return false;
  hk_body_direction(&o->motion.end, n, normal);
  for (int c = 0; c < 3; c++) {
    d += normal[c] * ((normal[c] > 0 ? g->low[c] : g->high[c]) - x[c]);
    size += g->spacing[c];
  }
  return d > -1e-6 * size;
}

/* m, of a point to the nearest solid. */
static double distance_at(const hk_liquid *l, const double x[3], nearest_solid *nearest) {
  const hk_obstacle_set *set = l->obstacles;
  double least = INFINITY;
  *nearest = (nearest_solid){NULL, 0};
  for (size_t k = 0; set && k < set->count; k++) {
    double p[3], n[3];
    hk_body_point(&set->member[k]->motion.end, x, p);
    double d = hk_shape_distance(&set->member[k]->shape, p, n);
    if (!(d < least) || is_round_box(&l->grid, set->member[k], x, d, n)) continue;
    least = d;
    nearest->obstacle = set->member[k];
  }
  return distance_to_bodies(l, x, least, nearest);
}

/* The part of a triangle where the linear function with these values at its corners is positive. */
static double open_triangle(double a, double b, double c) {
  int positive = (a > 0) + (b > 0) + (c > 0);
  if (positive == 0) return 0;
  if (positive == 3) return 1;
  bool apart = positive == 1; /* whether the corner that is apart from the others is positive: it comes first */
  if ((b > 0) == apart) {
    double t = a;
    a = b;
    b = t;
  } else if ((c > 0) == apart) {
    double t = a;
    a = c;
    c = t;
  }
  double corner = a / (a - b) * (a / (a - c));
  return positive == 1 ? corner : 1 - corner;
}

/* The open part of the face of component c of cell i. */
static double open_part(const hk_liquid_grid *g, size_t i, int c) {
  int a = c == 0 ? 1 : 0, b = 3 - c - a;
  size_t s = g->flat[a] ? 0 : g->stride[a], t = g->flat[b] ? 0 : g->stride[b];
  const double *d = g->solid + i;
  double part;
  if (s == 0 || t == 0) {
    double p = d[0], q = d[s + t];
    part = p > 0 && q > 0 ? 1 : p <= 0 && q <= 0 ? 0 : fmax(p, q) / fabs(p - q);
  } else {
    double rising = open_triangle(d[0], d[s], d[s + t]) + open_triangle(d[0], d[t], d[s + t]);
    double falling = open_triangle(d[s], d[0], d[t]) + open_triangle(d[s], d[s + t], d[t]);
    part =
        fmax(rising, falling) / 2; /* they differ where walls meet: in a corner one of them has a triangle on a wall */
  }
  return part < least_open ? 0 : part;
}

static void point_of(const hk_liquid_grid *g, const hk_liquid_row *row, size_t i, int face, double x[3]) {
  for (int c = 0; c < 3; c++) {
    size_t at = row->cell[c] + (c == hk_liquid_inner(g) ? i - row->first : 0);
    double half = face < 0 || c == face ? 0 : 0.5;
    x[c] = g->flat[c] ? g->low[c] : g->low[c] + g->spacing[c] * ((double)at - 1 + half);
  }
}

/* An obstacle that fits the grid is on its corners, whatever rounding says of its place: a lid that seemed 4e-17 m
 * above them let the liquid into the cells that it fills. */
static void corner_rows(void *context, size_t begin, size_t end, size_t piece) {
  hk_liquid *l = context;
  hk_liquid_grid *g = &l->grid;
  double near = on_grid * fmin(g->spacing[0], fmin(g->spacing[1], g->spacing[2]));
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 1);
    for (size_t i = row.first; i <= row.first + g->cells[hk_liquid_inner(g)]; i++) {
      double x[3];
      nearest_solid nearest = {NULL, 0};
      point_of(g, &row, i, -1, x);
      g->solid[i] = has_solids(l) ? distance_at(l, x, &nearest) : INFINITY;
      if (fabs(g->solid[i]) < near) g->solid[i] = 0;
      if (l->bodies.count) l->bodies.beside[i] = nearest.body;
    }
  }
}

/* The body, from 1, that covers a part of the face of component c of cell i, by its deepest corner; 0: none does. */
static uint16_t owner_of(const hk_liquid *l, size_t i, int c) {
  const hk_liquid_grid *g = &l->grid;
  size_t s = g->stride[c == 0 ? 1 : 0], t = g->stride[c == 2 ? 1 : 2], deepest = i;
  const size_t corner[3] = {i + s, i + t, i + s + t};
  for (int k = 0; k < 3; k++)
    if (g->solid[corner[k]] < g->solid[deepest]) deepest = corner[k];
  return l->bodies.beside[deepest];
}

double hk_liquid_obstacle_speed(const hk_liquid *l, const double x[3], int c) {
  static const double rest[3];
  nearest_solid nearest;
  double u[3];
  distance_at(l, x, &nearest);
  if (!nearest.obstacle) return 0;
  hk_body_move(&nearest.obstacle->motion.end, x, rest, u);
  return u[c];
}

/* m/s, of the solid that covers a part of the face. */
static double wall_speed(const hk_liquid *l, const hk_liquid_row *row, size_t i, int c) {
  uint16_t owner = l->bodies.count ? l->bodies.owner[c][i] : 0;
  double x[3], u[3];
  point_of(&l->grid, row, i, c, x);
  if (!owner) return hk_liquid_obstacle_speed(l, x, c);
  hk_liquid_body_velocity(&l->bodies.body[owner - 1], x, u);
  return u[c];
}

static void face_rows(void *context, size_t begin, size_t end, size_t piece) {
  hk_liquid *l = context;
  hk_liquid_grid *g = &l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + g->cells[hk_liquid_inner(g)]; i++)
      for (int c = 0; c < 3; c++) {
        bool box = hk_liquid_on_box(g, &row, i, c);
        g->open[c][i] = box ? 0 : has_solids(l) ? open_part(g, i, c) : 1;
        if (l->bodies.count) l->bodies.owner[c][i] = box || g->open[c][i] == 1 ? 0 : owner_of(l, i, c);
        g->wall[c][i] = box || g->open[c][i] == 1 ? 0 : wall_speed(l, &row, i, c);
      }
  }
}

double hk_liquid_open_cell(const hk_liquid_grid *g, size_t i) {
  double h = (g->spacing[0] + g->spacing[1] + g->spacing[2]) / 3;
  return fmin(1, fmax(0, 0.5 + hk_cut_cell_distance(g, i) / h));
}

/* room: a cell's own open part and those beside it, as the kernel of the filled parts weighs them: 1/8, 3/4, 1/8 along
 * each axis, negative where the centre is in a wall. `distance` is free for the sums. */
static void weigh(const hk_liquid_grid *g, int c, const double *from, double *to) {
  size_t rows = hk_liquid_rows(g, 0), length = g->cells[hk_liquid_inner(g)];
  for (size_t k = 0; k < rows; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + length; i++) {
      size_t at = row.cell[c] + (c == hk_liquid_inner(g) ? i - row.first : 0);
      double prior = from[at == 1 ? i : i - g->stride[c]], next = from[at == g->cells[c] ? i : i + g->stride[c]];
      to[i] = 0.75 * from[i] + 0.125 * (prior + next);
    }
  }
}

/* m, of the centre of a cell to the nearest solid. */
static double distance_of_centre(const hk_liquid *l, const hk_liquid_row *row, size_t i) {
  nearest_solid nearest;
  double x[3];
  point_of(&l->grid, row, i, -1, x);
  for (int c = 0; c < 3; c++) x[c] += l->grid.flat[c] ? 0 : l->grid.spacing[c] / 2;
  return distance_at(l, x, &nearest);
}

static void find_room(hk_liquid *l) {
  hk_liquid_grid *g = &l->grid;
  size_t rows = hk_liquid_rows(g, 0), length = g->cells[hk_liquid_inner(g)];
  double near = fmax(g->spacing[0], fmax(g->spacing[1], g->spacing[2]));
  for (size_t k = 0; k < rows; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + length; i++) g->distance[i] = has_solids(l) ? hk_liquid_open_cell(g, i) : 1;
  }
  weigh(g, 0, g->distance, g->room);
  weigh(g, 1, g->room, g->distance);
  weigh(g, 2, g->distance, g->room);
  for (size_t k = 0; k < rows && has_solids(l); k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + length; i++)
      if (fabs(hk_cut_cell_distance(g, i)) < near)
        hk_cut_cell_add(g, &row, i, hk_liquid_open_cell(g, i), distance_of_centre(l, &row, i));
  }
  for (size_t k = 0; k < rows && has_solids(l); k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + length; i++)
      if (hk_liquid_open_cell(g, i) <= 0.5) g->room[i] = -fmax(g->room[i], least_room);
  }
}

/* Faces that cloth crosses, but where a solid covers a part of them. */
static void close_thin_walls(hk_liquid *l) {
  hk_liquid_grid *g = &l->grid;
  for (int c = 0; c < 3 && l->thin.crossings; c++)
    for (size_t i = 0; i < g->size; i++) {
      const hk_thin_crossing *at = hk_thin_walls_at(&l->thin, c, i);
      if (!at) continue;
      if (g->open[c][i] < 1) {
        l->thin.face[c][i] = 0;
        continue;
      }
      g->open[c][i] = 0;
      g->wall[c][i] = hk_thin_walls_speed(&l->thin, at, c);
    }
}

void hk_liquid_walls(hk_liquid *l) {
  bool still = l->bodies.count == 0 && l->thin.triangles == 0;
  for (size_t k = 0; l->obstacles && k < l->obstacles->count; k++) still &= l->obstacles->member[k]->motion.still;
  if (l->walled && still && l->stood) return;
  l->walled = true;
  l->stood = still;
  l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 1), 16, corner_rows, l);
  l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, face_rows, l);
  find_room(l);
  close_thin_walls(l);
}

/* ---- inflows ---- */

typedef struct opened {
  size_t first[3], last[3]; /* faces that the inflow covers, or a part of them */
  double speed;             /* m/s, mean of the step */
  const hk_inflow *inflow;
} opened;

static hk_status find_faces(const hk_liquid *l, const hk_inflow *in, opened *o) {
  const hk_liquid_grid *g = &l->grid;
  int a = in->axis;
  double at = (in->low[a] - g->low[a]) / g->spacing[a], near = floor(at + 0.5);
  if (g->flat[a] || !(fabs(at - near) < on_grid) || near < 0 || near > (double)g->cells[a])
    return l->host->fail(l->host, HK_BAD_PARAM,
                         "an inflow at %c = %g m is on no face of the grid, which has them each %g m from %g to %g m: "
                         "put it on a face of the box, or of an obstacle that fits the grid",
                         "xyz"[a], in -> low[a], g -> spacing[a], g -> low[a], g -> high[a]);
  for (int c = 0; c < 3; c++) {
    o->first[c] = o->last[c] = c == a ? (size_t)near + 1 : 1;
    if (c == a || g->flat[c]) continue;
    double low = (in->low[c] - g->low[c]) / g->spacing[c], high = (in->high[c] - g->low[c]) / g->spacing[c];
    if (low < -on_grid || high > (double)g->cells[c] + on_grid || !(high > low))
      return l->host->fail(l->host, HK_BAD_PARAM,
                           "an inflow goes from %g to %g m along %c, and the box of the liquid from %g to %g m: "
                           "give it a width, within the box",
                           in->low[c], in->high[c], "xyz"[c], g -> low[c], g -> high[c]);
    o->first[c] = (size_t)fmax(0, floor(low + on_grid)) + 1;
    o->last[c] = (size_t)fmin((double)g->cells[c], ceil(high - on_grid));
  }
  return HK_OK;
}

/* The part of face or cell `at` along axis c. */
static double covered(const hk_liquid_grid *g, const hk_inflow *in, int c, size_t at) {
  if (c == in->axis || g->flat[c]) return 1;
  double low = g->low[c] + g->spacing[c] * (double)(at - 1), high = low + g->spacing[c];
  return fmax(0, fmin(high, in->high[c]) - fmax(low, in->low[c])) / g->spacing[c];
}

/* Adds the inflow to its faces; with `clear` they are those of walls at rest. */
static hk_status let_in(hk_liquid *l, const opened *o, bool clear) {
  hk_liquid_grid *g = &l->grid;
  int a = o->inflow->axis;
  size_t at[3];
  for (at[0] = o->first[0]; at[0] <= o->last[0]; at[0]++)
    for (at[1] = o->first[1]; at[1] <= o->last[1]; at[1]++)
      for (at[2] = o->first[2]; at[2] <= o->last[2]; at[2]++) {
        size_t i = at[0] * g->stride[0] + at[1] * g->stride[1] + at[2] * g->stride[2];
        double part = 1;
        for (int c = 0; c < 3; c++) part *= covered(g, o->inflow, c, at[c]);
        if (g->open[a][i] > 0)
          return l->host->fail(l->host, HK_BAD_PARAM,
                               "an inflow at %c = %g m is not on a wall everywhere: put it on a face of the box, or of "
                               "an obstacle that fits the grid",
                               "xyz"[a], o -> inflow -> low[a]);
        g->wall[a][i] = clear ? 0 : g->wall[a][i] + part * o->speed;
      }
  return HK_OK;
}

hk_status hk_liquid_let_in(hk_liquid *l, double t, double h) {
  const hk_inflows *all = l->inflows;
  hk_status status = HK_OK;
  for (int turn = 0; turn < 2 && all; turn++)
    for (size_t k = 0; k < all->count && status == HK_OK; k++) {
      const hk_inflow *in = all->member[k];
      opened o = {.speed = in->speed * fmax(0, fmin(t, in->to) - fmax(t - h, in->from)) / h, .inflow = in};
      if (fabs(in->density - l->density) > same_density * l->density)
        return l->host->fail(l->host, HK_BAD_PARAM,
                             "an inflow has the density %g kg/m^3, and the liquid %g: give both the same", in->density,
                             l->density);
      status = find_faces(l, in, &o);
      if (status == HK_OK) status = let_in(l, &o, turn == 0);
    }
  return status;
}
