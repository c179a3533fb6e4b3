/* Joints and rest shapes of rods, made once at the start, and how they follow births and deaths: joints belong to pairs
 * of edges that have particles' ids, so that what remains of a rod, or of a ring that was opened, keeps its rest shape
 * and its frames. */
#include "plugins/common/rods/rods.h"
#include "plugins/common/rods/rod_angles.h"
#include "plugins/common/rods/rod_rows.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* Rest turns below this, rad, are roundings of positions along a straight line. */
#define STRAIGHT 1e-10

static hk_rod_frame *frame_of(const hk_rods *r, size_t e) { return (hk_rod_frame *)r->frames.item + e; }

static double value_of(const hk_per_tuple *p, size_t e) { return p->count ? hk_tuple_value(p, e) : 0; }

/* ---- edges and joints ---- */

static hk_status reserve(hk_rods *r) {
  size_t count = r->edges.count + 1;
  r->next = r->host->allocate(r->host, count * sizeof *r->next);
  r->id = r->host->allocate(r->host, count * sizeof *r->id);
  r->rest_length = r->host->allocate(r->host, 4 * count * sizeof *r->rest_length);
  if (!r->next || !r->id || !r->rest_length)
    return r->host->fail(r->host, HK_NO_MEMORY, "no memory for rods of %zu edges", r->edges.count);
  r->bent[0] = r->rest_length + count;
  r->bent[1] = r->rest_length + 2 * count;
  r->twisted = r->rest_length + 3 * count;
  return r->host->resize(r->host, &r->frames, r->edges.count) == HK_OK
             ? HK_OK
             : r->host->fail(r->host, HK_NO_MEMORY, "no memory for frames of %zu edges", r->edges.count);
}

/* Its length, and its direction in the frame. */
static hk_status measure_edge(hk_rods *r, const hk_view *view, size_t e) {
  const uint32_t *pair = hk_tuple(&r->edges, e);
  const uint32_t *id = view->model->id;
  hk_rod_frame *f = frame_of(r, e);
  hk_subtract(f->tangent, view->x + 3 * (size_t)pair[1], view->x + 3 * (size_t)pair[0]);
  double length = hk_length(f->tangent);
  if (!(length > 1e-150))
    return r->host->fail(r->host, HK_BAD_PARAM, "edges: number %zu, from particle %u to %u, has no length", e + 1,
                         id[pair[0]], id[pair[1]]);
  for (int c = 0; c < 2; c++) r->id[e][c] = f->id[c] = id[pair[c]];
  for (int c = 0; c < 3; c++) f->tangent[c] /= length;
  r->rest_length[e] = r->length.count ? hk_tuple_value(&r->length, e) : length;
  return HK_OK;
}

/* Edge e goes on in e + 1 where it ends at the start of that; the last edge of a rod in its first one, if it ends
 * there. Edges that follow each other in the list and meet in another way are a mistake. */
static hk_status join_edges(hk_rods *r, const hk_view *view) {
  size_t head = 0;
  for (size_t e = 0; e < r->edges.count; e++) {
    const uint32_t *own = hk_tuple(&r->edges, e), *first = hk_tuple(&r->edges, head);
    r->next[e] = HK_ROD_NONE;
    if (e + 1 < r->edges.count) {
      const uint32_t *other = hk_tuple(&r->edges, e + 1);
      bool meets = own[1] == other[0];
      if ((meets && own[0] == other[1]) || (!meets && (own[0] == other[0] || own[1] == other[1])))
        return r->host->fail(
            r->host, HK_BAD_PARAM,
            "edges: numbers %zu and %zu meet at particle %u, but do not follow each other: write every "
            "edge in the direction of its rod, the end of one as the start of the next",
            e + 1, e + 2, view->model->id[own[0] == other[0] ? own[0] : own[1]]);
      if (meets) {
        r->next[e] = (uint32_t)e + 1;
        continue;
      }
    }
    if (own[1] == first[0] && e > head) r->next[e] = (uint32_t)head;
    head = e + 1;
  }
  return HK_OK;
}

/* Edges of which each is a rod by itself: of a list that does not go along its rods. */
static void warn_of_single(const hk_rods *r, const hk_view *view) {
  size_t single = 0, first = 0;
  for (size_t e = 0; e < r->edges.count; e++) {
    bool follows = e > 0 && r->next[e - 1] == e;
    if (follows || r->next[e] != HK_ROD_NONE) continue;
    if (single++ == 0) first = e;
  }
  const uint32_t *end = single > 0 ? hk_tuple(&r->edges, first) : NULL;
  if (single > 0)
    r->host->warn(r->host,
                  "edges: %zu of them have no effect, such as number %zu, from particle %u to %u: nothing follows it, "
                  "and an edge alone has no joint to bend; list the edges of a rod one after the other",
                  single, first + 1, view->model->id[end[0]], view->model->id[end[1]]);
}

/* ---- the start ---- */

/* A director of a rod's first edge: the axis as far as it is across, or any. */
static void first_director(const hk_rods *r, hk_rod_frame *f) {
  double axis[3] = {0}, along;
  bool given = !isnan(r->axis[0]);
  int least = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(f->tangent[c]) < fabs(f->tangent[least])) least = c;
  if (given) hk_copy(axis, r->axis);
  if (!given || hk_length(axis) == 0) axis[least] = 1;
  along = hk_dot(axis, f->tangent);
  for (int c = 0; c < 3; c++) f->director[c] = axis[c] - along * f->tangent[c];
  double size = hk_length(f->director);
  for (int c = 0; c < 3; c++) f->director[c] /= size;
}

static hk_status check_axis(const hk_rods *r, const hk_rod_frame *f) {
  double across[3];
  if (isnan(r->axis[0])) return HK_OK;
  hk_cross(across, r->axis, f->tangent);
  if (hk_length(across) > 1e-6 * hk_length(r->axis)) return HK_OK;
  return r->host->fail(
      r->host, HK_BAD_PARAM,
      "axis: it is along the first edge of the rod at particle %u: the first axis of a cross section is "
      "across the rod",
      f->id[0]);
}

/* kb on t x d and -d of edge e, and the director transported to the edge after it. */
static void pass_joint(const hk_rods *r, size_t e, double turn[2], double to[3]) {
  const hk_rod_frame *f = frame_of(r, e), *g = frame_of(r, r->next[e]);
  double kb[3], side[3], chi = 1 + hk_dot(f->tangent, g->tangent);
  hk_cross(kb, f->tangent, g->tangent);
  hk_cross(side, f->tangent, f->director);
  turn[0] = 2 * hk_dot(kb, side) / chi;
  turn[1] = -2 * hk_dot(kb, f->director) / chi;
  double along = hk_dot(f->director, g->tangent) / chi;
  for (int c = 0; c < 3; c++) to[c] = f->director[c] - along * (f->tangent[c] + g->tangent[c]);
}

static hk_status check_fold(const hk_rods *r, size_t e) {
  const hk_rod_frame *f = frame_of(r, e), *g = frame_of(r, r->next[e]);
  if (1 + hk_dot(f->tangent, g->tangent) > HK_ROD_FOLD) return HK_OK;
  return r->host->fail(r->host, HK_BAD_PARAM,
                       "edges: the rod is folded back on itself at particle %u, where its curvature "
                       "is infinite",
                       f->id[1]);
}

/* The natural angle of a section against the one before: of a rod that is given torsion, which it starts with. */
static double natural_twist(const hk_rods *r, size_t e) {
  size_t f = r->next[e];
  return (value_of(&r->torsion, e) * r->rest_length[e] + value_of(&r->torsion, f) * r->rest_length[f]) / 2;
}

static void rest_of(hk_rods *r, size_t e, const double turn[2], double offset) {
  double s = sin(offset / 2), c = cos(offset / 2);
  bool keep = r->rest == HK_ROD_REST_INITIAL && !r->given && sqrt(turn[0] * turn[0] + turn[1] * turn[1]) > STRAIGHT;
  r->bent[0][e] = keep ? c * turn[0] + s * turn[1] : 0;
  r->bent[1][e] = keep ? c * turn[1] - s * turn[0] : 0;
  r->twisted[e] = r->rest == HK_ROD_REST_INITIAL && !r->given ? offset : 0;
}

/* Frames of the rod from edge `head` on, and the rest shape of its joints. */
static hk_status start_rod(hk_rods *r, size_t head) {
  double turn[2], to[3], side[3];
  hk_status status = check_axis(r, frame_of(r, head));
  first_director(r, frame_of(r, head));
  for (size_t e = head; status == HK_OK && r->next[e] != HK_ROD_NONE; e = r->next[e]) {
    hk_rod_frame *f = frame_of(r, e), *g = frame_of(r, r->next[e]);
    if ((status = check_fold(r, e)) != HK_OK) break;
    pass_joint(r, e, turn, to);
    if (r->next[e] == head) {
      hk_cross(side, g->tangent, to);
      f->offset = atan2(hk_dot(side, g->director), hk_dot(to, g->director));
      if (fabs(f->offset) < STRAIGHT) f->offset = 0;
      rest_of(r, e, turn, f->offset);
      break;
    }
    rest_of(r, e, turn, 0);
    hk_copy(g->director, to);
    g->angle = f->angle + (r->given ? natural_twist(r, e) : 0);
  }
  return status;
}

static hk_status check_spins(const hk_rods *r, const hk_view *view) {
  if (r->spins.count == 0) return HK_OK;
  if (r->spins.count != r->edges.count)
    return r->host->fail(r->host, HK_BAD_PARAM, "spins: %zu particles for %zu edges: give one for each", r->spins.count,
                         r->edges.count);
  for (size_t e = 0; e < r->spins.count; e++) {
    uint32_t i = r->spins.index[e];
    if (view->model->pin[i] == HK_FREE || view->model->pin[i] == HK_PIN_PLANE)
      return r->host->fail(
          r->host, HK_BAD_PARAM,
          "spins: particle %u is the angle of edge %zu and has to slide along x: pin it with axes = {1, "
          "0, 0}, or to a path",
          view->model->id[i], e + 1);
    frame_of(r, e)->spin = view->x[3 * (size_t)i];
  }
  return HK_OK;
}

static bool all_positive(const hk_per_tuple *p, size_t count) {
  for (size_t e = 0; e < count; e++)
    if (!(value_of(p, e) > 0)) return false;
  return true;
}

/* Without stiffness in twist nothing holds sections that have sides. */
static hk_status check_twist(const hk_rods *r) {
  bool sides = r->EI2.count > 0 || r->given;
  for (size_t e = 0; e < r->edges.count && !sides; e++) sides = r->bent[0][e] != 0 || r->bent[1][e] != 0;
  if (!sides || all_positive(&r->GJ, r->edges.count)) return HK_OK;
  return r->host->fail(
      r->host, HK_BAD_PARAM,
      "GJ: a rod that is curved at rest, or stiffer in one direction than in another, needs a stiffness "
      "in twist above 0 (for a round section of an incompressible material 2/3 of EI); for one that is "
      "straight at rest write rest = \"straight\"");
}

static hk_status make_rows(hk_rods *r, const hk_view *view) {
  hk_status status = hk_rod_rows_build(r, view);
  return status == HK_OK && r->jacobian == HK_ROD_EXACT ? hk_rod_relaxed_reserve(r) : status;
}

hk_status hk_rods_open(hk_rods *r, const hk_host *host, const hk_view *view) {
  r->host = host;
  r->path = hk_rod_path_of(host->lanes);
  r->given = r->curvature.count > 0 || r->torsion.count > 0;
  hk_status status = reserve(r);
  r->count = r->edges.count;
  for (size_t e = 0; e < r->count && status == HK_OK; e++) status = measure_edge(r, view, e);
  if (status == HK_OK) status = join_edges(r, view);
  if (status == HK_OK) warn_of_single(r, view);
  size_t head = 0;
  for (size_t e = 0; e < r->count && status == HK_OK; e++) {
    if (r->next[e] == e + 1) continue;
    status = start_rod(r, head);
    head = e + 1;
  }
  if (status == HK_OK) status = check_twist(r);
  if (status == HK_OK) status = check_spins(r, view);
  return status == HK_OK ? make_rows(r, view) : status;
}

/* ---- births and deaths ---- */

static bool same_pair(const uint32_t a[2], const uint32_t b[2]) { return a[0] == b[0] && a[1] == b[1]; }

static void move_edge(hk_rods *r, size_t from, size_t to) {
  r->next[to] = r->next[from];
  memcpy(r->id[to], r->id[from], sizeof *r->id);
  r->rest_length[to] = r->rest_length[from];
  for (int c = 0; c < 2; c++) r->bent[c][to] = r->bent[c][from];
  r->twisted[to] = r->twisted[from];
  *frame_of(r, to) = *frame_of(r, from);
}

/* The list is what is left of the one before, in its order. */
hk_status hk_rods_follow(hk_rods *r, const hk_view *view) {
  if (r->spins.count != 0 && r->spins.count != r->edges.count)
    return r->host->fail(r->host, HK_FAILED,
                         "spins: an edge has lost its particle, or a particle its edge: they have to "
                         "die together");
  const uint32_t *id = view->model->id;
  uint32_t *now = r->host->allocate(r->host, (r->count + 1) * sizeof *now);
  if (!now) return r->host->fail(r->host, HK_NO_MEMORY, "no memory for rods of %zu edges", r->count);
  size_t left = 0;
  for (size_t e = 0; e < r->count; e++) {
    const uint32_t *pair = left < r->edges.count ? hk_tuple(&r->edges, left) : NULL;
    bool lives = pair && same_pair(r->id[e], (uint32_t[]){id[pair[0]], id[pair[1]]});
    now[e] = lives ? (uint32_t)left++ : HK_ROD_NONE;
  }
  for (size_t e = 0; e < r->count; e++)
    if (now[e] != HK_ROD_NONE) move_edge(r, e, now[e]);
  for (size_t e = 0; e < left; e++)
    if (r->next[e] != HK_ROD_NONE) r->next[e] = now[r->next[e]];
  r->host->release(r->host, now);
  r->count = left;
  hk_status status = r->host->resize(r->host, &r->frames, left);
  return status == HK_OK ? make_rows(r, view)
                         : r->host->fail(r->host, status, "no memory for frames of %zu edges", left);
}
