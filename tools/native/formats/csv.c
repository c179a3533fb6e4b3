/* Numbers in 17 digits, which restore every double; lines end with a line feed alone, as in the engine's other tables.
 */
#include "tools/native/formats/csv.h"

#include "plugins/common/frame_data/csv_name.h"

static void put_name(FILE *file, const hk_frame_array *a, size_t c) {
  char component[24] = "";
  if (a->width > 1) snprintf(component, sizeof component, " %zu", c + 1);
  putc(',', file);
  hk_put_csv_name(file, a->force ? "force " : "", a->name, component, true);
}

void hk_csv_head(FILE *file, const hk_frame_data *s) {
  fputs("t [s],id,x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],mass [kg]", file);
  if (s->strain) fputs(",strain", file);
  for (size_t k = 0; k < s->arrays; k++)
    for (size_t c = 0; c < s->array[k].width; c++) put_name(file, &s->array[k], c);
  putc('\n', file);
}

static void put_row(FILE *file, const hk_frame_data *s, size_t i) {
  fprintf(file, "%.17g,%u", s->t, s->id[i]);
  for (size_t c = 0; c < 3; c++) fprintf(file, ",%.17g", s->x[3 * i + c]);
  for (size_t c = 0; c < 3; c++) fprintf(file, ",%.17g", s->v[3 * i + c]);
  fprintf(file, ",%.17g", s->mass[i]);
  if (s->strain) fprintf(file, ",%.17g", s->strain[i]);
  for (size_t k = 0; k < s->arrays; k++)
    for (size_t c = 0; c < s->array[k].width; c++)
      fprintf(file, ",%.17g", s->array[k].value[s->array[k].width * i + c]);
  putc('\n', file);
}

void hk_csv_rows(FILE *file, const hk_frame_data *s) {
  for (size_t i = 0; i < s->n; i++) put_row(file, s, i);
}
