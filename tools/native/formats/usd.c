/* The samples of an attribute stand together in the text, while frames come with all attributes: each attribute has a
 * file of its own beside the target, and the text is put together at the end. */
#include "tools/native/formats/usd.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const schema[HK_USD_PRIMS] = {"Mesh \"surface\"", "BasisCurves \"strands\"", "Points \"particles\""};

static const char *const attribute_name[HK_USD_PRIMS][HK_USD_ATTRIBUTES] = {
    {"point3f[] points", "vector3f[] velocities", "float3[] extent", "int[] faceVertexCounts",
     "int[] faceVertexIndices"},
    {"point3f[] points", "vector3f[] velocities", "float3[] extent", "int[] curveVertexCounts", NULL},
    {"point3f[] points", "vector3f[] velocities", "float3[] extent", "int64[] ids", NULL},
};

bool hk_usd_open(hk_usd *u, const char *path, double fps, bool z_up, char *why, size_t size) {
  *u = (hk_usd){.fps = fps, .z_up = z_up};
  return hk_whole_open(&u->file, path, why, size);
}

/* ---- samples ---- */

static FILE *begin_sample(const hk_usd *u, hk_usd_prim *p, hk_usd_attribute a) {
  fprintf(p->samples[a].stream, "            %.10g: [", u->last);
  return p->samples[a].stream;
}

static void end_sample(FILE *to) { fputs("],\n", to); }

static void put_vector(FILE *to, bool first, double x, double y, double z) {
  fprintf(to, "%s(%.9g, %.9g, %.9g)", first ? "" : ", ", (double)(float)x, (double)(float)y, (double)(float)z);
}

static void put_number(FILE *to, bool first, size_t number) { fprintf(to, "%s%zu", first ? "" : ", ", number); }

static void add_motion(const hk_usd *u, hk_usd_prim *p, const hk_frame_data *s) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  FILE *to = begin_sample(u, p, HK_USD_POINTS);
  for (size_t k = 0; k < p->points; k++) {
    const double *x = s->x + 3 * (size_t)p->point[k], *o = u->origin;
    put_vector(to, k == 0, x[0] - o[0], x[1] - o[1], x[2] - o[2]);
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], x[c] - o[c]), high[c] = fmax(high[c], x[c] - o[c]);
  }
  end_sample(to);
  to = begin_sample(u, p, HK_USD_VELOCITIES);
  for (size_t k = 0; k < p->points; k++) {
    const double *v = s->v + 3 * (size_t)p->point[k];
    put_vector(to, k == 0, v[0], v[1], v[2]);
  }
  end_sample(to);
  to = begin_sample(u, p, HK_USD_EXTENT);
  if (p->points) put_vector(to, true, low[0], low[1], low[2]);
  if (p->points) put_vector(to, false, high[0], high[1], high[2]);
  end_sample(to);
}

/* ---- which particles are whose points, and the cells ---- */

static bool make_room(hk_usd_prim *p, size_t points) {
  uint32_t *grown = realloc(p->point, (points + 1) * sizeof *grown);
  if (grown) p->point = grown;
  p->points = 0;
  return grown != NULL;
}

static bool choose_mesh(hk_usd_prim *p, const hk_frame_data *s, uint32_t *place) {
  const uint32_t none = UINT32_MAX;
  if (!make_room(p, s->n)) return false;
  for (size_t i = 0; i < s->n; i++) place[i] = none;
  for (size_t k = 0; k < 3 * s->cells.triangles; k++) place[s->cells.triangle[k / 3][k % 3]] = 0;
  for (uint32_t i = 0; i < s->n; i++) {
    if (place[i] == none) continue;
    place[i] = (uint32_t)p->points;
    p->point[p->points++] = i;
  }
  return true;
}

static void add_mesh_cells(const hk_usd *u, hk_usd_prim *p, const hk_frame_cells *c, const uint32_t *place) {
  FILE *to = begin_sample(u, p, HK_USD_CELLS);
  for (size_t k = 0; k < c->triangles; k++) put_number(to, k == 0, 3);
  end_sample(to);
  to = begin_sample(u, p, HK_USD_CORNERS);
  for (size_t k = 0; k < 3 * c->triangles; k++) put_number(to, k == 0, place[c->triangle[k / 3][k % 3]]);
  end_sample(to);
}

static uint64_t edge_key(uint32_t a, uint32_t b) { return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a; }

static int by_size(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

/* Sorted edges of the triangles (3 each): the mesh shows them. */
static uint64_t *mesh_edges(const hk_frame_cells *c) {
  uint64_t *edge = malloc((3 * c->triangles + 1) * sizeof *edge);
  for (size_t k = 0; k < 3 * c->triangles && edge; k++)
    edge[k] = edge_key(c->triangle[k / 3][k % 3], c->triangle[k / 3][(k + 1) % 3]);
  if (edge) qsort(edge, 3 * c->triangles, sizeof *edge, by_size);
  return edge;
}

/* The segments that are no edges of triangles. A curve goes on where one begins at the end of the one before. */
static bool choose_curves(hk_usd_prim *p, const hk_frame_cells *c) {
  uint64_t *edge = mesh_edges(c);
  uint32_t *length = realloc(p->length, (c->segments + 1) * sizeof *length);
  if (length) p->length = length;
  bool fine = edge && length && make_room(p, 2 * c->segments);
  p->curves = 0;
  for (size_t k = 0; k < c->segments && fine; k++) {
    uint32_t from = c->segment[k][0], to = c->segment[k][1];
    uint64_t key = edge_key(from, to);
    if (bsearch(&key, edge, 3 * c->triangles, sizeof *edge, by_size)) continue;
    bool goes_on = p->points && p->point[p->points - 1] == from;
    if (!goes_on) p->point[p->points++] = from, length[p->curves++] = 1;
    p->point[p->points++] = to;
    length[p->curves - 1]++;
  }
  free(edge);
  return fine;
}

static void add_curve_cells(const hk_usd *u, hk_usd_prim *p) {
  FILE *to = begin_sample(u, p, HK_USD_CELLS);
  for (size_t k = 0; k < p->curves; k++) put_number(to, k == 0, p->length[k]);
  end_sample(to);
}

static bool choose_particles(hk_usd_prim *p, const hk_frame_cells *c) {
  if (!make_room(p, c->vertices)) return false;
  if (c->vertices) memcpy(p->point, c->vertex, c->vertices * sizeof *p->point);
  p->points = c->vertices;
  return true;
}

static void add_ids(const hk_usd *u, hk_usd_prim *p, const hk_frame_data *s) {
  FILE *to = begin_sample(u, p, HK_USD_CELLS);
  for (size_t k = 0; k < p->points; k++) put_number(to, k == 0, s->id[p->point[k]]);
  end_sample(to);
}

/* The first frame with such cells. Before it, from the first frame on, there are none. */
static bool begin_prim(hk_usd *u, hk_usd_prim_kind kind, char *why, size_t size) {
  hk_usd_prim *p = &u->prim[kind];
  p->begun = true;
  for (int a = 0; a < HK_USD_ATTRIBUTES; a++) {
    char path[PATH_MAX];
    if (!attribute_name[kind][a]) continue;
    if (snprintf(path, sizeof path, "%s.%d%d", u->file.path, kind, a) >= (int)sizeof path)
      return hk_whole_failed(ENAMETOOLONG, why, size);
    if (!hk_whole_open(&p->samples[a], path, why, size)) return false;
    if (u->frames > 1) fprintf(p->samples[a].stream, "            %.10g: [],\n", u->first);
  }
  return true;
}

static bool choose(hk_usd *u, const hk_frame_data *s, char *why, size_t size) {
  uint32_t *place = malloc((s->n + 1) * sizeof *place);
  bool fine = place && choose_mesh(&u->prim[HK_USD_MESH], s, place) &&
              choose_curves(&u->prim[HK_USD_CURVES], &s->cells) &&
              choose_particles(&u->prim[HK_USD_PARTICLES], &s->cells);
  if (!fine) hk_whole_failed(ENOMEM, why, size);
  for (int k = 0; k < HK_USD_PRIMS && fine; k++) {
    hk_usd_prim *p = &u->prim[k];
    if (!p->begun && p->points) fine = begin_prim(u, (hk_usd_prim_kind)k, why, size);
    if (!fine || !p->begun) continue;
    if (k == HK_USD_MESH) add_mesh_cells(u, p, &s->cells, place);
    if (k == HK_USD_CURVES) add_curve_cells(u, p);
    if (k == HK_USD_PARTICLES) add_ids(u, p, s);
  }
  free(place);
  return fine;
}

/* ---- the file ---- */

bool hk_usd_add(hk_usd *u, const hk_frame_data *s, bool changed, char *why, size_t size) {
  u->last = s->t * u->fps;
  if (u->frames++ == 0) {
    double diagonal = hk_frame_middle(s, u->origin);
    u->width = diagonal > 0 ? diagonal / 200 : 0.01;
    u->first = u->last;
    changed = true;
  }
  if (changed && !choose(u, s, why, size)) return false;
  for (int k = 0; k < HK_USD_PRIMS; k++) {
    hk_usd_prim *p = &u->prim[k];
    if (!p->begun) continue;
    add_motion(u, p, s);
    for (int a = 0; a < HK_USD_ATTRIBUTES; a++)
      if (p->samples[a].stream && !hk_whole_check(&p->samples[a]))
        return hk_whole_failed(p->samples[a].cause, why, size);
  }
  return true;
}

static bool copy_samples(hk_whole_file *from, FILE *to) {
  char piece[1 << 14];
  if (fflush(from->stream) != 0 || !hk_whole_check(from)) return false;
  FILE *again = fopen(from->part, "rb");
  if (!again) return false;
  for (size_t got; (got = fread(piece, 1, sizeof piece, again)) > 0;) fwrite(piece, 1, got, to);
  bool fine = !ferror(again);
  fclose(again);
  return fine;
}

static bool write_prim(hk_usd *u, int kind, FILE *to) {
  static const char *const fixed[HK_USD_PRIMS] = {
      "        uniform token subdivisionScheme = \"none\"\n        uniform bool doubleSided = 1\n",
      "        uniform token type = \"linear\"\n        uniform token wrap = \"nonperiodic\"\n", ""};
  hk_usd_prim *p = &u->prim[kind];
  fprintf(to, "\n    def %s\n    {\n%s        color3f[] primvars:displayColor = [(0.08, 0.26, 0.6)]\n", schema[kind],
          fixed[kind]);
  if (kind != HK_USD_MESH)
    fprintf(to, "        float[] widths = [%.9g] (\n            interpolation = \"constant\"\n        )\n", u->width);
  for (int a = 0; a < HK_USD_ATTRIBUTES; a++) {
    if (!attribute_name[kind][a]) continue;
    fprintf(to, "        %s.timeSamples = {\n", attribute_name[kind][a]);
    if (!copy_samples(&p->samples[a], to)) return false;
    fputs("        }\n", to);
  }
  fputs("    }\n", to);
  return true;
}

static bool write_text(hk_usd *u, FILE *to) {
  fprintf(to,
          "#usda 1.0\n(\n    defaultPrim = \"hooke\"\n    metersPerUnit = 1\n    upAxis = \"%c\"\n"
          "    startTimeCode = %.10g\n    endTimeCode = %.10g\n    timeCodesPerSecond = %.10g\n"
          "    framesPerSecond = %.10g\n)\n\n",
          u->z_up ? 'Z' : 'Y', u->first, u->last, u->fps, u->fps);
  fprintf(to,
          "def Xform \"hooke\"\n{\n    double3 xformOp:translate = (%.17g, %.17g, %.17g)\n"
          "    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
          u->origin[0], u->origin[1], u->origin[2]);
  for (int k = 0; k < HK_USD_PRIMS; k++)
    if (u->prim[k].begun && !write_prim(u, k, to)) return false;
  fputs("}\n", to);
  return true;
}

bool hk_usd_close(hk_usd *u, bool keep, char *why, size_t size) {
  if (u->file.stream && keep && !write_text(u, u->file.stream) && !u->file.cause) u->file.cause = EIO;
  if (u->file.stream) hk_whole_check(&u->file);
  bool fine = hk_whole_close(&u->file, keep, why, size);
  char none[8];
  for (int k = 0; k < HK_USD_PRIMS; k++) {
    for (int a = 0; a < HK_USD_ATTRIBUTES; a++) hk_whole_close(&u->prim[k].samples[a], false, none, sizeof none);
    free(u->prim[k].point), free(u->prim[k].length);
  }
  *u = (hk_usd){0};
  return fine;
}
