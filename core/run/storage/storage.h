/* Files of a run: the output folder, measures.csv, state tables and checkpoints. */
#ifndef HK_STORAGE_H
#define HK_STORAGE_H

#include "core/run/judge/judge.h"
#include <stdio.h>

typedef struct hk_folder hk_folder;

/* ---- folder.c: the output folder, made at the request of the first file. All files of an earlier run of the same
 * scene are removed; other files are never touched, and no link is followed below it. HK_IO where another run is
 * writing there ---- */

hk_folder *hk_folder_open(const char *out, const char *scene, hk_error *error); /* out NULL: "out/SCENE" */
/* After the last file: other runs may write there. */
void hk_folder_release(hk_folder *);
/* Holds a folder again that was released. False: it has no files of this run, or another run has begun there since. */
bool hk_folder_restore(hk_folder *);
void hk_folder_close(hk_folder *);
const char *hk_folder_place(const hk_folder *); /* its path; NULL when there is no folder */
/* Before the first file: the run goes on after so many steps, and its files come beside those of the part before. */
void hk_folder_go_on(hk_folder *, size_t step);
/* Files that options name, {option, path} each and {NULL} at the end, which no file of the folder may be as well. The
 * list has to live as long as the folder. */
void hk_folder_spare(hk_folder *, const char *const (*taken)[2]);
/* Where a file of that name is to be written; the folders on the way exist then, and are no links. `owner` is the label
 * of the output that asks, NULL the run itself: HK_BAD_PARAM for a file that another one writes, or an option names. */
hk_status hk_folder_path(hk_folder *, const char *owner, const char *name, char *buffer, size_t size, hk_error *error);

/* ---- targets.c: whether what `option` names can be written, before a run. HK_IO and HK_BAD_PARAM say why not ---- */

hk_status hk_target_file(const char *option, const char *path, hk_error *error);
/* Refuses to write over a file that the run reads. Either may be NULL, and need not exist. */
hk_status hk_target_spares(const char *option, const char *path, const char *source, hk_error *error);
/* Refuses one file for two options, of which one would be lost; by whatever paths, and whether it exists or not. */
hk_status hk_target_differs(const char *const option[2], const char *const path[2], hk_error *error);
/* A folder, or one that can be made; looks, and makes nothing. */
hk_status hk_target_folder(const char *option, const char *path, hk_error *error);
/* ---- write_file.c ---- */

/* A new file to write in; what has the name already, a link perhaps, goes first. NULL and errno. */
FILE *hk_file_create(const char *path);
/* Writes a file by body(file, what); an interrupted or failed write does not change an existing file. */
hk_status hk_write_file(const char *path, bool (*body)(FILE *, const void *), const void *what, hk_error *);

/* ---- inside.c: files that scripts name ---- */

/* Opens a plain file inside one of the folders (NULL members end the list; "inside" by real paths); `within` NULL: any
 * file. NULL: the reason is hk_file_reason(errno). */
FILE *hk_file_read(const char *path, const char *const *within);
const char *hk_file_reason(int cause); /* strerror, and sentences for files outside and for what is no plain file */

/* ---- records.c: lines of text files that scripts name, in bounded memory ---- */

enum { HK_RECORD_LONGEST = 1 << 14 }; /* characters of a record, its lines together */

typedef struct hk_records {
  FILE *file;
  size_t line, lines; /* in which the record begins, and behind it */
  size_t read, most;  /* characters, and how many are allowed */
  char record[HK_RECORD_LONGEST];
} hk_records;

void hk_records_begin(hk_records *, FILE *file, size_t most);
/* Reads the next record; false: there is none, or *wrong, NULL before, says what it is. */
bool hk_records_next(hk_records *, const char **wrong);

/* ---- measures.c: measures.csv, a row per frame ---- */

hk_status hk_measures_open(hk_folder *, const hk_scene *, FILE **, hk_error *error);
hk_status hk_measures_write(FILE *, double t, const hk_frame *, hk_error *error);
hk_status hk_measures_close(FILE **, hk_error *error);

/* ---- state_table.c: "id,x,y,z,vx,vy,vz,mass", 17 digits, and the channels ---- */

/* `state` gives the channels; `s` may be an earlier snapshot of it. */
hk_status hk_state_table_write(const hk_snapshot *s, const hk_state *state, const char *path, hk_error *error);

/* ---- checkpoint.c: all data that a continued run needs, in the machine's byte order ---- */

typedef struct hk_checkpoint { /* in memory; begins zeroed */
  unsigned char *byte;
  size_t count, capacity;
} hk_checkpoint;

/* `origin`: of the scene and its plugins (scene/origin.c). `words`: how the run was asked for, each word with its 0, an
 * empty one at the end. Both may be NULL. HK_NO_MEMORY: the checkpoint is empty. */
hk_status hk_checkpoint_take(hk_checkpoint *, hk_loop *, const hk_judgement *, const char *origin, const char *words,
                             hk_error *error);
hk_status hk_checkpoint_write(const hk_checkpoint *, const char *path, hk_error *error);
void hk_checkpoint_free(hk_checkpoint *);
/* The words of the run that wrote the file; the caller frees them. */
hk_status hk_checkpoint_words(const char *path, char **words, hk_error *error);

/* ---- start_file.c: begins a run with a state table or a checkpoint. It is read after the plugins have started, so
 * that data derived from the scene's start state (rest lengths) do not change. *resumed: the file is a checkpoint. With
 * `origin` it has to be one, of the same scene and plugins but for `changes`, with the particles and masses that the
 * scene has with these ---- */

hk_status hk_start_file_read(hk_loop *, hk_judgement *, const hk_folder *output, const char *path, const char *origin,
                             hk_origin_changes *changes, bool *resumed);

#endif
