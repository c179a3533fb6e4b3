/* VTK's legacy format, version 3.0, binary (big endian), an unstructured grid (The VTK User's Guide, "Simple Legacy
 * Formats"). */
#include "tools/native/formats/bytes.h"
#include "tools/native/formats/formats.h"

enum { VTK_VERTEX = 1, VTK_LINE = 3, VTK_TRIANGLE = 5 };

static void put_doubles(FILE *file, const double *from, size_t count) {
  for (size_t k = 0; k < count; k++) hk_put_big(file, hk_bits(from[k]), 8);
  putc('\n', file);
}

static void put_array(FILE *file, const char *prefix, const char *name, const double *from, size_t width, size_t n) {
  fputs(prefix, file);
  hk_put_word(file, name);
  fprintf(file, " %zu %zu double\n", width, n);
  put_doubles(file, from, width * n);
}

static void put_cells(FILE *file, const hk_frame_cells *c) {
  size_t cells = hk_cell_count(c);
  fprintf(file, "CELLS %zu %zu\n", cells, cells + c->vertices + 2 * c->segments + 3 * c->triangles);
  for (size_t k = 0; k < c->vertices; k++) hk_put_big(file, 1, 4), hk_put_big(file, c->vertex[k], 4);
  for (size_t k = 0; k < c->segments; k++) {
    hk_put_big(file, 2, 4);
    for (int m = 0; m < 2; m++) hk_put_big(file, c->segment[k][m], 4);
  }
  for (size_t k = 0; k < c->triangles; k++) {
    hk_put_big(file, 3, 4);
    for (int m = 0; m < 3; m++) hk_put_big(file, c->triangle[k][m], 4);
  }
  fprintf(file, "\nCELL_TYPES %zu\n", cells);
  for (size_t k = 0; k < cells; k++)
    hk_put_big(file, k < c->vertices ? VTK_VERTEX : k < c->vertices + c->segments ? VTK_LINE : VTK_TRIANGLE, 4);
  putc('\n', file);
}

static void put_particles(FILE *file, const hk_frame_data *s) {
  fprintf(file, "POINT_DATA %zu\nFIELD particles %zu\n", s->n, 3 + (s->strain != NULL) + s->arrays);
  put_array(file, "", "velocity", s->v, 3, s->n);
  put_array(file, "", "mass", s->mass, 1, s->n);
  fprintf(file, "id 1 %zu unsigned_int\n", s->n);
  for (size_t i = 0; i < s->n; i++) hk_put_big(file, s->id[i], 4);
  putc('\n', file);
  if (s->strain) put_array(file, "", "strain", s->strain, 1, s->n);
  for (size_t k = 0; k < s->arrays; k++)
    put_array(file, s->array[k].force ? "force_" : "", s->array[k].name, s->array[k].value, s->array[k].width, s->n);
}

static void write_vtk(FILE *file, const hk_frame_data *s) {
  fprintf(file, "# vtk DataFile Version 3.0\nhooke, t = %.17g s\nBINARY\nDATASET UNSTRUCTURED_GRID\n", s->t);
  fputs("FIELD frame 1\nTIME 1 1 double\n", file);
  put_doubles(file, &s->t, 1);
  fprintf(file, "POINTS %zu double\n", s->n);
  put_doubles(file, s->x, 3 * s->n);
  put_cells(file, &s->cells);
  put_particles(file, s);
}

const hk_sequence_format hk_sequence_vtk = {"vtk", write_vtk};
