/* What the parameters of a scene are: for people behind the options, for programs as JSON. */
#include "core/app/options/options.h"
#include "core/engine/text/text.h"

static void print_limits(const hk_param_declared *p) {
  if (p->min <= p->max)
    printf(" (%g to %g)", p->min, p->max);
  else if (!isnan(p->min))
    printf(" (at least %g)", p->min);
  else if (!isnan(p->max))
    printf(" (at most %g)", p->max);
}

static void print_row(const hk_param_declared *p) {
  char name[256], initial[256];
  hk_plain_line(name, sizeof name, p->name);
  hk_plain_line(initial, sizeof initial, p->initial);
  printf("  %-12s %-12s ", name, initial);
  hk_print_plain(stdout, p->help ? p->help : "");
  print_limits(p);
  printf("\n");
}

static void write_object(FILE *file, const hk_param_declared *p) {
  const char *const text[][2] = {
      {"name", p->name}, {"type", p->type}, {"initial", p->initial}, {"value", p->value}, {"help", p->help}};
  putc('{', file);
  for (size_t k = 0; k < sizeof text / sizeof *text; k++) {
    hk_json_key(file, text[k][0]);
    hk_json_string(file, text[k][1] ? text[k][1] : "");
    putc(',', file);
  }
  hk_json_key(file, "min");
  hk_json_number(file, p->min);
  putc(',', file);
  hk_json_key(file, "max");
  hk_json_number(file, p->max);
  putc('}', file);
}

void hk_parameters_write(FILE *file, const hk_script *script) {
  const hk_param_declared *list;
  size_t count = hk_script_params(script, &list);
  fputs("{\"parameters\":[", file);
  for (size_t k = 0; k < count; k++) {
    if (k) putc(',', file);
    write_object(file, &list[k]);
  }
  fputs("]}\n", file);
}

void hk_parameters_print(const hk_script *script, bool json) {
  const hk_param_declared *list;
  if (json) {
    hk_parameters_write(stdout, script);
    return;
  }
  size_t count = hk_script_params(script, &list);
  if (count) printf("\nparameters of this scene (name=value):\n");
  for (size_t k = 0; k < count; k++) print_row(&list[k]);
}
