/* Between the files of this room. */
#ifndef HK_STORAGE_FILES_H
#define HK_STORAGE_FILES_H

#include "core/storage/storage.h"

/* "cannot read FILE: why", by errno. */
hk_status hk_io_error(hk_error *, const char *doing, const char *path);
/* body(file, what) writes it; an interrupted or failed write leaves what was there. */
hk_status hk_write_file(const char *path, bool (*body)(FILE *, const void *), const void *what, hk_error *);
/* Takes the place of the particles, wherever there are indices. */
hk_status hk_install(hk_loop *, hk_particle_set *);

/* Read from the file, after its first line. */
hk_status hk_checkpoint_read(hk_loop *, hk_judgement *, FILE *, const char *path);
hk_status hk_state_table_read(hk_loop *, FILE *, const char *head, const char *path);
extern const char hk_checkpoint_magic[];

#endif
