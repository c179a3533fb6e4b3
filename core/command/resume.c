/* See resume.h. Options for where files go, what is printed, threads and rights are not kept: they are the user's, each
 * time, and a checkpoint from somebody else must not choose them. */
#include "core/command/resume.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* The words of one argument: 1, or 2 for "--name value". */
static int words_of(int argc, char **argv, int at, bool *kept) {
  bool takes_value = false;
  *kept = hk_option_kept(argv[at], &takes_value);
  return takes_value && !strchr(argv[at], '=') && at + 1 < argc ? 2 : 1;
}

/* The position of the scene among the arguments; argc: there is none. Beside --resume it may be left out, and
 * name=value is then none. */
static int find_scene(int argc, char **argv, bool left_out) {
  bool kept;
  for (int i = 0; i < argc; i += words_of(argc, argv, i, &kept))
    if (argv[i][0] != '-' && !(left_out && strchr(argv[i], '='))) return i;
  return argc;
}

static char *append(char *to, const char *word) {
  size_t length = strlen(word) + 1;
  memcpy(to, word, length);
  return to + length;
}

char *hk_resume_words(int argc, char **argv) {
  char scene[PATH_MAX];
  int at = find_scene(argc, argv, false);
  size_t room = sizeof scene + 1;
  bool kept;
  if (at == argc || !realpath(argv[at], scene)) return NULL;
  for (int i = 0; i < argc; i++) room += strlen(argv[i]) + 1;
  char *words = malloc(room), *end = words;
  if (!words) return NULL;
  end = append(end, scene);
  for (int i = 0, count; i < argc; i += count) {
    count = words_of(argc, argv, i, &kept);
    bool parameter = argv[i][0] != '-' && i != at;
    for (int k = i; k < i + count && (kept || parameter); k++)
      if (*argv[k]) end = append(end, argv[k]);
  }
  *end = 0;
  return words;
}

static const char *resumed_file(int argc, char **argv) {
  const char *file = NULL;
  bool kept;
  for (int i = 0; i < argc; i += words_of(argc, argv, i, &kept)) {
    if (strncmp(argv[i], "--resume=", 9) == 0) file = argv[i] + 9;
    if (strcmp(argv[i], "--resume") == 0 && i + 1 < argc) file = argv[i + 1];
  }
  return file;
}

/* A scene given now is in place of the one that was. */
hk_status hk_resume_expand(int *argc, char ***argv, char ***list, char **text, hk_error *error) {
  const char *file = resumed_file(*argc, *argv);
  int scene = find_scene(*argc, *argv, true), count = 0, words = 0;
  *list = NULL;
  *text = NULL;
  if (!file) return HK_OK;
  hk_status status = hk_checkpoint_words(file, text, error);
  if (status != HK_OK) return status;
  for (const char *word = *text; *word; word += strlen(word) + 1) words++;
  *list = calloc((size_t)(*argc + words) + 1, sizeof **list);
  if (!*list) return hk_error_set(error, HK_NO_MEMORY, "no memory for the words of %s", file);
  for (char *word = *text; *word; word += strlen(word) + 1) (*list)[count++] = word;
  if (scene < *argc) (*list)[0] = (*argv)[scene];
  for (int i = 0; i < *argc; i++)
    if (i != scene) (*list)[count++] = (*argv)[i];
  *argc = count;
  *argv = *list;
  return HK_OK;
}
