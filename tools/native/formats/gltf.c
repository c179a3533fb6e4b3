/* The binary part is written behind room for the JSON, which is known at the end; what it does not need is blanks. */
#include "tools/native/formats/gltf.h"

#include "tools/native/formats/bytes.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { FLOATS = 5126, INDICES = 5125, POINTS = 0, LINES = 1, TRIANGLES = 4 };
enum { HEAD = 12, CHUNK_HEAD = 8, JSON_HEAD = 4096, JSON_FRAME = 2560 };
static const double crease = 0.766; /* cosine of 40 degrees: faces that are turned further have an edge between them */

/* ---- the lists of the JSON ---- */

/* Adds an entry and returns its index. */
__attribute__((format(printf, 3, 4))) static size_t entry(hk_gltf *g, hk_gltf_list list, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  if (g->list[list].count) fputs(",\n", g->list[list].stream);
  vfprintf(g->list[list].stream, format, arguments);
  va_end(arguments);
  return g->list[list].count++;
}

static bool lists_open(hk_gltf *g) {
  for (int k = 0; k < HK_GLTF_LISTS; k++) {
    g->list[k].stream = open_memstream(&g->list[k].text, &g->list[k].length);
    if (!g->list[k].stream) return false;
  }
  return true;
}

static void lists_close(hk_gltf *g) {
  for (int k = 0; k < HK_GLTF_LISTS; k++) {
    if (g->list[k].stream) fclose(g->list[k].stream);
    free(g->list[k].text);
  }
}

static const char *text_of(hk_gltf *g, hk_gltf_list list) {
  fflush(g->list[list].stream);
  return g->list[list].text;
}

static void clear(hk_gltf *g, hk_gltf_list list) {
  rewind(g->list[list].stream);
  fflush(g->list[list].stream);
  g->list[list].count = 0;
}

/* ---- the binary part ---- */

static size_t add_view(hk_gltf *g, size_t bytes) {
  size_t view = entry(g, HK_GLTF_VIEWS, "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", g->bytes, bytes);
  g->bytes += bytes;
  return view;
}

static void put_floats(hk_gltf *g, const float *value, size_t count) {
  for (size_t k = 0; k < count; k++) hk_put_little(g->file.stream, hk_bits_single(value[k]), 4);
}

/* Vectors (n x 3), with their bounds, which those of places must have. */
static size_t add_vectors(hk_gltf *g, const float *x, size_t n) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t k = 0; k < 3 * n; k++) {
    low[k % 3] = fminf(low[k % 3], x[k]);
    high[k % 3] = fmaxf(high[k % 3], x[k]);
  }
  size_t view = add_view(g, 12 * n);
  put_floats(g, x, 3 * n);
  return entry(g, HK_GLTF_ACCESSORS,
               "{\"bufferView\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"VEC3\",\"min\":[%.9g,%.9g,%.9g],"
               "\"max\":[%.9g,%.9g,%.9g]}",
               view, FLOATS, n, (double)low[0], (double)low[1], (double)low[2], (double)high[0], (double)high[1],
               (double)high[2]);
}

static size_t add_indices(hk_gltf *g, const uint32_t *index, size_t count) {
  size_t view = add_view(g, 4 * count);
  for (size_t k = 0; k < count; k++) hk_put_little(g->file.stream, index[k], 4);
  return entry(g, HK_GLTF_ACCESSORS, "{\"bufferView\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\"}",
               view, INDICES, count);
}

static size_t add_times(hk_gltf *g, const double *time, size_t count) {
  size_t view = add_view(g, 4 * count);
  for (size_t k = 0; k < count; k++) hk_put_little(g->file.stream, hk_bits_single((float)time[k]), 4);
  return entry(
      g, HK_GLTF_ACCESSORS,
      "{\"bufferView\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\",\"min\":[%.9g],\"max\":[%.9g]}", view,
      FLOATS, count, (double)(float)time[0], (double)(float)time[count - 1]);
}

/* ---- a mesh ---- */

static void place(const hk_gltf *g, const hk_frame_data *s, float *x) {
  for (size_t k = 0; k < 3 * s->n; k++) x[k] = (float)(s->x[k] - g->origin[k % 3]);
}

static void face_normal(const float *x, const uint32_t *t, double n[3]) {
  double a[3], b[3];
  for (int c = 0; c < 3; c++) {
    a[c] = (double)x[3 * t[1] + c] - (double)x[3 * t[0] + c];
    b[c] = (double)x[3 * t[2] + c] - (double)x[3 * t[0] + c];
  }
  for (int c = 0; c < 3; c++) n[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static void make_unit(float *n) {
  float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int c = 0; c < 3; c++) n[c] = length > 0 ? n[c] / length : c == 2;
}

/* Of each particle the mean of its triangles', by their areas, of length one; of no triangle: (0, 0, 1). */
static void find_normals(const hk_frame_cells *cells, const float *x, size_t n, float *normal) {
  memset(normal, 0, 3 * n * sizeof *normal);
  for (size_t k = 0; k < cells->triangles; k++) {
    double f[3];
    face_normal(x, cells->triangle[k], f);
    for (int i = 0; i < 3; i++)
      for (int c = 0; c < 3; c++) normal[3 * cells->triangle[k][i] + c] += (float)f[c];
  }
  for (size_t i = 0; i < n; i++) make_unit(normal + 3 * i);
}

/* Whether no triangle is turned from its corners' normals as by an edge of a body. */
static bool is_smooth(const hk_frame_cells *cells, const float *x, const float *normal) {
  for (size_t k = 0; k < cells->triangles; k++) {
    double f[3];
    face_normal(x, cells->triangle[k], f);
    double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    for (int i = 0; i < 3; i++) {
      const float *n = normal + 3 * cells->triangle[k][i];
      if (f[0] * (double)n[0] + f[1] * (double)n[1] + f[2] * (double)n[2] < crease * length) return false;
    }
  }
  return true;
}

static void *copy(const void *from, size_t bytes) {
  void *to = malloc(bytes + 1);
  if (to && bytes) memcpy(to, from, bytes);
  return to;
}

static void free_mesh(hk_gltf *g) {
  free(g->begin), free(g->normal), free(g->now);
  free(g->cells.vertex), free(g->cells.segment), free(g->cells.triangle);
  g->begin = g->normal = g->now = NULL;
  g->cells = (hk_frame_cells){0};
  g->frames = 0;
}

static bool begin_mesh(hk_gltf *g, const hk_frame_data *s) {
  const hk_frame_cells *c = &s->cells;
  g->n = s->n, g->first = g->times;
  g->begin = malloc((3 * s->n + 1) * sizeof *g->begin);
  g->normal = malloc((3 * s->n + 1) * sizeof *g->normal);
  g->now = malloc((3 * s->n + 1) * sizeof *g->now);
  g->cells = *c;
  g->cells.vertex = copy(c->vertex, c->vertices * sizeof *c->vertex);
  g->cells.segment = copy(c->segment, c->segments * sizeof *c->segment);
  g->cells.triangle = copy(c->triangle, c->triangles * sizeof *c->triangle);
  if (!g->begin || !g->normal || !g->now || !g->cells.vertex || !g->cells.segment || !g->cells.triangle) return false;
  place(g, s, g->begin);
  find_normals(&g->cells, g->begin, g->n, g->normal);
  g->smooth = is_smooth(&g->cells, g->begin, g->normal);
  clear(g, HK_GLTF_TARGETS);
  clear(g, HK_GLTF_POINTS);
  return true;
}

/* How far each place, and normal, is from those of the first frame. */
static void add_target(hk_gltf *g, const hk_frame_data *s) {
  place(g, s, g->now);
  float *normal = g->smooth ? malloc((3 * g->n + 1) * sizeof *normal) : NULL;
  if (normal) find_normals(&g->cells, g->now, g->n, normal);
  for (size_t k = 0; k < 3 * g->n; k++) {
    g->now[k] -= g->begin[k];
    if (normal) normal[k] -= g->normal[k];
  }
  size_t x = add_vectors(g, g->now, g->n);
  entry(g, HK_GLTF_POINTS, "{\"POSITION\":%zu}", x);
  if (!g->smooth)
    entry(g, HK_GLTF_TARGETS, "{\"POSITION\":%zu}", x);
  else if (normal)
    entry(g, HK_GLTF_TARGETS, "{\"POSITION\":%zu,\"NORMAL\":%zu}", x, add_vectors(g, normal, g->n));
  else
    g->file.cause = ENOMEM;
  free(normal);
}

/* A part of the mesh, if there is any of it: "," before it where it is not the first. */
static void add_part(hk_gltf *g, FILE *to, int mode, const uint32_t *index, size_t count, size_t x, size_t normal) {
  bool faces = mode == TRIANGLES && g->smooth;
  if (!count) return;
  if (ftell(to) > 0) putc(',', to);
  fprintf(to, "{\"attributes\":{\"POSITION\":%zu", x);
  if (faces) fprintf(to, ",\"NORMAL\":%zu", normal);
  fprintf(to, "},\"indices\":%zu,\"mode\":%d,\"material\":0", add_indices(g, index, count), mode);
  if (g->frames > 1) fprintf(to, ",\"targets\":[%s]", text_of(g, faces ? HK_GLTF_TARGETS : HK_GLTF_POINTS));
  putc('}', to);
}

/* Frame k of the mesh has the target k - 1 alone, the first one none: a matrix of zeros but for these ones. */
static void add_weights(hk_gltf *g, size_t node, size_t input) {
  size_t targets = g->frames - 1;
  size_t places = add_view(g, 4 * targets);
  for (size_t k = 0; k < targets; k++) hk_put_little(g->file.stream, (k + 1) * targets + k, 4);
  size_t ones = add_view(g, 4 * targets);
  for (size_t k = 0; k < targets; k++) hk_put_little(g->file.stream, hk_bits_single(1), 4);
  size_t weights =
      entry(g, HK_GLTF_ACCESSORS,
            "{\"componentType\":%d,\"count\":%zu,\"type\":\"SCALAR\",\"sparse\":{\"count\":%zu,\"indices\":{"
            "\"bufferView\":%zu,\"componentType\":%d},\"values\":{\"bufferView\":%zu}}}",
            FLOATS, g->frames * targets, targets, places, INDICES, ones);
  size_t sampler = entry(g, HK_GLTF_SAMPLERS, "{\"input\":%zu,\"output\":%zu}", input, weights);
  entry(g, HK_GLTF_CHANNELS, "{\"sampler\":%zu,\"target\":{\"node\":%zu,\"path\":\"weights\"}}", sampler, node);
}

/* A node is of size 0 before its mesh begins, and from the time `until` on, s, where the next one has begun; NAN: no
 * other follows. */
static void add_visibility(hk_gltf *g, size_t node, double until) {
  double time[3];
  float seen[9] = {0};
  size_t keys = 0;
  if (g->first > 0) time[keys++] = g->time[0];
  for (int c = 0; c < 3; c++) seen[3 * keys + c] = 1;
  time[keys++] = g->time[g->first];
  if (!isnan(until)) time[keys++] = until;
  size_t input = add_times(g, time, keys), output = add_vectors(g, seen, keys);
  size_t sampler =
      entry(g, HK_GLTF_SAMPLERS, "{\"input\":%zu,\"output\":%zu,\"interpolation\":\"STEP\"}", input, output);
  entry(g, HK_GLTF_CHANNELS, "{\"sampler\":%zu,\"target\":{\"node\":%zu,\"path\":\"scale\"}}", sampler, node);
}

/* last: no other mesh follows. */
static bool end_mesh(hk_gltf *g, bool last) {
  char *parts = NULL;
  size_t length = 0;
  FILE *to = open_memstream(&parts, &length);
  if (!to) return false;
  size_t x = add_vectors(g, g->begin, g->n), normal = g->smooth ? add_vectors(g, g->normal, g->n) : 0;
  add_part(g, to, TRIANGLES, g->cells.triangle[0], 3 * g->cells.triangles, x, normal);
  add_part(g, to, LINES, g->cells.segment[0], 2 * g->cells.segments, x, normal);
  add_part(g, to, POINTS, g->cells.vertex, g->cells.vertices, x, normal);
  bool fine = fclose(to) == 0;
  size_t mesh = entry(g, HK_GLTF_MESHES, "{\"primitives\":[%s]}", parts);
  size_t node = 1 + entry(g, HK_GLTF_NODES, "{\"mesh\":%zu}", mesh);
  if (g->frames > 1) add_weights(g, node, add_times(g, g->time + g->first, g->frames));
  if (!last || g->first > 0) add_visibility(g, node, last ? (double)NAN : g->time[g->times]);
  free(parts);
  free_mesh(g);
  return fine;
}

/* ---- the file ---- */

bool hk_gltf_open(hk_gltf *g, const char *path, size_t frames, bool z_up, char *why, size_t size) {
  *g = (hk_gltf){.most = frames, .z_up = z_up, .room = (JSON_HEAD + JSON_FRAME * frames) & ~(size_t)3};
  g->time = malloc((frames + 1) * sizeof *g->time);
  if (!g->time || !lists_open(g)) return hk_whole_failed(ENOMEM, why, size);
  if (!hk_whole_open(&g->file, path, why, size)) return false;
  if (fseek(g->file.stream, (long)(HEAD + CHUNK_HEAD + g->room + CHUNK_HEAD), SEEK_SET) != 0)
    return hk_whole_failed(errno, why, size);
  return true;
}

bool hk_gltf_add(hk_gltf *g, const hk_frame_data *s, bool changed, char *why, size_t size) {
  if (g->times == 0) hk_frame_middle(s, g->origin);
  g->time[g->times] = s->t;
  if (g->frames && changed && !end_mesh(g, false)) return hk_whole_failed(ENOMEM, why, size);
  if (s->n > 0 && !g->frames && !begin_mesh(g, s)) return hk_whole_failed(ENOMEM, why, size);
  if (s->n > 0 && g->frames++ > 0) add_target(g, s);
  g->times++;
  if (HEAD + 2 * CHUNK_HEAD + g->room + g->bytes > UINT32_MAX) {
    snprintf(why, size, "more than 4 GiB, the most that a file of glTF can have: take fewer frames (--every 2)");
    return false;
  }
  return hk_whole_check(&g->file) || hk_whole_failed(g->file.cause, why, size);
}

static void write_json(hk_gltf *g, FILE *to) {
  size_t nodes = g->list[HK_GLTF_NODES].count;
  fputs("{\"asset\":{\"version\":\"2.0\",\"generator\":\"hooke\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\n\"nodes\":"
        "[{",
        to);
  if (g->z_up) fputs("\"rotation\":[-0.70710678118654752,0,0,0.70710678118654752],", to);
  const double *o = g->origin;
  fprintf(to, "\"translation\":[%.17g,%.17g,%.17g]", o[0], g->z_up ? o[2] : o[1], g->z_up ? -o[1] : o[2]);
  if (nodes) fputs(",\"children\":[", to);
  for (size_t k = 1; k <= nodes; k++) fprintf(to, "%s%zu", k > 1 ? "," : "", k);
  fprintf(to, "%s}%s%s],\n", nodes ? "]" : "", nodes ? "," : "", text_of(g, HK_GLTF_NODES));
  if (g->list[HK_GLTF_CHANNELS].count)
    fprintf(to, "\"animations\":[{\"samplers\":[%s],\"channels\":[%s]}],\n", text_of(g, HK_GLTF_SAMPLERS),
            text_of(g, HK_GLTF_CHANNELS));
  if (nodes)
    fprintf(to,
            "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.08,0.26,0.6,1],\"metallicFactor\":0,"
            "\"roughnessFactor\":0.6},\"doubleSided\":true}],\n\"meshes\":[%s],\n\"accessors\":[%s],\n\"bufferViews\":["
            "%s],\n"
            "\"buffers\":[{\"byteLength\":%zu}]",
            text_of(g, HK_GLTF_MESHES), text_of(g, HK_GLTF_ACCESSORS), text_of(g, HK_GLTF_VIEWS), g->bytes);
  else
    fputs("\"extras\":{}", to);
  putc('}', to);
}

/* The heads and the JSON, in the room that was left for them. */
static bool finish(hk_gltf *g) {
  char *json = NULL;
  size_t length = 0;
  FILE *to = open_memstream(&json, &length), *file = g->file.stream;
  if (!to) return false;
  write_json(g, to);
  bool fine = fclose(to) == 0 && length <= g->room && fseek(file, 0, SEEK_SET) == 0;
  fputs("glTF", file);
  hk_put_little(file, 2, 4);
  hk_put_little(file, HEAD + CHUNK_HEAD + g->room + (g->bytes ? CHUNK_HEAD + g->bytes : 0), 4);
  hk_put_little(file, g->room, 4);
  fputs("JSON", file);
  fprintf(file, "%s%*s", json, (int)(g->room - length), "");
  if (g->bytes) {
    hk_put_little(file, g->bytes, 4);
    fwrite("BIN", 1, 4, file);
  }
  free(json);
  return fine;
}

bool hk_gltf_close(hk_gltf *g, bool keep, char *why, size_t size) {
  if (g->file.stream && keep) {
    if (g->frames && !end_mesh(g, true)) g->file.cause = ENOMEM;
    if (!finish(g) && !g->file.cause) g->file.cause = ENOMEM;
  }
  bool fine = hk_whole_close(&g->file, keep, why, size);
  free_mesh(g);
  lists_close(g);
  free(g->time);
  *g = (hk_gltf){0};
  return fine;
}
