/* See resume.h. Options for where files go, what is printed, outputs, threads and rights are not kept: they are the
 * user's, each time, and a checkpoint from somebody else must not choose them: a file in which they stand is refused.
 * So is the scene, which has to be named; with --trust all options are. Where the file lies is the user's word, though:
 * in the output folder of a run of that scene, the run goes on there. */
#include "core/app/command/resume.h"
#include "core/engine/text/text.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

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

static const char with[] = "--with", change[] = "--change";

/* That of an option of one word or of two; "": it has none. */
static char *value_of(char **word, int count) {
  char *equals = strchr(word[0], '=');
  return count == 2 ? word[1] : equals ? equals + 1 : word[0] + strlen(word[0]);
}

/* Of what --with adds, all but outputs is part of the motion. */
static bool adds_output(char **word, int count) {
  static const char output[] = "output:";
  return strncmp(word[0], with, sizeof with - 1) == 0 && strncmp(value_of(word, count), output, sizeof output - 1) == 0;
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
    kept = kept && !adds_output(argv + i, count);
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

static const char *last_part(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* Another checkpoint in the same folder that is whole, the newest: outputs leave the one before. "": there is none. */
static void find_whole(const char *file, char *found, size_t size) {
  char folder[PATH_MAX], path[PATH_MAX + 300];
  time_t newest = 0;
  struct stat info;
  size_t length = (size_t)(last_part(file) - file);
  snprintf(folder, sizeof folder, "%.*s", (int)length, file);
  DIR *directory = opendir(length ? folder : ".");
  *found = 0;
  for (struct dirent *entry; directory && (entry = readdir(directory));) {
    const char *ending = strrchr(entry->d_name, '.');
    if (!ending || strcmp(ending, ".checkpoint") != 0 || strcmp(entry->d_name, last_part(file)) == 0) continue;
    snprintf(path, sizeof path, "%s%s", folder, entry->d_name);
    char *text = NULL;
    bool whole = stat(path, &info) == 0 && S_ISREG(info.st_mode) && hk_checkpoint_words(path, &text, NULL) == HK_OK;
    free(text);
    if (!whole || (*found && info.st_mtime < newest)) continue;
    newest = info.st_mtime;
    snprintf(found, size, "%s", path);
  }
  if (directory) closedir(directory);
}

static hk_status read_words(const char *file, char **text, hk_error *error) {
  char whole[PATH_MAX + 300];
  hk_error why = {0};
  hk_status status = hk_checkpoint_words(file, text, &why);
  if (status == HK_OK) return HK_OK;
  if (status == HK_IO) find_whole(file, whole, sizeof whole);
  bool other = status == HK_IO && *whole;
  return hk_error_set(error, status, "%s%s%s", why.text, other ? "; a point before it is whole: --resume " : "",
                      other ? whole : "");
}

/* What is known of a command that goes on: its own words, then those of the checkpoint, without the scene. */
typedef struct resumed {
  const char *file, *scene, *then; /* the checkpoint; the scenes that are named now (NULL: none) and in it */
  int argc, count;
  char **argv, **word;
} resumed;

/* Appends a word to the command that is shown, in quotes where a shell would read more in it than a word. */
static void show(char *command, size_t size, const char *word) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./";
  size_t used = strlen(command);
  const char *quote = *word && strspn(word, plain) == strlen(word) ? "" : "'";
  snprintf(command + used, size - used, " %s%s%s", quote, word, quote);
}

/* The whole command, as the user would write it without what the checkpoint holds. */
static const char *whole_command(const resumed *r, char *command, size_t size) {
  snprintf(command, size, "hooke run");
  show(command, size, r->scene ? r->scene : r->then);
  for (int i = 0; i < r->count; i++) show(command, size, r->word[i]);
  for (int i = 0; i < r->argc; i++)
    if (r->argv[i] != r->scene) show(command, size, r->argv[i]);
  return command;
}

/* Whether `word`, NAME=VALUE, is a parameter that --change gives another value. */
static bool changed(const resumed *r, const char *word) {
  size_t length = strcspn(word, "=");
  bool kept;
  for (int i = 0, count; i < r->argc; i += count) {
    count = words_of(r->argc, r->argv, i, &kept);
    const char *value = value_of(r->argv + i, count);
    if (*word != '-' && strncmp(r->argv[i], change, sizeof change - 1) == 0 && strncmp(value, word, length) == 0 &&
        value[length] == '=')
      return true;
  }
  return false;
}

/* Whether the user gives this option or parameter himself. */
static bool given(const resumed *r, const char *word) {
  size_t length = strcspn(word, "=");
  bool kept;
  if (changed(r, word)) return true;
  for (int i = 0; i < r->argc; i += words_of(r->argc, r->argv, i, &kept))
    if (strcspn(r->argv[i], "=") == length && strncmp(r->argv[i], word, length) == 0) return true;
  return false;
}

/* Whether what --with adds is added by the command that goes on, too: it is there once. */
static bool added_again(const resumed *r, char **word, int words) {
  bool kept;
  for (int i = 0, count; i < r->argc && strncmp(word[0], with, sizeof with - 1) == 0; i += count) {
    count = words_of(r->argc, r->argv, i, &kept);
    if (strncmp(r->argv[i], with, sizeof with - 1) == 0 &&
        strcmp(value_of(r->argv + i, count), value_of(word, words)) == 0)
      return true;
  }
  return false;
}

/* Leaves out of the checkpoint's words those that the command replaces. */
static void replace_words(resumed *r) {
  int left = 0;
  bool kept;
  for (int i = 0, count; i < r->count; i += count) {
    count = words_of(r->count, r->word, i, &kept);
    if (changed(r, r->word[i]) || added_again(r, r->word + i, count)) continue;
    for (int k = i; k < i + count; k++) r->word[left++] = r->word[k];
  }
  r->count = left;
}

/* Each --change is NAME=VALUE. */
static hk_status check_changes(const resumed *r, hk_error *error) {
  bool kept;
  for (int i = 0, count; i < r->argc; i += count) {
    count = words_of(r->argc, r->argv, i, &kept);
    const char *value = value_of(r->argv + i, count);
    if (strncmp(r->argv[i], change, sizeof change - 1) != 0 || (strchr(value, '=') && *value != '=')) continue;
    return hk_error_set(error, HK_BAD_PARAM, "--change: '%s' is not the parameter and its value: --change NAME=VALUE",
                        value);
  }
  return HK_OK;
}

/* Appends the parameters of --change to the words, as those of a run from the start are given: they are kept in its
 * checkpoints. */
static void add_changed(resumed *r) {
  bool kept;
  for (int i = 0, count; i < r->argc; i += count) {
    count = words_of(r->argc, r->argv, i, &kept);
    if (strncmp(r->argv[i], change, sizeof change - 1) == 0) r->word[r->count++] = value_of(r->argv + i, count);
  }
}

/* What no run of hooke keeps in a checkpoint was put there by somebody. With --trust a script gets full rights, and
 * what it is told is the user's to say. */
static hk_status check_words(const resumed *r, hk_error *error) {
  bool trust = hk_option_given(r->argc, r->argv, "--trust"), kept;
  char command[512];
  for (int i = 0, count; i < r->count; i += count) {
    count = words_of(r->count, r->word, i, &kept);
    bool parameter = r->word[i][0] != '-' && strchr(r->word[i], '=');
    if (!parameter && (!kept || adds_output(r->word + i, count)))
      return hk_error_set(error, HK_BAD_PARAM,
                          "%s cannot be gone on from: it asks for %s, which is for the command line to say and in no "
                          "checkpoint that hooke has written",
                          r->file, r->word[i]);
    if (trust && !given(r, r->word[i]))
      return hk_error_set(error, HK_BAD_PARAM,
                          "with --trust nothing is taken from a checkpoint, and %s holds %s: give it as well, as in %s",
                          r->file, r->word[i], whole_command(r, command, sizeof command));
  }
  return HK_OK;
}

/* The scene that is named now has to be the one that was, but may be somewhere else. */
static hk_status check_scene(const resumed *r, hk_error *error) {
  char command[512];
  if (!r->scene)
    return hk_error_set(error, HK_BAD_PARAM, "%s does not choose what is run: name its scene, as in %s", r->file,
                        whole_command(r, command, sizeof command));
  if (strcmp(last_part(r->then), last_part(r->scene)) == 0) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "%s cannot be gone on from: it is of the scene %s, and %s is named", r->file,
                      last_part(r->then), last_part(r->scene));
}

static void say_command(const resumed *r) {
  char command[2048];
  if (hk_option_given(r->argc, r->argv, "--quiet") || hk_option_given(r->argc, r->argv, "--help")) return;
  fprintf(stderr, "hooke: goes on as ");
  hk_print_plain(stderr, whole_command(r, command, sizeof command));
  fprintf(stderr, "\n");
}

void hk_resume_folder(hk_options *o) {
  static const char part[] = "from-step-", list[] = "/.hooke-files";
  char owner[256] = "", path[sizeof o->beside + sizeof list];
  if (!o->run.resume || o->run.out || !realpath(o->run.resume, o->beside)) return;
  *strrchr(o->beside, '/') = 0;
  if (strncmp(last_part(o->beside), part, sizeof part - 1) == 0) *strrchr(o->beside, '/') = 0;
  snprintf(path, sizeof path, "%s%s", o->beside, list);
  int descriptor = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "r");
  if (!file) return;
  bool known = fgets(owner, sizeof owner, file) != NULL;
  fclose(file);
  size_t length = strcspn(owner, "\n");
  const char *scene = last_part(o->scene), *ending = strstr(scene, ".lua");
  if (known && ending && (size_t)(ending - scene) == length && strncmp(owner, scene, length) == 0)
    o->run.out = o->beside;
}

hk_status hk_resume_expand(int *argc, char ***argv, char ***list, char **text, hk_error *error) {
  const char *file = resumed_file(*argc, *argv);
  int at = find_scene(*argc, *argv, true), words = 0;
  *list = NULL;
  *text = NULL;
  if (!file) return HK_OK;
  hk_status status = read_words(file, text, error);
  if (status != HK_OK) return status;
  for (const char *word = *text; *word; word += strlen(word) + 1) words++;
  *list = calloc((size_t)(2 * *argc + words) + 2, sizeof **list);
  if (!*list) return hk_error_set(error, HK_NO_MEMORY, "no memory for the words of %s", file);
  resumed r = {file, at < *argc ? (*argv)[at] : NULL, *text, *argc, 0, *argv, *list + 1};
  for (char *word = *text + strlen(*text) + (words > 0); *word; word += strlen(word) + 1) r.word[r.count++] = word;
  status = check_scene(&r, error);
  if (status == HK_OK) status = check_changes(&r, error);
  if (status == HK_OK) status = check_words(&r, error);
  if (status != HK_OK) return status;
  replace_words(&r);
  say_command(&r);
  if (hk_option_given(*argc, *argv, "--trust")) r.count = 0; /* the user has given all of it */
  add_changed(&r);
  (*list)[0] = (*argv)[at];
  int count = 1 + r.count;
  for (int i = 0; i < *argc; i++)
    if (i != at) (*list)[count++] = (*argv)[i];
  *argc = count;
  *argv = *list;
  return HK_OK;
}
