/* Text of unknown origin made harmless for a terminal, see base.h. UTF-8 as in RFC 3629: no overlong forms, no
 * surrogates. */
#include "core/base/base.h"

#include <stdio.h>
#include <string.h>

size_t hk_utf8_length(const char *text) {
  const unsigned char *c = (const unsigned char *)text;
  size_t length = *c < 0x80                 ? 1
                  : *c >= 0xc2 && *c < 0xe0 ? 2
                  : *c >= 0xe0 && *c < 0xf0 ? 3
                  : *c >= 0xf0 && *c < 0xf5 ? 4
                                            : 0;
  for (size_t k = 1; k < length; k++)
    if ((c[k] & 0xc0) != 0x80) return 0;
  bool wrong = (c[0] == 0xe0 && c[1] < 0xa0) || (c[0] == 0xed && c[1] > 0x9f) || (c[0] == 0xf0 && c[1] < 0x90) ||
               (c[0] == 0xf4 && c[1] > 0x8f);
  return wrong ? 0 : length;
}

static unsigned long code_of(const char *text, size_t length) {
  static const unsigned char mask[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
  unsigned long code = (unsigned char)text[0] & mask[length];
  for (size_t k = 1; k < length; k++) code = code << 6 | ((unsigned char)text[k] & 0x3f);
  return code;
}

/* Control characters, and those that change the direction of writing (Unicode UAX 9). */
static bool commands(unsigned long code) {
  if (code == '\n' || code == '\t') return false;
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || (code >= 0x200e && code <= 0x200f) ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

/* Writes the next character into `piece`; returns the bytes read. */
static size_t next(const char *text, char piece[16]) {
  size_t length = hk_utf8_length(text);
  unsigned long code = length ? code_of(text, length) : (unsigned char)*text;
  if (length && !commands(code)) {
    memcpy(piece, text, length);
    piece[length] = 0;
    return length;
  }
  snprintf(piece, 16, code < 0x100 ? "\\x%02lx" : "\\u{%lx}", code);
  return length ? length : 1;
}

void hk_print_plain(FILE *file, const char *text) {
  char piece[16];
  while (*text) {
    text += next(text, piece);
    fputs(piece, file);
  }
}

void hk_plain_copy(char *into, size_t size, const char *text) {
  char piece[16];
  size_t at = 0;
  while (*text) {
    text += next(text, piece);
    size_t length = strlen(piece);
    if (at + length >= size) break;
    memcpy(into + at, piece, length);
    at += length;
  }
  into[at] = 0;
}
