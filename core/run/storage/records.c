/* Records of a text file: a line, or several where all but the last end with a backslash. Lines that begin with # are
 * comments, of any length. */
#include "core/run/storage/storage.h"

#include <errno.h>
#include <string.h>

void hk_records_begin(hk_records *r, FILE *file, size_t most) {
  r->file = file;
  r->line = r->lines = r->read = 0;
  r->most = most;
}

/* Ends a line of the record; false: the next one belongs to it as well. */
static bool end_line(hk_records *r, size_t *length) {
  r->lines++;
  if (*length > 0 && r->record[*length - 1] == '\r') --*length;
  bool more = *length > 0 && r->record[*length - 1] == '\\';
  *length -= more;
  r->record[*length] = 0;
  return !more;
}

bool hk_records_next(hk_records *r, const char **wrong) {
  size_t length = 0;
  int c;
  r->line = r->lines + 1;
  while ((c = getc(r->file)) != EOF && !*wrong) {
    if (c == '\n') {
      if (end_line(r, &length)) return true;
    } else if (c == 0)
      *wrong = "the line has a zero byte: this is no text";
    else if (++r->read > r->most)
      *wrong = "the file is larger than the script's memory";
    else if (length > 0 && r->record[0] == '#')
      continue;
    else if (length + 1 == HK_RECORD_LONGEST)
      *wrong = "the line is longer than 16383 characters";
    else
      r->record[length++] = (char)c;
  }
  if (ferror(r->file)) *wrong = strerror(errno);
  if (length > 0 && !*wrong) end_line(r, &length);
  return length > 0 && !*wrong;
}
