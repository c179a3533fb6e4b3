/* Text for people: that of unknown origin, from scripts and file names, made harmless for their terminals, and
 * sentences in one buffer. */
#ifndef HK_TEXT_H
#define HK_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Writes UTF-8 with letters and line breaks as they are; what could command a terminal (control characters, orders of
 * writing direction, bytes that are no UTF-8) is written as \xHH or \u{HHHH}. */
void hk_print_plain(FILE *, const char *text);
void hk_plain_copy(char *into, size_t size, const char *text); /* the same into a buffer, cut at its end */
/* In one line: line breaks and tabs as \\xHH too, where a name with them would be taken for another line. */
void hk_plain_line(char *into, size_t size, const char *text);
size_t hk_utf8_next(const char *text, uint32_t *code); /* bytes of the first character; 0: it is no UTF-8 */
bool hk_commands_terminal(uint32_t code);

/* Appends to the text in a buffer of `size` bytes, after `separator` unless it is empty; cut at the buffer's end. */
void hk_text_append(char *text, size_t size, const char *separator, const char *format, va_list);

/* ---- names.c: what a name that is not known may mean ---- */

typedef const char *hk_name_at(const void *context, size_t k); /* the k-th name, NULL after the last */

/* The name closest to `wrong` by edit distance, or NULL when none is close. */
const char *hk_nearest_name(const char *wrong, hk_name_at *, const void *context);
/* The name of which `wrong` is the plural: cell of cells; NULL: there is none. */
const char *hk_singular_name(const char *wrong, hk_name_at *, const void *context);
/* `wrong` itself where there is this name, or the name that stands for it in the folder's file `synonyms`, lines of
 * "WORD NAME [NAME ...] [-- NOTE]"; or NULL. */
const char *hk_synonym(const char *folder, const char *wrong, hk_name_at *, const void *context);
/* The same where `wrong` is a word of that file with one wrong letter, such as vertlet for verlet. */
const char *hk_near_synonym(const char *folder, const char *wrong, hk_name_at *, const void *context);
/* " (NOTE)" of the word's line: how what was meant is done with the other name. Empty where there is none. */
void hk_synonym_note(const char *folder, const char *word, char *text, size_t size);
/* "ids are 1 to N", or that there are no particles yet; in `text`, which is returned. */
const char *hk_known_ids(char text[64], size_t n);
/* Whether the text begins with these words, such as "rest length" with rest_length. */
bool hk_begins_with_words(const char *text, const char *words);

#endif
