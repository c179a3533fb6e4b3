/* The summary as text: a line per label of the figure table; unknown figures are omitted. */
#include "core/run/report/report.h"
#include "core/engine/text/text.h"

#include <string.h>

static const void *field(const hk_summary *s, const hk_figure *f) { return (const char *)s + f->offset; }

static const char *text_of(const hk_summary *s, const hk_figure *f) {
  return f->type == HK_FIGURE_BUFFER ? field(s, f) : *(const char *const *)field(s, f);
}

/* Whether a figure is known; a count that continues a line is omitted when it is 0. */
static bool known(const hk_summary *s, const hk_figure *f) {
  if (f->type == HK_FIGURE_COUNT)
    return f->label || f->offset == offsetof(hk_summary, n) || *(const size_t *)field(s, f);
  if (f->type == HK_FIGURE_NUMBER) return isfinite(*(const double *)field(s, f));
  return text_of(s, f) && *text_of(s, f);
}

/* Labels and names may hold anything, line breaks too, and none of them makes a line of the summary. */
static void print_text(FILE *out, const char *format, const char *text) {
  char plain[1024];
  hk_plain_line(plain, sizeof plain, text);
  fprintf(out, format, plain);
}

static void print(FILE *out, const hk_summary *s, const hk_figure *f) {
  if (f->type == HK_FIGURE_COUNT)
    fprintf(out, f->format, *(const size_t *)field(s, f));
  else if (f->type == HK_FIGURE_NUMBER)
    fprintf(out, f->format, *(const double *)field(s, f));
  else
    print_text(out, f->format, text_of(s, f));
}

/* Whether a figure gets a line: a constraint violation of 0 is omitted. */
static bool is_printed(const hk_summary *s, const hk_figure *f) {
  return known(s, f) && !(f->offset == offsetof(hk_summary, constraint_violation) && !(s->constraint_violation > 0));
}

static void print_measures(FILE *out, const hk_summary *s) {
  for (size_t k = 0; k < s->measures; k++) {
    print_text(out, "  %-17s ", s->measure_name[k]);
    fprintf(out, "%.9g%s%s\n", s->measure[k], *s->measure_unit[k] ? " " : "", s->measure_unit[k]);
  }
}

/* A line for each corrector that says something of the run. */
static void print_own_figures(FILE *out, const hk_summary *s) {
  for (size_t p = 0; p < s->plugins; p++) {
    const hk_plugin_time *plugin = &s->plugin[p];
    bool line = false;
    for (size_t k = 0; k < plugin->figures; k++) {
      const hk_own_figure *figure = &plugin->figure[k];
      if (!isfinite(figure->value)) continue;
      if (!line) print_text(out, "  %-17s ", plugin->label);
      fprintf(out, "%s%s %.3g%s%s", line ? ", " : "", figure->name, figure->value, *figure->unit ? " " : "",
              figure->unit);
      line = true;
    }
    if (line) fputc('\n', out);
  }
}

static void print_times(FILE *out, const hk_summary *s) {
  for (size_t k = 0; k < s->plugins; k++)
    if (s->plugin[k].seconds > 0) {
      fprintf(out, "    %-11s ", s->plugin[k].kind);
      print_text(out, "%-18s ", s->plugin[k].label);
      const char *kind = s->plugin[k].kind;
      bool shared = strcmp(kind, hk_kind_name(HK_SERVICE)) == 0 || strcmp(kind, hk_kind_name(HK_SOLVER)) == 0;
      fprintf(out, "%9.4f s%s\n", s->plugin[k].seconds,
              shared               ? ", in the time of those who ask it"
              : s->plugin[k].apart ? ", without parts: a sweep over the particles of its own"
                                   : "");
    }
}

static void begin_line(FILE *out, const hk_summary *s, const hk_figure *f, const char *folder) {
  if (f->offset == offsetof(hk_summary, wall_s)) {
    print_measures(out, s);
    print_own_figures(out, s);
  }
  if (f->offset == offsetof(hk_summary, verdict_name)) {
    print_times(out, s);
    if (folder) print_text(out, "  output            %s\n", folder);
  }
  if (*f->label) fprintf(out, "  %-17s ", f->label);
}

void hk_report_text(FILE *out, const hk_summary *s, const char *folder) {
  bool line = false;
  for (const hk_figure *f = hk_figure_table; f->key; f++) {
    if (!f->format) continue;
    if (f->label && line) fputc('\n', out);
    if (f->label) {
      line = is_printed(s, f);
      if (line) begin_line(out, s, f, folder);
    }
    if (line && known(s, f)) print(out, s, f);
    if (line && f->offset == offsetof(hk_summary, energy_drift) && !known(s, f)) fputs(", drift not known", out);
  }
  if (line) fputc('\n', out);
}
