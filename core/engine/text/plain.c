/* Text of unknown origin made harmless for a terminal, see text.h. UTF-8 as in RFC 3629: no overlong forms, no
 * surrogates. */
#include "core/engine/text/text.h"

#include <stdio.h>
#include <string.h>

size_t hk_utf8_next(const char *text, uint32_t *code) {
  static const unsigned char first[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
  static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const unsigned char *c = (const unsigned char *)text;
  size_t length = *c < 0x80 ? 1 : *c < 0xc0 ? 0 : *c < 0xe0 ? 2 : *c < 0xf0 ? 3 : *c < 0xf8 ? 4 : 0;
  *code = *c & first[length];
  for (size_t k = 1; k < length; k++) {
    if ((c[k] & 0xc0) != 0x80) return 0;
    *code = *code << 6 | (c[k] & 0x3f);
  }
  bool valid = length && *code >= least[length] && *code <= 0x10ffff && (*code < 0xd800 || *code > 0xdfff);
  return valid ? length : 0;
}

/* Control characters, and those that change the direction of writing (Unicode UAX 9). */
bool hk_commands_terminal(uint32_t code) {
  if (code == '\n' || code == '\t') return false;
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || (code >= 0x200e && code <= 0x200f) ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

/* Writes the next character into `piece`; returns the bytes read. */
static size_t next(const char *text, char piece[16], bool line) {
  uint32_t code;
  size_t length = hk_utf8_next(text, &code);
  if (length && !hk_commands_terminal(code) && !(line && code < ' ')) {
    memcpy(piece, text, length);
    piece[length] = 0;
    return length;
  }
  if (!length) code = (unsigned char)*text;
  snprintf(piece, 16, code < 0x100 ? "\\x%02x" : "\\u{%x}", (unsigned)code);
  return length ? length : 1;
}

void hk_print_plain(FILE *file, const char *text) {
  char piece[16];
  while (*text) {
    text += next(text, piece, false);
    fputs(piece, file);
  }
}

static void copy(char *into, size_t size, const char *text, bool line) {
  char piece[16];
  size_t at = 0;
  while (*text) {
    text += next(text, piece, line);
    size_t length = strlen(piece);
    if (at + length >= size) break;
    memcpy(into + at, piece, length);
    at += length;
  }
  into[at] = 0;
}

void hk_plain_copy(char *into, size_t size, const char *text) { copy(into, size, text, false); }
void hk_plain_line(char *into, size_t size, const char *text) { copy(into, size, text, true); }
