/* PLY, binary, little endian (Turk 1994): particles with position, velocity, mass, strain and channels as vertices;
 * segments as edges, triangles as faces. */
#include "tools/native/formats/bytes.h"
#include "tools/native/formats/formats.h"

static void say_array(FILE *file, const hk_frame_array *a) {
  for (size_t c = 0; c < a->width; c++) {
    fputs(a->force ? "property double force_" : "property double ", file);
    hk_put_word(file, a->name);
    if (a->width > 1) fprintf(file, "_%zu", c + 1);
    putc('\n', file);
  }
}

static void write_head(FILE *file, const hk_frame_data *s) {
  static const char *const names[] = {"x", "y", "z", "vx", "vy", "vz", "mass"};
  fprintf(file, "ply\nformat binary_little_endian 1.0\ncomment t = %.17g s\nelement vertex %zu\n", s->t, s->n);
  for (int k = 0; k < 7; k++) fprintf(file, "property double %s\n", names[k]);
  fputs("property uint id\nproperty uchar pin\n", file);
  if (s->strain) fputs("property double strain\n", file);
  for (size_t k = 0; k < s->arrays; k++) say_array(file, &s->array[k]);
  fprintf(file, "element face %zu\nproperty list uchar uint vertex_indices\n", s->cells.triangles);
  fprintf(file, "element edge %zu\nproperty int vertex1\nproperty int vertex2\nend_header\n", s->cells.segments);
}

static void write_particle(FILE *file, const hk_frame_data *s, size_t i) {
  for (size_t c = 0; c < 3; c++) hk_put_little(file, hk_bits(s->x[3 * i + c]), 8);
  for (size_t c = 0; c < 3; c++) hk_put_little(file, hk_bits(s->v[3 * i + c]), 8);
  hk_put_little(file, hk_bits(s->mass[i]), 8);
  hk_put_little(file, s->id[i], 4);
  hk_put_little(file, s->pin[i], 1);
  if (s->strain) hk_put_little(file, hk_bits(s->strain[i]), 8);
  for (size_t k = 0; k < s->arrays; k++) {
    const hk_frame_array *a = &s->array[k];
    for (size_t c = 0; c < a->width; c++) hk_put_little(file, hk_bits(a->value[a->width * i + c]), 8);
  }
}

static void write_ply(FILE *file, const hk_frame_data *s) {
  write_head(file, s);
  for (size_t i = 0; i < s->n; i++) write_particle(file, s, i);
  for (size_t k = 0; k < s->cells.triangles; k++) {
    putc(3, file);
    for (int m = 0; m < 3; m++) hk_put_little(file, s->cells.triangle[k][m], 4);
  }
  for (size_t k = 0; k < s->cells.segments; k++)
    for (int m = 0; m < 2; m++) hk_put_little(file, s->cells.segment[k][m], 4);
}

const hk_sequence_format hk_sequence_ply = {"ply", write_ply};
