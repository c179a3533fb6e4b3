/* Names as cells of tables (CSV, RFC 4180). */
#ifndef HK_CSV_NAME_H
#define HK_CSV_NAME_H

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Spreadsheets compute what begins so. An apostrophe ahead makes it a text. */
static inline bool hk_is_formula(const char *name) { return *name && strchr("=+-@\t\r", *name); }

/* In quotes where the name has a character that would end the cell, or where `quoted` says so; `after` is a part of
 * it. */
static inline void hk_put_csv_name(FILE *file, const char *before, const char *name, const char *after, bool quoted) {
  quoted = quoted || name[strcspn(name, ",\"\r\n")] != 0;
  if (quoted) putc('"', file);
  if (!*before && hk_is_formula(name)) putc('\'', file);
  for (fputs(before, file); *name; name++) {
    if (*name == '"') putc('"', file);
    putc(*name, file);
  }
  fputs(after, file);
  if (quoted) putc('"', file);
}

#endif
