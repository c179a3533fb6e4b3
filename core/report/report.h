/* Printing a summary. */
#ifndef HK_REPORT_H
#define HK_REPORT_H

#include "core/run/run.h"
#include <stdio.h>

void hk_report_text(FILE *, const hk_summary *, const char *out); /* out: where the outputs are, or NULL */
void hk_report_json(FILE *, const hk_summary *);                  /* one object, one line; NAN is null */
const char *hk_verdict_name(hk_verdict);                          /* "ok", "inaccurate", "diverged", "interrupted" */

#endif
