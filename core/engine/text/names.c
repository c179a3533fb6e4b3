/* What a name that is not known may mean: one of which it is the plural; one whose help begins with it; one that the
 * field uses for the same thing, as a file lists them; or else the closest by edit distance, where capitals count for
 * half. */
#include "core/engine/text/text.h"

#include <ctype.h>
#include <string.h>

/* What follows in a line of synonyms is for people. */
#define NOTE "--"

enum { NAME_MOST = 63, CHANGE = 2 }; /* CHANGE: what a changed letter counts; a capital for a small one counts 1 */

static bool same_letter(char a, char b) { return tolower((unsigned char)a) == tolower((unsigned char)b); }

static size_t least_of(size_t a, size_t b) { return a < b ? a : b; }

/* Edit distance (Levenshtein), where two neighbours that are swapped count as one change (Damerau); of longer names the
 * beginnings are compared. */
static size_t edit_distance(const char *a, const char *b) {
  size_t cost[NAME_MOST + 1][NAME_MOST + 1], na = strnlen(a, NAME_MOST), nb = strnlen(b, NAME_MOST);
  for (size_t i = 0; i <= na; i++)
    for (size_t j = 0; j <= nb; j++) {
      cost[i][j] = CHANGE * (i + j); /* all letters of one left out, all of the other put in */
      if (i == 0 || j == 0) continue;
      size_t change = a[i - 1] == b[j - 1] ? 0 : same_letter(a[i - 1], b[j - 1]) ? 1 : CHANGE;
      bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      cost[i][j] = least_of(cost[i - 1][j - 1] + change, least_of(cost[i - 1][j], cost[i][j - 1]) + CHANGE);
      if (swapped) cost[i][j] = least_of(cost[i][j], cost[i - 2][j - 2] + CHANGE);
    }
  return cost[na][nb];
}

/* The beginning of a name is as near to it as one changed letter. */
static size_t distance_between(const char *wrong, const char *name) {
  enum { SHORTEST = 3 };
  size_t length = strlen(wrong), distance = edit_distance(wrong, name);
  bool begins = length >= SHORTEST && strncmp(wrong, name, length) == 0;
  return begins && distance > CHANGE ? CHANGE : distance;
}

const char *hk_nearest_name(const char *wrong, hk_name_at *name, const void *context) {
  const char *best = NULL, *candidate;
  size_t least = CHANGE * (strlen(wrong) / 3 + 1) + 1;
  for (size_t k = 0; (candidate = name(context, k)) != NULL; k++) {
    size_t distance = distance_between(wrong, candidate), longest = strlen(wrong);
    if (strlen(candidate) > longest) longest = strlen(candidate);
    if (distance >= least || distance >= CHANGE * longest) continue; /* the latter: no letter is the same */
    best = candidate;
    least = distance;
  }
  return best;
}

/* Capitals and small letters are the same, and so are '_', '-' and a space. */
static bool same_in_words(char a, char b) {
  bool joins = strchr("_- ", a) && strchr("_- ", b);
  return joins || same_letter(a, b);
}

static bool same_word(const char *a, const char *b) {
  for (; *a && *b && same_in_words(*a, *b); a++, b++) continue;
  return !*a && !*b;
}

static const char *find(const char *word, hk_name_at *name, const void *context) {
  const char *candidate;
  for (size_t k = 0; (candidate = name(context, k)) != NULL; k++)
    if (strcmp(word, candidate) == 0) return candidate;
  return NULL;
}

/* One letter is wrong, in a word that is long enough for that to mean something. */
static bool nearly_same_word(const char *a, const char *b) {
  enum { SHORTEST = 5 };
  return strlen(b) >= SHORTEST && edit_distance(b, a) <= CHANGE;
}

const char *hk_singular_name(const char *wrong, hk_name_at *name, const void *context) {
  const char *candidate;
  size_t length = strlen(wrong);
  for (size_t k = 0; (candidate = name(context, k)) != NULL; k++)
    if (length == strlen(candidate) + 1 && wrong[length - 1] == 's' && strncmp(candidate, wrong, length - 1) == 0)
      return candidate;
  return NULL;
}

static FILE *open_synonyms(const char *folder) {
  char file[4096];
  return snprintf(file, sizeof file, "%s/synonyms", folder) < (int)sizeof file ? fopen(file, "r") : NULL;
}

/* What the first line stands for whose word fits and that has a name which is known. */
static const char *look_up(const char *folder, const char *wrong, bool (*fits)(const char *, const char *),
                           hk_name_at *name, const void *context) {
  char line[512], *rest = NULL;
  const char *found = NULL;
  FILE *list = open_synonyms(folder);
  while (list && !found && fgets(line, sizeof line, list)) {
    char *word = strtok_r(line, " \n", &rest);
    if (!word || *word == '#' || !fits(word, wrong)) continue;
    while (!found && (word = strtok_r(NULL, " \n", &rest)) != NULL && strcmp(word, NOTE) != 0)
      found = find(word, name, context);
  }
  if (list) fclose(list);
  return found;
}

void hk_synonym_note(const char *folder, const char *word, char *text, size_t size) {
  char line[512];
  FILE *list = open_synonyms(folder);
  *text = 0;
  while (list && !*text && fgets(line, sizeof line, list)) {
    size_t length = strcspn(line, " \n");
    const char *note = strstr(line, " " NOTE " ");
    if (!note || strlen(word) != length || strncmp(line, word, length) != 0) continue;
    note += sizeof NOTE + 1;
    snprintf(text, size, " (%.*s)", (int)strcspn(note, "\n"), note);
  }
  if (list) fclose(list);
}

const char *hk_synonym(const char *folder, const char *wrong, hk_name_at *name, const void *context) {
  const char *known = find(wrong, name, context);
  return known ? known : look_up(folder, wrong, same_word, name, context);
}

const char *hk_near_synonym(const char *folder, const char *wrong, hk_name_at *name, const void *context) {
  return look_up(folder, wrong, nearly_same_word, name, context);
}

bool hk_begins_with_words(const char *text, const char *words) {
  enum { SHORTEST = 3 };
  size_t length = strlen(words), k = 0;
  while (k < length && text[k] && same_in_words(text[k], words[k])) k++;
  return length >= SHORTEST && k == length && !isalnum((unsigned char)text[k]);
}
