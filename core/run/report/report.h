/* Reports of a run: its figures as text and as JSON, both made from the table in judge/figure_table.c, and its
 * progress. */
#ifndef HK_REPORT_H
#define HK_REPORT_H

#include "core/run/judge/judge.h"
#include <stdio.h>

void hk_report_text(FILE *, const hk_summary *, const char *out); /* out: the output folder, or NULL */
void hk_report_json(FILE *, const hk_summary *);                  /* one object in one line; NAN is written as null */

/* The parts of JSON text: "text" with its escapes, a number or null, and "key": */
void hk_json_string(FILE *, const char *text);
void hk_json_number(FILE *, double);
void hk_json_key(FILE *, const char *key);

/* progress.c: on standard error, one line that is rewritten on a terminal, or a line every few seconds in a pipe. */
typedef struct hk_progress {
  int mode;          /* 0 or less: quiet, 1: lines, 2: one line on a terminal */
  double begin, end; /* s */
  size_t steps;      /* before: of the part that a resumed run goes on from */
  double at;         /* s, wall time of the last line */
  bool shown;
  double expected; /* s, what the run was said to take before its first step; 0: nothing was said */
  bool told;       /* how long it will take, once its first steps show it */
} hk_progress;

/* Says, before the first step, how long a run of so many steps will take where that is long. */
void hk_progress_expect(hk_progress *, double seconds_per_step, double steps);
void hk_progress_show(hk_progress *, const hk_loop *, const hk_frame *last);
void hk_progress_end(hk_progress *);

#endif
