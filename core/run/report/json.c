/* The summary as JSON: one object in one line, with the keys of the figure table. */
#include "core/run/report/report.h"
#include "core/engine/text/text.h"

#include <string.h>

/* RFC 8259: UTF-8, with control characters and such that change the direction of writing as \u escapes. A byte that is
 * no UTF-8 becomes U+FFFD, the replacement character. */
void hk_json_string(FILE *f, const char *text) {
  fputc('"', f);
  while (*text) {
    uint32_t code;
    size_t length = hk_utf8_next(text, &code);
    if (code == '"' || code == '\\')
      fprintf(f, "\\%c", (int)code);
    else if (length == 0 || code < 0x20 || hk_commands_terminal(code))
      fprintf(f, "\\u%04x", length ? (unsigned)code : 0xfffdu);
    else
      fwrite(text, 1, length, f);
    text += length ? length : 1;
  }
  fputc('"', f);
}

void hk_json_number(FILE *f, double value) {
  if (isfinite(value))
    fprintf(f, "%.17g", value);
  else
    fputs("null", f);
}

void hk_json_key(FILE *f, const char *key) {
  hk_json_string(f, key);
  fputc(':', f);
}

static void write_figure(FILE *f, const hk_summary *s, const hk_figure *figure) {
  const void *field = (const char *)s + figure->offset;
  const char *text = figure->type == HK_FIGURE_TEXT ? *(const char *const *)field : field;
  hk_json_key(f, figure->key);
  if (figure->type == HK_FIGURE_COUNT)
    fprintf(f, "%zu", *(const size_t *)field);
  else if (figure->type == HK_FIGURE_NUMBER)
    hk_json_number(f, *(const double *)field);
  else
    hk_json_string(f, text ? text : "");
}

/* Figures of one group stand side by side in the table. */
static void write_figures(FILE *f, const hk_summary *s) {
  const char *group = NULL;
  for (const hk_figure *figure = hk_figure_table; figure->key; figure++) {
    bool same = group == figure->group || (group && figure->group && strcmp(group, figure->group) == 0);
    if (!same && group) fputc('}', f);
    fputs(figure == hk_figure_table ? "" : ",", f);
    if (!same && figure->group) {
      hk_json_key(f, figure->group);
      fputc('{', f);
      write_figure(f, s, figure);
    } else
      write_figure(f, s, figure);
    group = figure->group;
  }
  if (group) fputc('}', f);
}

/* The lines "what<TAB>value" of an origin as an object. */
static void write_origin(FILE *f, const char *text) {
  char word[2][1024];
  for (const char *line = text; line && *line; line += strcspn(line, "\n"), line += *line == '\n') {
    int what = (int)strcspn(line, "\t\n"), value = (int)strcspn(line + what, "\n");
    snprintf(word[0], sizeof word[0], "%.*s", what, line);
    snprintf(word[1], sizeof word[1], "%.*s", value ? value - 1 : 0, line + what + (value > 0));
    if (line != text) fputc(',', f);
    hk_json_key(f, word[0]);
    hk_json_string(f, word[1]);
  }
}

static void write_own_figures(FILE *f, const hk_plugin_time *p) {
  fputc(',', f);
  hk_json_key(f, "figures");
  for (size_t k = 0; k < p->figures; k++) {
    fputc(k ? ',' : '{', f);
    hk_json_key(f, p->figure[k].name);
    hk_json_number(f, p->figure[k].value);
  }
  fputc('}', f);
}

static void write_plugins(FILE *f, const hk_summary *s) {
  for (size_t k = 0; k < s->plugins; k++) {
    const hk_plugin_time *p = &s->plugin[k];
    const char *const pair[][2] = {{"kind", p->kind}, {"name", p->name}, {"label", p->label}};
    fputs(k ? ",{" : "{", f);
    for (int e = 0; e < 3; e++) {
      hk_json_key(f, pair[e][0]);
      hk_json_string(f, pair[e][1]);
      fputc(',', f);
    }
    hk_json_key(f, "seconds");
    hk_json_number(f, p->seconds);
    if (p->figures) write_own_figures(f, p);
    fputc('}', f);
  }
}

/* Of the measures whose units the scene says. */
static void write_units(FILE *f, const hk_summary *s) {
  bool first = true;
  for (size_t k = 0; k < s->measures; k++) {
    if (!*s->measure_unit[k]) continue;
    if (!first) fputc(',', f);
    hk_json_key(f, s->measure_name[k]);
    hk_json_string(f, s->measure_unit[k]);
    first = false;
  }
}

void hk_report_json(FILE *f, const hk_summary *s) {
  fputc('{', f);
  write_figures(f, s);
  fputs(",\"origin\":{", f);
  write_origin(f, s->origin);
  fputs("},\"plugins\":[", f);
  write_plugins(f, s);
  fputs("],\"measures\":{", f);
  for (size_t k = 0; k < s->measures; k++) {
    if (k) fputc(',', f);
    hk_json_key(f, s->measure_name[k]);
    hk_json_number(f, s->measure[k]);
  }
  fputs("},\"measure_units\":{", f);
  write_units(f, s);
  fputs("},\"warnings\":[", f);
  for (size_t k = 0; k < s->warnings; k++) {
    if (k) fputc(',', f);
    hk_json_string(f, s->warning[k]);
  }
  fputs("]}\n", f);
}
