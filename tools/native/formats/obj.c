/* Wavefront OBJ: vertices, points, lines and triangles; indices from 1. Positions in 17 digits, which restore every
 * double. */
#include "tools/native/formats/formats.h"

static void write_obj(FILE *file, const hk_frame_data *s) {
  const hk_frame_cells *c = &s->cells;
  fprintf(file, "# t = %.17g s\n", s->t);
  for (size_t i = 0; i < s->n; i++)
    fprintf(file, "v %.17g %.17g %.17g\n", s->x[3 * i], s->x[3 * i + 1], s->x[3 * i + 2]);
  for (size_t k = 0; k < c->vertices; k++) fprintf(file, "p %zu\n", (size_t)c->vertex[k] + 1);
  for (size_t k = 0; k < c->segments; k++)
    fprintf(file, "l %zu %zu\n", (size_t)c->segment[k][0] + 1, (size_t)c->segment[k][1] + 1);
  for (size_t k = 0; k < c->triangles; k++)
    fprintf(file, "f %zu %zu %zu\n", (size_t)c->triangle[k][0] + 1, (size_t)c->triangle[k][1] + 1,
            (size_t)c->triangle[k][2] + 1);
}

const hk_sequence_format hk_sequence_obj = {"obj", write_obj};
